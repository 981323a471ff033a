#include "collision/proximity/limb_boxes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace cloth {
namespace {

constexpr size_t most_meshes = 16;
constexpr float unbounded = std::numeric_limits<float>::infinity();

/// std::nextafter(x, -unbounded), which takes a call.
float next_below(float x) {
    if (!(x > -unbounded)) return x;
    if (x == 0.0f) return -std::numeric_limits<float>::denorm_min();
    std::int32_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    bits += x > 0.0f ? -1 : 1;
    std::memcpy(&x, &bits, sizeof x);
    return x;
}

/// At least as far out as the number that it was rounded from.
float rounded_down(double x) {
    return next_below(static_cast<float>(x));
}

float rounded_up(double x) {
    return -next_below(-static_cast<float>(x));
}

}  // namespace

const LimbBoxes::Mesh& LimbBoxes::known(const Obstacle& obstacle) {
    for (const Mesh& mesh : m_meshes)
        if (mesh.faces == obstacle.faces && mesh.limbs == obstacle.limbs) return mesh;
    if (m_meshes.size() == most_meshes) m_meshes.clear();
    Mesh& mesh = m_meshes.emplace_back();
    mesh.faces = obstacle.faces;
    mesh.limbs = obstacle.limbs;
    for (Eigen::Index f = 0; f < mesh.faces->rows(); ++f)
        for (int corner = 0; corner < 3; ++corner)
            mesh.vertices[(*mesh.limbs)[static_cast<size_t>(f)]].push_back(
                (*mesh.faces)(f, corner));
    for (std::vector<int>& of : mesh.vertices) {
        std::sort(of.begin(), of.end());
        of.erase(std::unique(of.begin(), of.end()), of.end());
    }
    return mesh;
}

void LimbBoxes::fit(const Boundary& boundary, const std::vector<char>& has_limbs, StepEnd end) {
    for (Row& row : m_low) row.fill(unbounded);
    for (Row& row : m_high) row.fill(-unbounded);
    for (size_t k = 0; k < boundary.obstacles.size(); ++k) {
        if (!has_limbs[k]) continue;
        const Obstacle& obstacle = boundary.obstacles[k];
        const Mesh& mesh = known(obstacle);
        const Points& x = end == StepEnd::start ? obstacle.x0 : obstacle.x1;
        for (size_t limb = 0; limb < max_limbs; ++limb) fit(mesh.vertices[limb], x, limb);
    }
}

void LimbBoxes::fit(const std::vector<int>& vertices, const Points& x, size_t limb) {
    // no query answers for a mesh whose faces are out of range
    if (vertices.empty() || vertices.front() < 0 || vertices.back() >= x.rows()) return;
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const int i : vertices)
        for (int k = 0; k < 3; ++k) {
            const double at = x(i, k);
            low[k] = at < low[k] ? at : low[k];  // no branches
            high[k] = at > high[k] ? at : high[k];
        }
    for (size_t k = 0; k < 3; ++k) {
        const auto axis = static_cast<Eigen::Index>(k);
        m_low[k][limb] = std::min(m_low[k][limb], rounded_down(low[axis]));
        m_high[k][limb] = std::max(m_high[k][limb], rounded_up(high[axis]));
    }
}

LimbSet LimbBoxes::near(const Vec3& x, double reach) const {
    float low[3], high[3];
    for (int k = 0; k < 3; ++k) {
        low[k] = rounded_down(x[k] - reach);
        high[k] = rounded_up(x[k] + reach);
    }
    LimbSet found = 0;
    for (size_t limb = 0; limb < max_limbs; ++limb) {  // no branches: eight at a time
        int overlap = 1;
        for (size_t k = 0; k < 3; ++k)
            overlap &= int(m_low[k][limb] <= high[k]) & int(m_high[k][limb] >= low[k]);
        found |= LimbSet(overlap) << limb;
    }
    return found;
}

LimbSet LimbBoxes::along(const Vec3& x, const Vec3& direction, double length) const {
    constexpr float around = 1e-4f;  // m: more than the rounding
    float from[3], inverse[3];
    for (int k = 0; k < 3; ++k) {
        const double d = direction[k];
        from[k] = static_cast<float>(x[k]);
        inverse[k] = static_cast<float>(1.0 / (std::abs(d) < 1e-6 ? std::copysign(1e-6, d) : d));
    }
    LimbSet found = 0;
    for (size_t limb = 0; limb < max_limbs; ++limb) {  // no branches: eight at a time
        float enter = 0.0f, leave = static_cast<float>(length);
        for (size_t k = 0; k < 3; ++k) {
            const float low = (m_low[k][limb] - around - from[k]) * inverse[k];
            const float high = (m_high[k][limb] + around - from[k]) * inverse[k];
            enter = std::max(enter, std::min(low, high));
            leave = std::min(leave, std::max(low, high));
        }
        const int meets = int(enter <= leave) & int(m_low[0][limb] <= m_high[0][limb]);
        found |= LimbSet(meets) << limb;
    }
    return found;
}

}  // namespace cloth
