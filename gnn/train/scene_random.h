#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "data/core/fabric.h"
#include "data/core/types.h"

namespace cloth {

/// Random numbers of a scene: the same on every platform, unlike the distributions of <random>.
class SceneRandom {
 public:
    explicit SceneRandom(std::uint64_t seed) : m_engine(seed) {}

    std::uint64_t bits() { return m_engine(); }
    double uniform(double low = 0.0, double high = 1.0) {
        return low + (high - low) * static_cast<double>(m_engine() >> 11) * 0x1.0p-53;
    }
    double log_uniform(double low, double high) {
        return std::exp(uniform(std::log(low), std::log(high)));
    }
    bool chance(double probability) { return uniform() < probability; }
    int below(int count) {
        return static_cast<int>(m_engine() % static_cast<std::uint64_t>(count));
    }

    /// Standard normal (Box and Muller 1958).
    double normal() {
        const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
        return radius * std::cos(2.0 * M_PI * uniform());
    }

    /// Uniform on the unit sphere.
    Vec3 direction() {
        const double y = uniform(-1.0, 1.0), angle = uniform(0.0, 2.0 * M_PI);
        const double r = std::sqrt(1.0 - y * y);
        return {r * std::cos(angle), y, r * std::sin(angle)};
    }

    /// HOOD's training ranges (learned_cloth.md, materials), moduli times its thickness.
    Fabric fabric() {
        Fabric fabric;
        fabric.density = uniform(0.0434, 0.70);
        fabric.mu = log_uniform(7.48, 29.9);
        fabric.lambda = uniform(1.66, 43.9);
        fabric.bending = log_uniform(6.37e-8, 1.314e-3);
        return fabric;
    }

    const std::mt19937_64& engine() const { return m_engine; }
    std::mt19937_64& engine() { return m_engine; }

 private:
    std::mt19937_64 m_engine;
};

}  // namespace cloth
