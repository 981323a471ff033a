#include "data/core/length_units.h"

#include "data/core/errors.h"

namespace cloth {

const std::vector<LengthUnit>& length_units() {
    static const std::vector<LengthUnit> units = {
        {"m", "metres", 1.0},      {"cm", "centimetres", 0.01}, {"mm", "millimetres", 0.001},
        {"dm", "decimetres", 0.1}, {"in", "inches", 0.0254},    {"ft", "feet", 0.3048}};
    return units;
}

const LengthUnit& length_unit(const std::string& name) {
    std::string names;
    for (const LengthUnit& unit : length_units()) {
        if (name == unit.name) return unit;
        names += (names.empty() ? "" : ", ") + std::string(unit.name);
    }
    throw ArgumentError("unit " + name, "there is no such unit", "choose one of " + names);
}

std::vector<LengthUnit> plausible_units(double size, double lowest, double highest) {
    std::vector<LengthUnit> found;
    for (const LengthUnit& unit : length_units())
        if (size * unit.metres >= lowest && size * unit.metres <= highest) found.push_back(unit);
    return found;
}

}  // namespace cloth
