#include "data/authoring/tshirt_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "data/core/surface_distance.h"

namespace cloth {

namespace {

constexpr double kCell = 0.006;       // of the grid that the surface is drawn from (m)
constexpr double kSliceStep = 0.005;  // between horizontal sections (m)
constexpr int kDirections = 96;       // of the supporting lines of a section
constexpr double kMirrorX[2] = {1.0, -1.0};

Vec3 mirrored(const Vec3& p, double side) {
    return {side * p.x(), p.y(), p.z()};
}

/// Largest |x| that belongs to the torso at a height: the armpit's, and more below, where the arms
/// stand off.
double torso_limit(const TshirtRecipe& recipe, double y) {
    return recipe.armpit.x() + 0.4 * std::max(0.0, recipe.armpit.y() - y);
}

/// Convex horizontal sections of the torso, as support functions h(direction) by height.
class Torso {
 public:
    Torso(const TriMesh& body, const TshirtRecipe& recipe, double low, double high)
        : m_low(low),
          m_centre(recipe.neck.z()),
          m_ease(recipe.chest_ease),
          m_shoulder(recipe.shoulder.y()),
          m_neck(recipe.neck.y()) {
        const int slices = static_cast<int>(std::ceil((high - low) / kSliceStep)) + 1;
        m_support.assign(static_cast<size_t>(slices), {});
        for (auto& slice : m_support) slice.fill(-1.0);
        for (int d = 0; d < kDirections; ++d) {
            const double angle = 2.0 * M_PI * d / kDirections;
            m_directions[static_cast<size_t>(d)] = {std::cos(angle), std::sin(angle)};
        }
        for (Eigen::Index f = 0; f < body.faces.rows(); ++f)
            for (int c = 0; c < 3; ++c)
                add_edge(recipe, body.vertices.row(body.faces(f, c)),
                         body.vertices.row(body.faces(f, (c + 1) % 3)));
        drape(recipe);
        smooth_heights();
    }

    /// Negative inside; the distance to the nearest supporting line of the section at that height.
    double operator()(const Vec3& p) const {
        const double at = (p.y() - m_low) / kSliceStep;
        const int last = static_cast<int>(m_support.size()) - 2;
        const int slice = std::clamp(static_cast<int>(std::floor(at)), 0, last);
        const double t = std::clamp(at - slice, 0.0, 1.0);
        const auto& a = m_support[static_cast<size_t>(slice)];
        const auto& b = m_support[static_cast<size_t>(slice) + 1];
        double value = -1.0;
        for (size_t d = 0; d < kDirections; ++d)
            value = std::max(value, p.x() * m_directions[d][0] +
                                        (p.z() - m_centre) * m_directions[d][1] -
                                        ((1.0 - t) * a[d] + t * b[d]));
        return value - ease(p.y());
    }

 private:
    /// Half as much ease at the neck as from the shoulders down.
    double ease(double y) const {
        const double t = std::clamp((y - m_shoulder) / (m_neck - m_shoulder), 0.0, 1.0);
        return m_ease * (1.0 - 0.5 * t);
    }

    using Slice = std::array<double, kDirections>;

    void add_edge(const TshirtRecipe& recipe, const Vec3& p, const Vec3& q) {
        if (p.y() > q.y()) return;  // the other face's half of the edge does it
        const int first = std::max(0, static_cast<int>(std::ceil((p.y() - m_low) / kSliceStep)));
        for (int s = first; s < static_cast<int>(m_support.size()); ++s) {
            const double y = m_low + s * kSliceStep;
            if (y > q.y()) break;
            const double t = (y - p.y()) / std::max(1e-12, q.y() - p.y());
            const Vec3 x = p + t * (q - p);
            if (std::abs(x.x()) > recipe.armpit.x() + 0.1 + torso_limit(recipe, y)) continue;
            const double limit = torso_limit(recipe, y);
            if (y < recipe.armpit.y() && std::abs(x.x()) > limit) continue;
            add_point(m_support[static_cast<size_t>(s)], std::clamp(x.x(), -limit, limit), x.z());
        }
    }

    void add_point(Slice& slice, double x, double z) const {
        for (size_t d = 0; d < kDirections; ++d)
            slice[d] =
                std::max(slice[d], x * m_directions[d][0] + (z - m_centre) * m_directions[d][1]);
    }

