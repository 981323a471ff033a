#pragma once

#include <memory>

#include "data/core/boundary.h"

namespace cloth {

/// A surface that moves by itself, such as an animated body: faces for life, vertices over time.
///
///     boundary.obstacles = {surface.obstacle(t, t + dt)};
class MovingSurface {
 public:
    virtual ~MovingSurface() = default;

    virtual std::shared_ptr<const Faces> faces() const = 0;
    /// Limb of each face (|F|), see Obstacle; null: the surface has none.
    virtual std::shared_ptr<const std::vector<std::uint8_t>> limbs() const { return nullptr; }
    /// Vertices (|V| x 3, m) at `time` (s); times outside [0, duration()] give the nearest end.
    virtual Points vertices(double time) const = 0;
    /// Length of the motion (s).
    virtual double duration() const = 0;

    /// Number of poses at times 0, dt, 2 dt, ... up to duration().
    int frame_count(double dt) const;

    /// The surface as an obstacle of a step from t0 to t1 (s). The last pose is kept, so
    /// consecutive steps compute one pose each. Safe to call from several threads.
    Obstacle obstacle(double t0, double t1) const;

 protected:
    /// @param friction  of the surface against cloth (Coulomb), 0 to 1.5
    explicit MovingSurface(double friction);

 private:
    struct Cache;
    Points cached_vertices(double time) const;

    double m_friction;
    std::shared_ptr<Cache> m_cache;
};

}  // namespace cloth
