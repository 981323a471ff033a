#include "render/plot_axis.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace cloth {

namespace {

/// The nearest of 1, 2, 5 and 10 times a power of ten that is not below `step`.
double round_up_step(double step) {
    const double power = std::pow(10.0, std::floor(std::log10(step)));
    for (double factor : {1.0, 2.0, 5.0})
        if (step <= factor * power * (1.0 + 1e-9)) return factor * power;
    return 10.0 * power;
}

Axis linear_axis(double low, double high, int wanted_ticks) {
    if (high - low <= 1e-12 * std::max(std::abs(low), std::abs(high))) {
        // One value only: it stands in the middle.
        const double half = low == 0.0 ? 0.5 : 0.1 * std::abs(low);
        low -= half;
        high += half;
    }
    const double step = round_up_step((high - low) / std::max(1, wanted_ticks - 1));
    const double first = std::floor(low / step + 1e-9), last = std::ceil(high / step - 1e-9);
    Axis axis;
    axis.low = first * step;
    axis.high = last * step;
    for (double k = first; k <= last; ++k) axis.ticks.push_back(k == 0.0 ? 0.0 : k * step);
    return axis;
}

Axis logarithmic_axis(double low, double high, int wanted_ticks) {
    Axis axis;
    axis.scale = Scale::logarithmic;
    // At least a factor of four, so that some tick is inside.
    const double spare = std::max(1.15, 2.0 / std::sqrt(high / low));
    axis.low = low / spare;
    axis.high = high * spare;
    const int first = static_cast<int>(std::floor(std::log10(axis.low)));
    const int last = static_cast<int>(std::ceil(std::log10(axis.high)));
    const bool between = last - first <= std::max(2, wanted_ticks / 2);
    const int stride = std::max(1, (last - first) / std::max(1, wanted_ticks));
    for (int decade = first; decade <= last; decade += stride)
        for (double factor : {1.0, 2.0, 5.0}) {
            const double tick = factor * std::pow(10.0, decade);
            const bool inside = tick >= axis.low && tick <= axis.high;
            if (inside && (factor == 1.0 || between)) axis.ticks.push_back(tick);
        }
    return axis;
}

}  // namespace

bool Axis::can_show(double value) const {
    return std::isfinite(value) && (scale == Scale::linear || value > 0.0);
}

double Axis::position(double value) const {
    if (scale == Scale::linear) return (value - low) / (high - low);
    return std::log(value / low) / std::log(high / low);
}

Axis axis_for(const std::vector<double>& values, Scale scale, int wanted_ticks) {
    Axis usable;
    usable.scale = scale;
    double low = 0.0, high = 0.0;
    bool empty = true;
    for (double value : values) {
        if (!usable.can_show(value)) continue;
        low = empty ? value : std::min(low, value);
        high = empty ? value : std::max(high, value);
        empty = false;
    }
    if (scale == Scale::linear)
        return empty ? linear_axis(0.0, 1.0, wanted_ticks) : linear_axis(low, high, wanted_ticks);
    return empty ? logarithmic_axis(1.0, 10.0, wanted_ticks)
                 : logarithmic_axis(low, high, wanted_ticks);
}

std::string tick_text(double tick) {
    std::array<char, 64> text{};
    const double size = std::abs(tick);
    const bool plain = size == 0.0 || (size > 0.9e-3 && size < 1e5);
    const auto format = plain ? std::chars_format::general : std::chars_format::scientific;
    const auto end =
        std::to_chars(text.data(), text.data() + text.size(), tick, format, plain ? 6 : 0);
    return {text.data(), end.ptr};
}

std::string fixed_text(double value, int digits) {
    std::array<char, 400> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                   std::chars_format::fixed, digits);
    std::string result(text.data(), end.ptr);
    if (result.find('.') == std::string::npos) return result;
    result.erase(result.find_last_not_of('0') + 1);
    if (result.back() == '.') result.pop_back();
    return result == "-0" ? "0" : result;
}

}  // namespace cloth