    /// Below the armpits the profile of each direction is closed with a disc: cloth hangs straight
    /// over hollows.
    void drape(const TshirtRecipe& recipe) {
        const int count = static_cast<int>((recipe.armpit.y() - m_low) / kSliceStep);
        const int reach = static_cast<int>(0.25 / kSliceStep);
        const double r = recipe.drape_radius;
        const auto arc = [&](int steps) {
            const double dy = steps * kSliceStep;
            return r - std::sqrt(r * r - dy * dy);
        };
        std::vector<double> disc(static_cast<size_t>(count));
        for (size_t d = 0; d < kDirections; ++d) {
            for (int s = 0; s < count; ++s) {  // lowest centre of a disc that clears the profile
                double height = -1.0;
                for (int n = std::max(0, s - reach); n < std::min(count, s + reach + 1); ++n)
                    height = std::max(
                        height, m_support[static_cast<size_t>(n)][d] + r - arc(std::abs(n - s)));
                disc[static_cast<size_t>(s)] = height;
            }
            for (int s = 0; s < count; ++s) {  // what the discs leave
                double height = 1e9;
                for (int n = std::max(0, s - reach); n < std::min(count, s + reach + 1); ++n)
                    height =
                        std::min(height, disc[static_cast<size_t>(n)] - r + arc(std::abs(n - s)));
                double& support = m_support[static_cast<size_t>(s)][d];
                support = std::max(support, height);
            }
        }
    }

    void smooth_heights() {
        for (int pass = 0; pass < 8; ++pass) {
            const std::vector<Slice> old = m_support;
            for (size_t s = 1; s + 1 < old.size(); ++s)
                for (size_t d = 0; d < kDirections; ++d)
                    m_support[s][d] = 0.25 * old[s - 1][d] + 0.5 * old[s][d] + 0.25 * old[s + 1][d];
        }
    }

    double m_low, m_centre, m_ease, m_shoulder, m_neck;
    std::array<std::array<double, 2>, kDirections> m_directions{};
    std::vector<Slice> m_support;
};

/// A round tube along the left upper arm, as wide as the widest part of the arm that it covers.
class Sleeve {
 public:
    Sleeve(const TriMesh& body, const TshirtRecipe& recipe)
        : m_shoulder(recipe.shoulder), m_axis(recipe.elbow - recipe.shoulder) {
        m_length = m_axis.norm();
        m_axis /= m_length;
        double widest = 0.0;
        for (Eigen::Index i = 0; i < body.vertices.rows(); ++i) {
            const Vec3 p = body.vertices.row(i);
            const double along = (p - m_shoulder).dot(m_axis) / m_length;
            const double away = ((p - m_shoulder) - along * m_length * m_axis).norm();
            const bool on_arm = p.x() > recipe.armpit.x() + 0.015 && away < 0.09;
            if (on_arm && along > 0.3 && along < recipe.sleeve_length + 0.05)
                widest = std::max(widest, away);
        }
        m_radius = widest + recipe.sleeve_ease;
    }

    double operator()(const Vec3& p) const {
        const double along = std::clamp((p - m_shoulder).dot(m_axis), 0.0, m_length);
        return (p - m_shoulder - along * m_axis).norm() - m_radius;
    }

 private:
    Vec3 m_shoulder, m_axis;
    double m_length = 0.0, m_radius = 0.0;
};

/// Union with a fillet of size `k` (m) in the corners (Quilez' polynomial smooth minimum).
double smooth_union(double a, double b, double k) {
    const double h = std::max(0.0, k - std::abs(a - b)) / k;
    return std::min(a, b) - 0.25 * h * h * k;
}

}  // namespace

TriMesh tshirt_surface(const TriMesh& body, const TshirtRecipe& recipe) {
    const double low = recipe.hem_height - 0.06, high = recipe.neck.y() + 0.075;
    const Torso torso(body, recipe, low, high);
    const Sleeve sleeve(body, recipe);
    const SurfaceDistance skin(body);
    const double skin_gap = recipe.clearance + 0.003;
    const auto shape = [&](const Vec3& p) {
        double value = torso(p);
        for (double side : kMirrorX) value = smooth_union(value, sleeve(mirrored(p, side)), 0.035);
        if (value > 0.0 && value < 0.05) {
            if (const auto near = skin.nearest_within(0.04, p))
                value = smooth_union(value, near->distance - skin_gap, 0.01);
        }
        return value;
    };
    const double reach = recipe.elbow.x() + 0.08;
    ScalarGrid grid(Vec3(-reach, low, -0.22), Vec3(reach, high, 0.26), kCell, shape);
    grid.blur(3);
    return grid.zero_surface();
}

}  // namespace cloth
