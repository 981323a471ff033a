#pragma once

#include <cmath>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

namespace cloth::test {

/// Random choices of one round, the same on every platform (the distributions of the standard
/// library are not).
class Random {
 public:
    explicit Random(unsigned first) : m_bits(first) {}

    double uniform(double low, double high) {
        return low + (high - low) * (m_bits() / 4294967296.0);
    }
    /// 0 to count - 1; 0 if there is nothing to choose from.
    size_t below(size_t count) { return count == 0 ? 0 : m_bits() % count; }
    int between(int low, int high) {
        return low + static_cast<int>(below(static_cast<size_t>(high - low + 1)));
    }
    bool chance(double share) { return uniform(0.0, 1.0) < share; }
    /// Every order of magnitude is as likely as any other.
    double magnitude(double low, double high) {
        return low * std::pow(high / low, uniform(0.0, 1.0));
    }
    template <typename T>
    const T& one_of(const std::vector<T>& choices) {
        return choices[below(choices.size())];
    }
    unsigned bits() { return static_cast<unsigned>(m_bits()); }

 private:
    std::mt19937 m_bits;
};

inline unsigned number_from_environment(const char* name, unsigned otherwise) {
    const char* text = std::getenv(name);
    return text ? static_cast<unsigned>(std::strtoul(text, nullptr, 10)) : otherwise;
}

struct Seeds {
    unsigned first, count;
};

/// The seeds of a run: CLOTH_FUZZ_ROUNDS of them (here: `usual`), from CLOTH_FUZZ_SEED on.
inline Seeds seeds_to_run(unsigned usual) {
    return {number_from_environment("CLOTH_FUZZ_SEED", 1),
            number_from_environment("CLOTH_FUZZ_ROUNDS", usual)};
}

template <typename Round>
void for_each_seed(unsigned usual, const Round& round) {
    const Seeds seeds = seeds_to_run(usual);
    for (unsigned k = 0; k < seeds.count; ++k) round(seeds.first + k);
}

/// How to see one round again.
inline std::string repeat_with(unsigned seed) {
    return "repeat with CLOTH_FUZZ_ROUNDS=1 CLOTH_FUZZ_SEED=" + std::to_string(seed);
}

}  // namespace cloth::test
