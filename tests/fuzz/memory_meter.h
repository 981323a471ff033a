#pragma once

#include <cstddef>

namespace cloth::test {

/// How much memory the program asks for: malloc is watched, whoever calls it.
///
///     MemoryMeter meter;
///     load(file);
///     EXPECT_LT(meter.peak(), limit);
///
/// A single request above 1 GiB is refused, so that a runaway count cannot take the machine down.
class MemoryMeter {
 public:
    MemoryMeter();
    /// Bytes held at most since construction, above those held then.
    std::size_t peak() const;

 private:
    long long m_start;
};

}  // namespace cloth::test
