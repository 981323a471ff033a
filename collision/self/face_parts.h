#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace cloth {

/// Which part of a garment each face belongs to (|F|), where only different parts are to meet;
/// empty: all faces may.
class FaceParts {
 public:
    FaceParts() = default;
    explicit FaceParts(std::vector<int> part) : m_part(std::move(part)) {}

    bool same(int f, int g) const {
        return !m_part.empty() && m_part[static_cast<size_t>(f)] == m_part[static_cast<size_t>(g)];
    }

 private:
    std::vector<int> m_part;
};

}  // namespace cloth
