#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "data/core/errors.h"

namespace cloth::test {

/// What a call says by an ArgumentError; "" if it throws none.
inline std::string refusal(const std::function<void()>& call) {
    try {
        call();
    } catch (const ArgumentError& error) {
        return error.what();
    }
    return "";
}

/// What `make` says about a value; "" if it takes it.
inline std::string refusal(const std::function<void(double)>& make, double value) {
    return refusal([&] { make(value); });
}

inline void expect_refused(const std::string& field, double value,
                           const std::function<void(double)>& make) {
    const std::string message = refusal(make, value);
    EXPECT_NE(message.find(field), std::string::npos)
        << field << " = " << value << ": '" << message << "'";
    EXPECT_NE(message.find(" is out of range"), std::string::npos) << message;
}

/// Expects `make` to take both ends of a field's range, and to refuse what is beyond them and NaN
/// by an ArgumentError that names the field.
inline void expect_range(const std::string& field, double low, double high,
                         const std::function<void(double)>& make) {
    EXPECT_EQ(refusal(make, low), "") << field;
    EXPECT_EQ(refusal(make, high), "") << field;
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const double wrong : {std::nextafter(low, -infinity), std::nextafter(high, infinity),
                               -infinity, infinity, std::numeric_limits<double>::quiet_NaN()})
        expect_refused(field, wrong, make);
}

/// The same for a field of whole numbers.
inline void expect_int_range(const std::string& field, int low, int high,
                             const std::function<void(int)>& make) {
    const auto with = [&](double value) { make(static_cast<int>(value)); };
    EXPECT_EQ(refusal(with, low), "") << field;
    EXPECT_EQ(refusal(with, high), "") << field;
    expect_refused(field, low - 1, with);
    expect_refused(field, high + 1, with);
}

/// A table's row for a member of a settings struct: `use` hands the settings to what checks them.
template <class Settings, class Use>
void expect_range(const std::string& field, double Settings::*member, double low, double high,
                  const Use& use) {
    expect_range(field, low, high, [&](double value) {
        Settings settings;
        settings.*member = value;
        use(settings);
    });
}

template <class Settings, class Use>
void expect_range(const std::string& field, int Settings::*member, int low, int high,
                  const Use& use) {
    expect_int_range(field, low, high, [&](int value) {
        Settings settings;
        settings.*member = value;
        use(settings);
    });
}

}  // namespace cloth::test
