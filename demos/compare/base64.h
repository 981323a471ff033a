#pragma once

#include <string>

namespace cloth {

/// Bytes as text of 64 harmless characters (RFC 4648, section 4), for pictures inside HTML.
std::string base64(const std::string& bytes);

}  // namespace cloth
