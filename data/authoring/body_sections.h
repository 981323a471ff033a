#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "data/core/mesh.h"

namespace cloth {

/// Convex horizontal sections of a part of a body, as support functions h(direction) by height.
class BodySections {
 public:
    struct Settings {
        double low = 0.0, high = 1.0;  ///< heights of the first and last section (m)
        double drape_radius = 0.6;     ///< hollows curved more than this are bridged (m)
        double drape_below = 1.0;      ///< hollows are bridged below this height (m)
        double freeze_below = -10.0;   ///< sections below are as here (m): feet do not count
        std::optional<double> flare;   ///< sections never narrow below `hang_from`, and widen
        double hang_from = 1.0;        ///< (m)
        double flare_from = 1.0;       ///< they widen below this height (m)
        /// Where the axis of the part is at a height (x and z count).
        std::function<Vec3(double y)> axis;
        /// What of a section at a height belongs to the part: the x to count it with, or nothing.
        std::function<std::optional<double>(double x, double y)> belongs;
    };

    BodySections(const TriMesh& body, Settings settings);

    /// Distance to the nearest supporting line of the section at the height of `p` (m), negative
    /// inside.
    double operator()(const Vec3& p) const;

    /// The farthest that any section reaches from its axis (m).
    double widest() const;

 private:
    static constexpr double kStep = 0.005;  // between sections (m)
    static constexpr int kDirections = 96;  // of the supporting lines of a section
    using Slice = std::array<double, kDirections>;

    double height(int slice) const { return m_settings.low + slice * kStep; }
    void add_edge(const Vec3& p, const Vec3& q);
    void add_point(Slice& slice, double x, double z) const;
    void freeze();
    void drape();
    void hang();
    void smooth_heights();

    Settings m_settings;
    std::array<std::array<double, 2>, kDirections> m_directions{};
    std::vector<Slice> m_support;
};

}  // namespace cloth
