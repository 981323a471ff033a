#include "tests/bench/peak.h"

#include <omp.h>

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <functional>

namespace cloth::test {
namespace {

constexpr int chains = 12;  // enough to hide the latency of two units
constexpr long repeats = 4'000'000;

/// The chains on vectors of type V; inlined into functions that are compiled for their width.
template <typename V>
inline __attribute__((always_inline)) float multiply_add_chains() {
    V sum[chains] = {}, factor = {}, term = {};
    for (int k = 0; k < chains; ++k) sum[k] += static_cast<float>(k);  // none equals another
    factor += 0.999f;
    term += 1e-3f;
    for (long k = 0; k < repeats; ++k)
#pragma GCC unroll 12
        for (V& chain : sum) chain = chain * factor + term;
    float total = 0.0f;
    for (const V& chain : sum) total += chain[0];
    return total;
}

typedef float Lanes8 __attribute__((vector_size(32)));
typedef float Lanes16 __attribute__((vector_size(64)));

#if defined(__x86_64__)
__attribute__((target("avx512f,avx512vl,avx512dq"))) float run_512() {
    return multiply_add_chains<Lanes16>();
}
#endif

double seconds_of(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double run(int& lanes) {
    lanes = 8;
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f")) {
        lanes = 16;
        return run_512();
    }
#endif
    return multiply_add_chains<Lanes8>();
}

}  // namespace

double measured_peak(int threads) {
    double best = 0.0;
    for (int attempt = 0; attempt < 5; ++attempt) {
        int lanes = 0;
        volatile double sink = 0.0;
        const double seconds = seconds_of([&] {
#pragma omp parallel num_threads(threads)
            {
                int mine = 0;
                const double value = run(mine);
#pragma omp critical
                {
                    sink = sink + value;
                    lanes = mine;
                }
            }
        });
        best = std::max(best, 2.0 * lanes * chains * repeats * threads / seconds);
    }
    return best;
}

double plain_product(int rows, int k, int n) {
    const Eigen::MatrixXf a = Eigen::MatrixXf::Random(rows, k), b = Eigen::MatrixXf::Random(k, n);
    Eigen::MatrixXf c(rows, n);
    const int threads = Eigen::nbThreads();
    Eigen::setNbThreads(1);
    double best = 0.0;
    for (int attempt = 0; attempt < 20; ++attempt) {
        const double seconds = seconds_of([&] { c.noalias() = a * b; });
        best = std::max(best, 2.0 * rows * k * n / seconds);
    }
    Eigen::setNbThreads(threads);
    return best;
}

}  // namespace cloth::test
