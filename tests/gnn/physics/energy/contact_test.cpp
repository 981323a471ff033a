#include "gnn/physics/energy/contact.h"

#include "tests/gnn/physics/physics_scenes.h"

namespace cloth::contact_test {

using namespace cloth::test;

namespace {

constexpr double eps = 4e-3, weight = 5e5;

class ContactTest : public ::testing::Test {
 protected:
    Garment garment{"sheet", sheet(5, 0.2), Fabric::soft_cotton()};
    Vec3 normal = Vec3(0.2, 1.0, -0.3).normalized();
    /// A sheet that cuts through the plane: some vertices inside, some near, some far.
    Points x = deformed(garment, 3) * 0.05;
    SurfaceContacts contacts = plane_contacts(x, x.colwise().mean(), normal, Vec3(0.002, 0.001, 0));
    ContactEnergy contact;

    void SetUp() override { contact.begin_step(contacts, eps); }
    void gradient(const Points& y, Points& out) const {
        out.setZero(y.rows(), 3);
        contact.add_gradient(y, weight, out);
    }
};

}  // namespace

TEST_F(ContactTest, EnergyIsTheCubeOfTheDepthBelowTheCarriedPlane) {
    double expected = 0.0;
    int inside = 0;
    for (Eigen::Index i = 0; i < x.rows(); ++i) {
        const double distance = (x.row(i) - contacts.point1.row(i)).dot(normal.transpose());
        inside += distance < eps;
        expected += weight * std::pow(std::max(0.0, eps - distance), 3);
    }
    ASSERT_GT(inside, 3);
    ASSERT_LT(inside, x.rows() - 3);
    EXPECT_NEAR(contact.value(x, weight), expected, 1e-12 * expected);
}

TEST_F(ContactTest, GradientEqualsFiniteDifferences) {
    expect_gradient([&](const Points& y) { return contact.value(y, weight); },
                    [&](const Points& y, Points& g) { gradient(y, g); }, x, 1e-7, 1e-6);
}

TEST_F(ContactTest, HessianEqualsFiniteDifferences) {
    const BlockPattern pattern(garment);
    Eigen::SparseMatrix<double> hessian;
    pattern.reset(hessian);
    contact.add_hessian(x, weight, pattern, hessian.valuePtr());
    const Points direction = noise(x.rows(), 1.0, 9);
    Points product(x.rows(), 3);
    Eigen::Map<VectorX>(product.data(), product.size()) =
        hessian * Eigen::Map<const VectorX>(direction.data(), direction.size());
    const Points numeric = numeric_hessian_product(
        [&](const Points& y, Points& g) { gradient(y, g); }, x, direction, 1e-7);
    expect_close(product, numeric, 1e-6);
}

TEST_F(ContactTest, NothingBeyondTheContactDistanceOrWithoutContacts) {
    const Points above = x.rowwise() + 0.2 * normal.transpose();
    EXPECT_EQ(contact.value(above, weight), 0.0);
    contacts.obstacle.assign(contacts.obstacle.size(), -1);
    contact.begin_step(contacts, eps);
    EXPECT_EQ(contact.value(x, weight), 0.0);
    contact.begin_step({}, eps);
    EXPECT_EQ(contact.value(x, weight), 0.0);
}

TEST_F(ContactTest, MovesWithTheSurface) {
    const Eigen::RowVector3d shift(0.3, -0.1, 0.2);
    SurfaceContacts moved = contacts;
    moved.point1.rowwise() += shift;
    const double before = contact.value(x, weight);
    contact.begin_step(moved, eps);
    EXPECT_NEAR(contact.value(x.rowwise() + shift, weight), before, 1e-10 * before);
}

}  // namespace cloth::contact_test
