#include "gnn/physics/energy/incremental_potential.h"

#include <Eigen/SparseCholesky>
#include <limits>

#include "data/core/errors.h"
#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::incremental_potential_test {

using namespace cloth::test;

namespace {

/// A deformed, moving sheet that cuts a moving plane, with wind: every term is at work.
class PotentialTest : public ::testing::TestWithParam<Fabric> {
 protected:
    Garment garment{"sheet", sheet(6, 0.3), GetParam(), {0, 5}};
    IncrementalPotential potential{garment};
    ClothState state = ClothState::at_rest(garment);
    Boundary boundary;
    SurfaceContacts contacts;
    Points x;

    PotentialTest() {
        state.x = deformed(garment, 1);
        state.v = noise(state.x.rows(), 0.3, 2);
        boundary.obstacles.resize(1);
        boundary.accelerations = noise(state.x.rows(), 2.0, 3);
        contacts = plane_contacts(state.x, state.x.colwise().mean(), Vec3::UnitY(),
                                  Vec3(0.005, 0.002, 0.001));
        x = state.x + noise(state.x.rows(), 0.003, 4);
        add_ridges();
        potential.begin_step(state, boundary, contacts, 1.0 / 30.0);
    }
    /// Faces pressed 3 mm into ridges, among them one at a pin.
    void add_ridges() {
        for (const int face : {0, 7, 20, 33}) {
            RidgeContact ridge{face, {0.5, 0.2, 0.3}, Vec3(0.3, 0.8, 0.1 * face).normalized(), 0.0};
            for (size_t k = 0; k < 3; ++k)
                ridge.height +=
                    ridge.weight[k] *
                    x.row(garment.rest().faces(face, static_cast<int>(k))).dot(ridge.normal);
            ridge.height += 0.003;
            contacts.ridges.push_back(ridge);
        }
    }
    void zero_pins(Points& g) const {
        for (int pin : garment.pins()) g.row(pin).setZero();
    }
};

}  // namespace

TEST_P(PotentialTest, TermsAddUpToTheValueAndAllAreAtWork) {
    const EnergyTerms terms = potential.terms(x);
    for (double term : {terms.strain, terms.bending, terms.inertia, terms.contact, terms.friction})
        EXPECT_GT(term, 0.0);
    EXPECT_NE(terms.gravity, 0.0);
    Points g;
    EXPECT_DOUBLE_EQ(terms.total(), potential.value(x));
    EXPECT_DOUBLE_EQ(terms.total(), potential.value_gradient(x, g));
}

TEST_P(PotentialTest, RidgesFollowTheirLawAtTheirDistance) {
    const double with = potential.terms(x).contact;
    contacts.ridges.clear();
    potential.begin_step(state, boundary, contacts, 1.0 / 30.0);
    const PotentialSettings& settings = potential.settings();
    const double each =
        RidgeEnergy::law(settings.ridge_distance + 0.003, settings.contact_weight).energy;
    EXPECT_GT(each, 0.0);
    EXPECT_NEAR(with - potential.terms(x).contact, 4.0 * each, 1e-9 * with);
}

TEST(RidgeEnergy, LawIsCubicThenOfConstantStiffnessWithoutAJump) {
    const double w = 5e5, h = 1e-9;
    for (const double depth : {-1e-3, 1e-4, 1.9e-4, 2.1e-4, 3e-3}) {
        const auto at = RidgeEnergy::law(depth, w);
        const auto low = RidgeEnergy::law(depth - h, w), high = RidgeEnergy::law(depth + h, w);
        EXPECT_NEAR(at.force, (high.energy - low.energy) / (2 * h), 1e-6 * at.force + 1e-9);
        EXPECT_NEAR(at.stiffness, (high.force - low.force) / (2 * h), 1e-5 * at.stiffness + 1e-6);
    }
    EXPECT_DOUBLE_EQ(RidgeEnergy::law(1e-4, w).energy, w * 1e-12);
    EXPECT_NEAR(RidgeEnergy::law(2e-4 + 1e-12, w).energy, RidgeEnergy::law(2e-4, w).energy, 1e-12);
    EXPECT_EQ(RidgeEnergy::law(5e-3, w).stiffness, RidgeEnergy::law(2e-4, w).stiffness);
    EXPECT_EQ(RidgeEnergy::law(-1e-3, w).energy, 0.0);
}

