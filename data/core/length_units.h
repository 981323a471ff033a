#pragma once

#include <string>
#include <vector>

namespace cloth {

/// A unit that mesh files are in; few of them say so.
struct LengthUnit {
    const char* name;    ///< "cm"
    const char* plural;  ///< "centimetres"
    double metres;
};

/// m, cm, mm, dm, in, ft: the usual ones first.
const std::vector<LengthUnit>& length_units();

/// @throws ArgumentError naming the units there are
const LengthUnit& length_unit(const std::string& name);

/// The units in which a length of `size` units is between two lengths (m).
std::vector<LengthUnit> plausible_units(double size, double lowest, double highest);

}  // namespace cloth
