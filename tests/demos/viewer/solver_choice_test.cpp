#include "demos/viewer/solver_choice.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "demos/compare/solver_factory.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::viewer_solver_test {

namespace {

class FreeSheet : public ComparisonScene {
 public:
    FreeSheet()
        : ComparisonScene(Garment("sheet", cloth::test::sheet(4, 0.1), Fabric::soft_cotton())) {}
    Boundary boundary(double, double) const override { return {}; }
};

}  // namespace

TEST(ViewerSolver, EveryKindIsASolverWithAnyNumberOfTheSlider) {
    const FreeSheet scene;
    for (const std::string& kind : solver_kinds())
        for (const int k : {1, 100}) {
            const SolverChoice choice{kind, k};
            EXPECT_NO_THROW(make_solver(choice.name(), scene, {})) << choice.name();
        }
}

TEST(ViewerSolver, ANameIsAKindAndANumber) {
    for (const std::string name : {"xpbd-40", "quasi-newton-7", "newton-3", "small+3"}) {
        const SolverChoice choice = SolverChoice::of(name);
        EXPECT_TRUE(choice.has_number()) << name;
        EXPECT_EQ(choice.name(), name);
    }
    EXPECT_EQ(SolverChoice::of("xpbd-40").kind, "xpbd-N");
    EXPECT_EQ(SolverChoice::of("xpbd-40").k, 40);
    EXPECT_EQ(SolverChoice::of("small+3").kind, "small+K");
}

TEST(ViewerSolver, OtherNamesStayAsTheyAre) {
    for (const std::string name : {"quasi-newton", "small", "reference", "quasi-newton-10-bdf2",
                                   "quasi-newton@20", "quasi-newton-5x3", "bf16-small"}) {
        EXPECT_FALSE(SolverChoice::of(name).has_number()) << name;
        EXPECT_EQ(SolverChoice::of(name).name(), name);
    }
}

TEST(ViewerSolver, PhysicsNetworksAndXpbdCanBeChosen) {
    const std::vector<std::string> kinds = solver_kinds();
    for (const char* kind : {"quasi-newton", "xpbd-N", "small", "small+K", "reference"})
        EXPECT_NE(std::find(kinds.begin(), kinds.end(), kind), kinds.end()) << kind;
}

}  // namespace cloth::viewer_solver_test
