#pragma once

namespace cloth {

/// Contact of a garment with itself and between merged garments. Off by default: then nothing of it
/// is built or run.
struct SelfContactSettings {
    double thickness = 0.0;  ///< distance that cloth keeps from cloth (m), 1e-3 to 2e-2; 0: off.
                             ///< Above half an edge's length folds become stiff
    double weight = 5e5;     ///< w in w max(0, thickness - d)^3 per vertex (N/m^2), 1e3 to 1e6
    double friction = 0.3;   ///< Coulomb coefficient between layers, 0 to 1.5
    int rounds =
        8;  ///< of search and push in contact projection, 0 to 100; 0: no contact projection
    /// What untangling may spend on stretching and lifting the cloth, per length of a tangle (N,
    /// see Untangling), 0 to 10; 0: no untangling. Less leaves tangles of stiff cloth, more
    /// stretches cloth that cannot be untangled.
    double untangling_tension = 1.0;
    /// Moves of at most half the thickness after each step that ends tangled, 0 to 100; 0: no
    /// untangling.
    int untangling_moves = 8;
    int threads = 0;  ///< 0 to 1024; 0: as many as OpenMP gives; results do not depend on it

    bool on() const { return thickness > 0.0; }
    bool untangles() const { return on() && untangling_tension > 0.0 && untangling_moves > 0; }
};

/// @throws ArgumentError if a setting is out of range
void check_self_contact(const SelfContactSettings& settings);

}  // namespace cloth
