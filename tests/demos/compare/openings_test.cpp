#include "demos/compare/openings.h"

#include <gtest/gtest.h>

#include "data/body/outfit.h"

namespace cloth::openings_test {

namespace {

/// A garment on the default body in its rest pose.
struct Worn {
    explicit Worn(const std::string& name)
        : outfit(load_outfit(name)), openings(outfit.garment, outfit.start.x, body) {}

    std::string slipped_limb(const Points& x) const {
        return openings.slipped_limb(body.rest(), x);
    }

    Body body = Body::load_default();
    Outfit outfit;
    Openings openings;
};

}  // namespace

TEST(Openings, AreThoseThatLimbsComeOutOf) {
    EXPECT_EQ(Worn("tshirt_1000").openings.count(), 4);
    EXPECT_EQ(Worn("pants_1000").openings.count(), 3);
    EXPECT_EQ(Worn("tshirt_1000+pants_1000").openings.count(), 7);
}

TEST(Openings, WhatShiftsAndTurnsALittleIsWorn) {
    const Worn shirt("tshirt_1000");
    const Points& start = shirt.outfit.start.x;
    EXPECT_EQ(shirt.slipped_limb(start), "");
    EXPECT_EQ(shirt.slipped_limb(start.rowwise() + Eigen::RowVector3d(0.01, 0.05, -0.02)), "");
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.3, Vec3::UnitY()).toRotationMatrix();
    EXPECT_EQ(shirt.openings.slipped_limb(shirt.body.rest() * turn, start * turn), "");
}

TEST(Openings, AnArmOutOfItsSleeveIsNamed) {
    const Worn shirt("tshirt_1000");
    for (const double side : {1.0, -1.0}) {
        Points x = shirt.outfit.start.x;
        for (Eigen::Index i = 0; i < x.rows(); ++i)
            if (side * x(i, 0) > 0.22) x(i, 2) += 0.25;  // in front of the arm
        EXPECT_EQ(shirt.slipped_limb(x), side > 0.0 ? "LeftFingerBase" : "RightFingerBase");
    }
}

TEST(Openings, AnArmDrawnIntoTheShirtIsNamed) {
    const Worn shirt("tshirt_1000");
    const Vec3 shoulder =
        shirt.body.joints()[static_cast<size_t>(shirt.body.joint("LeftArm"))].position;
    Points skin = shirt.body.rest();
    for (Eigen::Index i = 0; i < skin.rows(); ++i)
        if (skin(i, 0) > shoulder[0])
            skin.row(i) = shoulder + 0.1 * (skin.row(i).transpose() - shoulder);
    EXPECT_EQ(shirt.openings.slipped_limb(skin, shirt.outfit.start.x), "LeftFingerBase");
}

TEST(Openings, TrousersBesideTheBodyAreOff) {
    const Worn pants("pants_1000");
    const Points& start = pants.outfit.start.x;
    EXPECT_EQ(pants.slipped_limb(start), "");
    EXPECT_NE(pants.slipped_limb(start.rowwise() + Eigen::RowVector3d(0, 0, 0.5)), "");
}

}  // namespace cloth::openings_test
