#include "gnn/physics/solver/deflated_cg.h"

#include <gtest/gtest.h>
#include <omp.h>

#include <Eigen/Cholesky>

#include "data/core/garment_pieces.h"
#include "gnn/physics/solver/quasi_newton_matrix.h"
#include "tests/gnn/physics/solver/solver_scenes.h"

namespace cloth::deflated_cg_test {
namespace {

using test::noise;
using test::sheet;

constexpr double time_step = 1.0 / 30.0;

/// So stiff that single precision does not do.
Fabric stiff_cotton() {
    Fabric fabric = Fabric::real_cotton();
    fabric.mu *= 100.0;
    fabric.lambda *= 100.0;
    return fabric;
}

/// Two wavy sheets, one on the other, that are pressed on a wide sphere with ridges: vertices are
/// held by contact, friction and goals, and elements of both sheets by self-contact and friction.
struct Layers {
    using EdgePairs = ContactHessian::EdgePairs;

    Layers(int n, const Fabric& fabric, unsigned seed, EdgePairs edge_pairs = EdgePairs::lumped)
        : garment(sheets(n, fabric, seed)),
          state(ClothState::at_rest(garment)),
          potential(garment, settings()),
          matrix(garment),
          contacts(edge_pairs) {
        for (Eigen::Index i = 0; i < state.x.rows(); ++i)
            state.x(i, 1) += 2e-3 * std::sin(20.0 * state.x(i, 0));
        state.x += noise(state.x.rows(), 1e-4, seed);
        Boundary boundary;
        boundary.obstacles.push_back(test::sphere(Vec3(0.26, -5.006, 0.24), 5.0));
        boundary.pin_targets = test::rows_of(state.x, garment.pins());
        boundary.goals = SkinGoals::at(state.x + noise(state.x.rows(), 2e-3, seed + 1),
                                       noise(state.x.rows(), 1.0, seed + 2).rowwise().normalized());
        SurfaceContacts near;
        Proximity().query(state.x, boundary, near);
        for (int face = 0; face < garment.face_count(); face += 7)
            near.ridges.push_back({face, {0.5, 0.2, 0.3}, Vec3(0.1, 1, 0.2).normalized(), 0.0});
        potential.begin_step(state, boundary, near, time_step);
        EXPECT_TRUE(matrix.prepare(garment, time_step));
        contacts.begin_step(potential, matrix.row_of());
        matrix.deflate(state.x);
        b = noise(matrix.free_count(), 1e-3, seed + 3);
        b.col(1).array() -= 1e-3;
    }

    static Garment sheets(int n, const Fabric& fabric, unsigned seed) {
        TriMesh above = sheet(n, 0.5, 0.2, seed + 1);
        above.vertices.col(1).array() += 3.5e-3;
        Garment both =
            merge_garments("layers", {Garment("below", sheet(n + 1, 0.5, 0.2, seed), fabric),
                                      Garment("above", above, fabric)})
                .garment;
        GoalLimits limits;
        limits.max_distance.setConstant(both.vertex_count(),
                                        std::numeric_limits<double>::infinity());
        limits.backstop = limits.max_distance;
        limits.drive_stiffness.setZero(both.vertex_count());
        limits.drive_damping.setZero(both.vertex_count());
        for (Eigen::Index i = 0; i < both.vertex_count(); ++i) {
            if (i % 9 == 0) limits.max_distance[i] = 1e-3;
            if (i % 5 == 0) limits.drive_stiffness[i] = 100.0;
        }
        return both.with_pins({0, n}).with_goals(limits);
    }
    static PotentialSettings settings() {
        PotentialSettings settings;
        settings.self_contact.thickness = 4e-3;
        return settings;
    }
    /// Whether P is (see QuasiNewtonSystem).
    bool is_in_single_precision() const {
        const double inertia = matrix.system().masses().mean() / (time_step * time_step);
        return matrix.matrix().diagonal().maxCoeff() <= 1e5 * inertia;
    }
    /// Of a linearisation in which some contacts are deep, and others to be anticipated.
    Points solve(int iterations) {
        Points x = state.x, found;
        x.col(1).array() -= 5e-3;
        contacts.linearise(potential, x);
        matrix.solve(b, contacts, iterations, found);
        return found;
    }
    AffineFields fields() const {
        Points points;
        matrix.gather(state.x, points);
        AffineFields fields;
        fields.take(points);
        return fields;
    }
    Points product(const Points& u) const {
        Points product = matrix.matrix() * u;
        contacts.add_product(u, product);
        return product;
    }

