#pragma once

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "data/core/errors.h"
#include "data/core/printable.h"

namespace cloth {

/// Reads an integer, where `json::get_to()` would cast whatever number there is, fractions and
/// 1e308 among them.
/// @param name  of the field, for the message
/// @throws ArgumentError unless `value` is an integer that `out` can hold
template <typename Integer>
void read_integer(const nlohmann::json& value, const std::string& name, Integer& out) {
    static_assert(std::is_integral_v<Integer> && !std::is_same_v<Integer, bool>);
    using Limits = std::numeric_limits<Integer>;
    const bool negative =
        value.is_number_integer() && !value.is_number_unsigned() && value.get<std::int64_t>() < 0;
    const bool fits =
        negative ? value.get<std::int64_t>() >= static_cast<std::int64_t>(Limits::min())
                 : value.is_number_integer() &&
                       value.get<std::uint64_t>() <= static_cast<std::uint64_t>(Limits::max());
    if (!fits)
        throw ArgumentError(name, printable(value.dump()) + " is no integer, or too large a one",
                            "write an integer");
    out = value.get<Integer>();
}

/// Of a list, or of a list of lists.
template <typename Item>
void read_integer(const nlohmann::json& list, const std::string& name, std::vector<Item>& out) {
    if (!list.is_array())
        throw ArgumentError(name, "is no list", "write a list of integers in [ ]");
    out.resize(list.size());
    for (size_t k = 0; k < out.size(); ++k) read_integer(list[k], name, out[k]);
}

}  // namespace cloth