TEST_P(PotentialTest, RidgesOfFacesThatDoNotExistAreRefused) {
    contacts.ridges[0].face = static_cast<int>(garment.face_count());
    EXPECT_THROW(potential.begin_step(state, boundary, contacts, 1.0 / 30.0), ArgumentError);
}

TEST_P(PotentialTest, GradientEqualsFiniteDifferencesOfTheFreeVertices) {
    Points analytic, numeric;
    potential.value_gradient(x, analytic);
    numeric = numeric_gradient([&](const Points& y) { return potential.value(y); }, x, 2e-6);
    zero_pins(numeric);
    expect_close(analytic, numeric, 1e-6);
    EXPECT_EQ(analytic.row(0).norm(), 0.0);
}

TEST_P(PotentialTest, ElasticGradientIsTheGradientOfStrainAndBending) {
    Points elastic;
    potential.elastic_gradient(x, elastic);
    Points numeric = numeric_gradient(
        [&](const Points& y) {
            const EnergyTerms terms = potential.terms(y);
            return terms.strain + terms.bending;
        },
        x, 2e-6);
    zero_pins(numeric);
    expect_close(elastic, numeric, 1e-6);
}

TEST_P(PotentialTest, ExactHessianEqualsFiniteDifferences) {
    Eigen::SparseMatrix<double> hessian;
    potential.hessian(x, hessian, HessianKind::exact);
    Points direction = noise(x.rows(), 1.0, 7);
    zero_pins(direction);
    Points product(x.rows(), 3);
    Eigen::Map<VectorX>(product.data(), product.size()) =
        hessian * Eigen::Map<const VectorX>(direction.data(), direction.size());
    const Points numeric = numeric_hessian_product(
        [&](const Points& y, Points& g) { potential.value_gradient(y, g); }, x, direction, 1e-7);
    expect_close(product, numeric, 1e-5);
}

TEST_P(PotentialTest, ProjectedHessianHasACholeskyFactorAndUnitPins) {
    Eigen::SparseMatrix<double> hessian;
    potential.hessian(x, hessian);
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> cholesky(hessian);
    EXPECT_EQ(cholesky.info(), Eigen::Success);
    for (int pin : garment.pins())
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_EQ(hessian.coeff(3 * pin + axis, 3 * pin + axis), 1.0);
            EXPECT_DOUBLE_EQ(hessian.col(3 * pin + axis).norm(), 1.0);
        }
}

TEST_P(PotentialTest, RefilledHessianEqualsAFreshOne) {
    Eigen::SparseMatrix<double> refilled, fresh;
    potential.hessian(state.x, refilled);
    const double* values = refilled.valuePtr();
    potential.hessian(x, refilled);
    potential.hessian(x, fresh);
    EXPECT_EQ(values, refilled.valuePtr()) << "the pattern was built again";
    EXPECT_EQ((refilled - fresh).norm(), 0.0);
}

TEST_P(PotentialTest, TranslatingEverythingChangesGravityAlone) {
    const Eigen::RowVector3d shift(0.7, -0.4, 0.2);
    const EnergyTerms before = potential.terms(x);
    ClothState moved = state;
    moved.x.rowwise() += shift;
    contacts.point0.rowwise() += shift;
    contacts.point1.rowwise() += shift;
    for (RidgeContact& ridge : contacts.ridges) ridge.height += shift.dot(ridge.normal);
    potential.begin_step(moved, boundary, contacts, 1.0 / 30.0);
    const EnergyTerms after = potential.terms(x.rowwise() + shift);
    EXPECT_NEAR(after.strain, before.strain, 1e-9 * before.strain);
    EXPECT_NEAR(after.bending, before.bending, 1e-9 * before.bending);
    EXPECT_NEAR(after.inertia, before.inertia, 1e-9 * before.inertia);
    EXPECT_NEAR(after.contact, before.contact, 1e-9 * before.contact);
    EXPECT_NEAR(after.friction, before.friction, 1e-9 * before.friction);
    double expected = before.gravity;
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        expected -= garment.masses()[i] *
                    shift.dot(boundary.gravity.transpose() + boundary.accelerations.row(i));
    EXPECT_NEAR(after.gravity, expected, 1e-12);
}

