#pragma once

#include <functional>
#include <initializer_list>

#include "data/core/types.h"

namespace cloth {

/// Takes energy that came from nowhere from the motion of masses.
/// @param surplus  (J)
/// @param masses   |V| (kg), 0: the vertex keeps its velocity
/// @param floats   nothing holds them: from the motion relative to their mean, which keeps momentum
/// @param v        |V| x 3 (m/s)
/// @return what could not be taken (J), 0 or more
double takeFromMotion(double surplus, const VectorX& masses, bool floats, Points& v);

struct TakenWay {
    double left;  ///< what could not be taken (J), 0 or more
    double part;  ///< of the way that is gone
};

/// Takes energy from the way of cloth, which does not go all of it.
/// @param surplus  (J)
/// @param parts    of the way, falling: the first that takes enough, or the one that takes most
/// @param energy   (J) of a shape of the cloth
/// @param from     |V| x 3 (m)
/// @param x        |V| x 3 (m): the end of the way
TakenWay takeFromWay(double surplus, std::initializer_list<double> parts,
                     const std::function<double(const Points&)>& energy, const Points& from,
                     Points& x);

}  // namespace cloth
