#pragma once

#include "data/core/garment.h"

namespace cloth {

struct ProxySettings {
    int vertices = 1000;  ///< about so many, 20 to 100000; pieces get shares by their areas
    double smallest_angle = 10.0;  ///< of its triangles (degrees), 1 to 25: with a smaller one it
                                   ///< is refused
};

/// A coarse garment that is simulated in place of a fine one, see EmbeddedStepper. It covers the
/// same surface with triangles as equal as can be, and has the fine garment's fabric, pins, goal
/// limits and source of rest angles, see carry_over().
///
///     const Garment proxy = make_proxy(shirt);
///
/// Each connected piece is remeshed on its own. Borders stay where they are, and so do their
/// corners (turns of more than 35 degrees) and single pins, as far as edges are short enough.
/// Pieces that have no more vertices than their share keep their mesh. Equal arguments give equal
/// bits.
///
/// @throws ArgumentError naming the garment, and the piece by one of its vertices: if a setting is
///         out of range, the garment is not finer than asked for, its surface is no oriented
///         two-manifold, or a piece is too small or too thin for its share of vertices
Garment make_proxy(const Garment& fine, const ProxySettings& settings = {});

}  // namespace cloth
