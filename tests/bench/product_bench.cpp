// What library products reach on the matrices of a message step, on one core: (1152 x D) (D x D),
// float32. The yardstick of the fused kernel; built only where the libraries' headers are
// installed (libopenblas-dev, libdnnl-dev, libxsmm-dev).
//
//     OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 build/release/tests/bench/product_bench

#include <benchmark/benchmark.h>
#include <cblas.h>
#include <dnnl.h>
#include <libxsmm.h>

#include <functional>
#include <vector>

namespace {

constexpr int rows = 1152;

/// C = A B with row-major A (rows x d), B (d x d).
using Product = std::function<void(int d, const float* a, const float* b, float* c)>;

void measure(benchmark::State& state, const Product& product) {
    const int d = static_cast<int>(state.range(0));
    const size_t size = static_cast<size_t>(d);
    std::vector<float> a(rows * size, 0.1f), b(size * size, 0.2f), c(rows * size);
    for (auto _ : state) {
        product(d, a.data(), b.data(), c.data());
        benchmark::ClobberMemory();
    }
    state.counters["GFLOP/s"] =
        benchmark::Counter(2e-9 * rows * d * d, benchmark::Counter::kIsIterationInvariantRate);
}

void openblas(int d, const float* a, const float* b, float* c) {
    cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, rows, d, d, 1, a, d, b, d, 0, c, d);
}

void onednn(int d, const float* a, const float* b, float* c) {
    dnnl_sgemm('N', 'N', rows, d, d, 1, a, d, b, d, 0, c, d);
}

/// libxsmm is column-major: C' = B' A'.
void libxsmm(int d, const float* a, const float* b, float* c) {
    const float one = 1, zero = 0;
    libxsmm_smmdispatch(d, rows, d, nullptr, nullptr, nullptr, &one, &zero, nullptr, nullptr)(b, a,
                                                                                              c);
}

BENCHMARK_CAPTURE(measure, openblas, openblas)->RangeMultiplier(2)->Range(16, 128);
BENCHMARK_CAPTURE(measure, onednn, onednn)->RangeMultiplier(2)->Range(16, 128);
BENCHMARK_CAPTURE(measure, libxsmm, libxsmm)->RangeMultiplier(2)->Range(16, 128);

}  // namespace

BENCHMARK_MAIN();
