#pragma once

#include <string>
#include <vector>

namespace cloth {

enum class Scale { linear, logarithmic };

/// A range of values with round ticks, mapped to 0 ... 1.
struct Axis {
    double low = 0.0;
    double high = 1.0;
    Scale scale = Scale::linear;
    std::vector<double> ticks;  ///< rising, within low and high

    /// Whether a value has a place: finite and, on a logarithmic axis, above 0.
    bool can_show(double value) const;

    /// 0 at low, 1 at high; beyond that outside of the axis.
    double position(double value) const;
};

/// An axis around all values that can be shown: linear ones begin and end at a tick and have ticks
/// at steps of 1, 2 or 5 times a power of ten; logarithmic ones have ticks at powers of ten, and at
/// 2 and 5 times those where decades are few. Without usable values: 0 ... 1, or 1 ... 10.
/// @param wanted_ticks  about how many ticks, 2 or more
Axis axis_for(const std::vector<double>& values, Scale scale, int wanted_ticks = 6);

/// A tick as text: without superfluous digits, with an exponent when very large or small.
std::string tick_text(double tick);

/// A number in a coordinate or attribute: at most `digits` digits after the point, whatever the
/// locale.
std::string fixed_text(double value, int digits);

}  // namespace cloth