TEST_P(PotentialTest, FreeFallIsTheMinimumWithoutElasticity) {
    const Garment free("sheet", sheet(6, 0.3), GetParam());
    IncrementalPotential falling(free);
    ClothState rest = ClothState::at_rest(free);
    rest.v.rowwise() = Eigen::RowVector3d(1, 2, 3);
    const double dt = 0.02;
    falling.begin_step(rest, {}, {}, dt);
    const Eigen::RowVector3d motion =
        dt * Eigen::RowVector3d(1, 2, 3) + dt * dt * Eigen::RowVector3d(0, -9.81, 0);
    Points g;
    falling.value_gradient(rest.x.rowwise() + motion, g);
    EXPECT_LT(g.norm(), 1e-9 * falling.force_scale());
}

TEST_P(PotentialTest, ForceScaleIsTheNormOfInertiaAndGravityAtTheStart) {
    const double dt = 1.0 / 30.0;
    double squared = 0.0;
    for (Eigen::Index i = 2; i < x.rows(); ++i) {
        if (i == 5) continue;
        squared += (garment.masses()[i] * (state.v.row(i) / dt + boundary.gravity.transpose() +
                                           boundary.accelerations.row(i)))
                       .squaredNorm();
    }
    squared += (garment.masses()[1] * (state.v.row(1) / dt + boundary.gravity.transpose() +
                                       boundary.accelerations.row(1)))
                   .squaredNorm();
    EXPECT_NEAR(potential.force_scale(), std::sqrt(squared), 1e-9 * std::sqrt(squared));
    boundary = {};
    boundary.gravity.setZero();
    potential.begin_step(ClothState::at_rest(garment), boundary, {}, dt);
    EXPECT_GT(potential.force_scale(), 0.0);
}

TEST_P(PotentialTest, WrongSizesAreRefusedByName) {
    const auto message = [&](const ClothState& s, const Boundary& b, const SurfaceContacts& c,
                             double dt) {
        try {
            potential.begin_step(s, b, c, dt);
        } catch (const ArgumentError& error) {
            return std::string(error.what());
        }
        return std::string("accepted");
    };
    ClothState short_state = state;
    short_state.v.conservativeResize(3, 3);
    EXPECT_NE(message(short_state, boundary, contacts, 0.01).find("state.v"), std::string::npos);
    Boundary short_wind = boundary;
    short_wind.accelerations.conservativeResize(2, 3);
    EXPECT_NE(message(state, short_wind, contacts, 0.01).find("accelerations"), std::string::npos);
    SurfaceContacts bad = contacts;
    bad.normal1.conservativeResize(4, 3);
    EXPECT_NE(message(state, boundary, bad, 0.01).find("normal1"), std::string::npos);
    bad = contacts;
    bad.obstacle[3] = 7;
    EXPECT_NE(message(state, boundary, bad, 0.01).find("obstacle 7"), std::string::npos);
    for (double dt : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_NE(message(state, boundary, contacts, dt).find("dt"), std::string::npos);
    EXPECT_EQ(message(state, boundary, contacts, 0.01), "accepted");
}

TEST_P(PotentialTest, SettingsOutOfRangeAreRefused) {
    PotentialSettings settings;
    settings.contact_weight = -1.0;
    EXPECT_THROW(IncrementalPotential(garment, settings), ArgumentError);
    settings = {};
    settings.friction_slip_speed = 0.0;
    EXPECT_THROW(IncrementalPotential(garment, settings), ArgumentError);
}

INSTANTIATE_TEST_SUITE_P(Fabrics, PotentialTest,
                         ::testing::Values(Fabric::soft_cotton(), Fabric::real_cotton()),
                         fabric_name);

}  // namespace cloth::incremental_potential_test