    Garment garment;
    ClothState state;
    IncrementalPotential potential;
    QuasiNewtonMatrix matrix;
    ContactHessian contacts;
    Points b;
};

double inner(const Points& a, const Points& c) {
    return a.cwiseProduct(c).sum();
}

/// Deflated conjugate gradients as the textbook has them, in double precision but for the solves
/// with P, whose products follow from the residuals.
template <class Real>
Points plain_answer(const Layers& scene, int iterations) {
    const Eigen::SparseMatrix<double> p = scene.matrix.matrix();
    SupernodalCholesky<Real> preconditioner;
    EXPECT_TRUE(preconditioner.factorise(p));
    const AffineFields fields = scene.fields();
    const auto displacement = [&](const AffineFields::Vector& c) -> Points {
        return fields.columns() * Eigen::Map<const AffineFields::Coefficients>(c.data());
    };
    const auto moments = [&](const Points& a) -> AffineFields::Vector {
        const AffineFields::Coefficients sums = fields.moments(a);
        return Eigen::Map<const AffineFields::Vector>(sums.data());
    };
    AffineFields::System system;
    for (int k = 0; k < system.cols(); ++k)
        system.col(k) = moments(scene.product(displacement(AffineFields::Vector::Unit(k))));
    const Eigen::LDLT<AffineFields::System> factor(system);

    Points z;
    preconditioner.solve(scene.b, z);
    const double enough = 1e-6 * inner(scene.b, z);
    Points x = displacement(factor.solve(moments(scene.b)));
    Points r = scene.b - scene.product(x);
    Points d = Points::Zero(x.rows(), 3), p_d = d;
    double beta = 0.0, power = 0.0;
    for (int k = 0; k < iterations; ++k) {
        preconditioner.solve(r, z);
        const double before = power;
        power = inner(r, z);
        if (!(power > enough)) break;
        if (k > 0) beta = power / before;
        Points of_z = r;  // A z
        scene.contacts.add_product(z, of_z);
        const Points affine = displacement(factor.solve(moments(of_z)));
        d = z + beta * d - affine;
        p_d = r + beta * p_d - p * affine;
        Points product = p_d;
        scene.contacts.add_product(d, product);
        const double step = power / inner(d, product);
        x += step * d;
        r -= step * product;
    }
    return x;
}

Points plain_answer(const Layers& scene, int iterations) {
    return scene.is_in_single_precision() ? plain_answer<float>(scene, iterations)
                                          : plain_answer<double>(scene, iterations);
}

class DeflatedCgOfFabrics : public ::testing::TestWithParam<Fabric> {
 protected:
    /// Later iterations bring out the rounding of both methods, the more the stiffer the fabric.
    static double tolerance(int iterations) {
        const double mu = GetParam().mu;
        if (mu < 100.0) return 5e-6;
        if (iterations > 4) return 2e-2;
        return mu < 1e5 ? 1e-3 : 1e-9;
    }
};

TEST_P(DeflatedCgOfFabrics, FindsWhatThePlainMethodFinds) {
    for (const unsigned seed : {1u, 2u, 3u}) {
        Layers scene(12, GetParam(), seed, ContactHessian::EdgePairs::single);
        EXPECT_EQ(scene.is_in_single_precision(), GetParam().mu < 1e5);
        for (const int iterations : {1, 2, 4, 7}) {
            const Points found = scene.solve(iterations);
            const Points expected = plain_answer(scene, iterations);
            EXPECT_LE((found - expected).norm(), tolerance(iterations) * expected.norm())
                << iterations << " iterations, seed " << seed;
        }
    }
}

/// By how much a step lowers the quadratic model (J).
double decrease(const Layers& scene, const Points& x) {
    return inner(scene.b, x) - 0.5 * inner(x, scene.product(x));
}

/// Couplings that stand for several pairs are stiffer, so rounding shows sooner.
TEST_P(DeflatedCgOfFabrics, FindsTheSameOfLumpedPairs) {
    for (const unsigned seed : {1u, 2u, 3u}) {
        Layers scene(12, GetParam(), seed);
        for (const int iterations : {1, 2, 4}) {
            const Points found = scene.solve(iterations);
            const Points expected = plain_answer(scene, iterations);
            EXPECT_LE((found - expected).norm(), tolerance(iterations) * expected.norm())
                << iterations << " iterations, seed " << seed;
            EXPECT_NEAR(decrease(scene, found) / decrease(scene, expected), 1.0,
                        tolerance(iterations))
                << iterations << " iterations, seed " << seed;
        }
    }
}

TEST_P(DeflatedCgOfFabrics, FindsTheSameBitsWithAnyNumberOfThreads) {
    const int before = omp_get_max_threads();
    Layers scene(48, GetParam(), 4);
    SupernodalCholesky<double> factor;
    ASSERT_TRUE(factor.factorise(scene.matrix.matrix()));
    omp_set_num_threads(1);
    const Points by_one = scene.solve(7);
    int between = 0;
    scene.contacts.for_each_coupling([&](const ContactHessian::Coupling& coupling) {
        for (size_t k = 1; k < 4; ++k)
            between += coupling.weight[k] != 0.0 &&
                       factor.part_of()[static_cast<size_t>(coupling.row[k])] !=
                           factor.part_of()[static_cast<size_t>(coupling.row[0])];
    });
    EXPECT_GT(between, 100);
    for (const int threads : {2, 3}) {
        omp_set_num_threads(threads);
        EXPECT_EQ(factor.threads(), 2) << "the garment must be large enough for this test";
        for (int again = 0; again < 5; ++again) EXPECT_EQ(scene.solve(7), by_one) << threads;
    }
    omp_set_num_threads(before);
    const Points expected = plain_answer(scene, 7);
    EXPECT_LE((by_one - expected).norm(), tolerance(7) * expected.norm());
}

INSTANTIATE_TEST_SUITE_P(Fabrics, DeflatedCgOfFabrics,
                         ::testing::Values(Fabric::soft_cotton(), Fabric::real_cotton(),
                                           stiff_cotton()),
                         [](const auto& fabric) {
                             return "Fabric" + std::to_string(fabric.index);
                         });

TEST(ContactProduct, OfPartsAddUpToTheBlocks) {
    Layers scene(9, Fabric::real_cotton(), 5);
    scene.solve(1);
    const Eigen::Index count = scene.matrix.free_count();
    const auto lanes_of = [&](const Points& a) {
        std::vector<double> lanes(4 * static_cast<size_t>(count), 0.0);
        for (Eigen::Index i = 0; i < count; ++i)
            for (Eigen::Index k = 0; k < 3; ++k) lanes[static_cast<size_t>(4 * i + k)] = a(i, k);
        return lanes;
    };
    const AffineFields fields = scene.fields();
    AffineFields::Coefficients c;
    c = noise(AffineFields::count, 1.0, 6);
    const Points u = noise(count, 1.0, 7), moved = u - fields.columns() * c;
    std::vector<unsigned char> part_of(static_cast<size_t>(count));
    for (size_t row = 0; row < part_of.size(); ++row)
        part_of[row] = static_cast<unsigned char>(row % 11 == 0 ? Crew::top : row / 4 % 2);

    const std::vector<double> direction = lanes_of(u);
    std::vector<double> product = lanes_of(Points::Zero(count, 3));
    AffineFields::System system = AffineFields::System::Zero();
    ContactProduct<double> contacts;
    ContactProduct<double>::Moments moments = {};
    contacts.take(scene.contacts, part_of, fields.columns().data());
    double curvature = 0.0;
    for (size_t part = 0; part < Crew::parts; ++part) {
        contacts.add_to(part, system);
        contacts.find_motions(part, direction.data());
        contacts.add_moments(part, direction.data(), moments);
        curvature += contacts.add_product(part, 0.0, c, direction.data(), product.data());
    }
    for (size_t row = 0; row < part_of.size(); ++row)
        store(product.data() + 4 * row, load(product.data() + 4 * row) + contacts.force(row));

    Points expected = Points::Zero(count, 3), of_u = expected;
    scene.contacts.add_product(moved, expected);
    scene.contacts.add_product(u, of_u);
    Points found(count, 3);
    for (Eigen::Index i = 0; i < count; ++i)
        for (Eigen::Index k = 0; k < 3; ++k) found(i, k) = product[static_cast<size_t>(4 * i + k)];
    EXPECT_LE((found - expected).norm(), 1e-12 * expected.norm());
    EXPECT_NEAR(curvature, inner(moved, expected), 1e-12 * curvature);
    const AffineFields::Coefficients sums = fields.moments(of_u);
    for (int k = 0; k < AffineFields::count; ++k)
        EXPECT_LE((Eigen::Map<const Eigen::RowVector3d>(moments[k]) - sums.row(k)).norm(),
                  1e-12 * sums.norm());
    for (int k = 0; k < system.cols(); ++k) {
        AffineFields::Vector unit = AffineFields::Vector::Unit(k);
        Points of_field = Points::Zero(count, 3);
        scene.contacts.add_product(
            fields.columns() * Eigen::Map<const AffineFields::Coefficients>(unit.data()), of_field);
        const AffineFields::Coefficients column = fields.moments(of_field);
        EXPECT_LE((system.col(k) - Eigen::Map<const AffineFields::Vector>(column.data())).norm(),
                  1e-12 * system.norm());
    }
}

}  // namespace
}  // namespace cloth::deflated_cg_test
