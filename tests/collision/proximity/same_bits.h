#pragma once

#include <gtest/gtest.h>

#include "collision/proximity/proximity.h"

namespace cloth::test {

inline void expect_same_bits(const SurfaceContacts& a, const SurfaceContacts& b) {
    EXPECT_EQ(a.obstacle, b.obstacle);
    EXPECT_EQ(a.face, b.face);
    EXPECT_EQ(a.barycentric, b.barycentric);
    EXPECT_EQ(a.point0, b.point0);
    EXPECT_EQ(a.point1, b.point1);
    EXPECT_EQ(a.normal0, b.normal0);
    EXPECT_EQ(a.normal1, b.normal1);
    EXPECT_EQ(a.distance, b.distance);
}

}  // namespace cloth::test
