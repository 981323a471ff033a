#include "data/core/moving_surface.h"

#include <cmath>
#include <mutex>

#include "data/core/errors.h"

namespace cloth {

struct MovingSurface::Cache {
    std::mutex mutex;
    double time = 0.0;
    Points vertices;
};

MovingSurface::MovingSurface(double friction)
    : m_friction(friction), m_cache(std::make_shared<Cache>()) {
}

int MovingSurface::frame_count(double dt) const {
    if (!(dt > 0.0)) throw ArgumentError("dt", "is not positive", "give a time step in seconds");
    return static_cast<int>(std::floor(duration() / dt + 1e-6)) + 1;
}

Obstacle MovingSurface::obstacle(double t0, double t1) const {
    Obstacle obstacle;
    obstacle.faces = faces();
    obstacle.limbs = limbs();
    obstacle.friction = m_friction;
    obstacle.x0 = cached_vertices(t0);
    obstacle.x1 = cached_vertices(t1);
    return obstacle;
}

Points MovingSurface::cached_vertices(double time) const {
    constexpr double same_time = 1e-9;  // s: k dt + dt and (k + 1) dt differ by rounding
    {
        const std::lock_guard<std::mutex> lock(m_cache->mutex);
        if (m_cache->vertices.rows() > 0 && std::abs(m_cache->time - time) < same_time)
            return m_cache->vertices;
    }
    Points points = vertices(time);
    const std::lock_guard<std::mutex> lock(m_cache->mutex);
    m_cache->time = time;
    m_cache->vertices = points;
    return points;
}

}  // namespace cloth
