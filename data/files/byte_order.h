#pragma once

#include <cstdint>
#include <cstring>
#include <string>

namespace cloth {

/// Which byte of a number comes first in a file, whatever the machine does.
enum class ByteOrder { little, big };

/// Where the byte of weight 256^k of a number of four bytes lies.
constexpr int byte_place(int k, ByteOrder order) {
    return order == ByteOrder::little ? k : 3 - k;
}

/// Appends a number of four bytes, such as std::int32_t and float.
template <typename Number>
void append_number(std::string& bytes, Number number, ByteOrder order) {
    static_assert(sizeof(Number) == 4, "numbers in point caches have four bytes");
    std::uint32_t bits = 0;
    std::memcpy(&bits, &number, sizeof bits);
    char raw[4];
    for (int k = 0; k < 4; ++k)
        raw[byte_place(k, order)] = static_cast<char>(bits >> (8 * k) & 0xff);
    bytes.append(raw, sizeof raw);
}

/// The number in four bytes.
template <typename Number>
Number number_at(const char* bytes, ByteOrder order) {
    static_assert(sizeof(Number) == 4, "numbers in point caches have four bytes");
    std::uint32_t bits = 0;
    for (int k = 0; k < 4; ++k) {
        const auto byte = static_cast<unsigned char>(bytes[byte_place(k, order)]);
        bits |= static_cast<std::uint32_t>(byte) << (8 * k);
    }
    Number number;
    std::memcpy(&number, &bits, sizeof number);
    return number;
}

}  // namespace cloth
