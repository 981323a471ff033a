#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bullet_ext/btGnnSoftBodySolver.h"
#include "data/body/body.h"
#include "data/body/motion.h"

namespace cloth {

struct CrowdSettings {
    int characters = 10;
    std::string garment = "tshirt_1000";
    std::string solver = "small+3";  ///< of SceneSolvers
    bool parallel = true;            ///< see btGnnSolverSettings
};

/// The clips of assimp-testmodels, and those for validation of the shared data folder if it is
/// there.
std::vector<std::string> crowd_motions();

/// Characters beside each other in one Bullet world, each in a garment of its own. Character k
/// moves by clip k of the list, which begins anew where it ends, and a tenth of a second after the
/// one before it.
class Crowd {
 public:
    /// @throws UsageError, LoadError naming what cannot be had
    Crowd(std::shared_ptr<const Body> body, const std::vector<Motion>& motions,
          const CrowdSettings& settings);
    ~Crowd();

    static constexpr double frame_time = 1.0 / 30.0;  ///< (s)

    /// Takes a frame. @return the time of the world step (ms), animation left out
    double step();

    const btGnnSoftBodySolver& solver() const;
    /// Positions of the nodes of a character's garment (|V| x 3, m).
    Points nodes(int character) const;

 private:
    struct World;
    std::unique_ptr<World> m_world;
};

}  // namespace cloth
