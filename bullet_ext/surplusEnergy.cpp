#include "bullet_ext/surplusEnergy.h"

#include <algorithm>
#include <cmath>

namespace cloth {

double takeFromMotion(double surplus, const VectorX& masses, bool floats, Points& v) {
    const double mass = masses.sum();
    if (!(surplus > 0.0) || !(mass > 0.0)) return std::max(0.0, surplus);
    const Eigen::RowVector3d mean = (floats ? 1.0 / mass : 0.0) * (masses.transpose() * v);
    const double moving = 0.5 * masses.dot((v.rowwise() - mean).rowwise().squaredNorm());
    if (!(moving > 0.0)) return surplus;
    const double taken = std::min(surplus, moving), kept = std::sqrt(1.0 - taken / moving);
    for (Eigen::Index i = 0; i < masses.size(); ++i)
        if (masses[i] > 0.0) v.row(i) = mean + kept * (v.row(i) - mean);
    return surplus - taken;
}

TakenWay takeFromWay(double surplus, std::initializer_list<double> parts,
                     const std::function<double(const Points&)>& energy, const Points& from,
                     Points& x) {
    const double whole = energy(x);
    Points best = x;
    double taken = 0.0, gone = 1.0;
    for (const double part : parts) {
        if (taken >= surplus) break;
        const Points on_the_way = from + part * (x - from);
        const double less = whole - energy(on_the_way);
        if (less > taken) taken = less, gone = part, best = on_the_way;
    }
    x = best;
    return {std::max(0.0, surplus - taken), gone};
}

}  // namespace cloth
