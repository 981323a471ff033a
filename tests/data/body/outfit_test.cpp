#include "data/body/outfit.h"

#include <gtest/gtest.h>

#include "data/body/body.h"
#include "data/core/errors.h"
#include "data/core/surface_distance.h"
#include "data/files/garment_assets.h"

namespace cloth::outfit_test {

namespace {

TriMesh worn_part(const Outfit& outfit, const std::string& name, size_t part) {
    const int first = outfit.first_vertex[part];
    return {outfit.start.x.middleRows(first, outfit.first_vertex[part + 1] - first),
            load_garment_mesh(name).faces};
}

TEST(Outfit, ASingleNameIsThatGarment) {
    const Outfit outfit = load_outfit("pants_1000");
    EXPECT_FALSE(outfit.has_layers());
    EXPECT_EQ(outfit.garment.rest().vertices, load_garment_mesh("pants_1000").vertices);
    EXPECT_EQ(outfit.start.x, load_garment_start("pants_1000").x);
    EXPECT_EQ(outfit.first_vertex,
              (std::vector<int>{0, static_cast<int>(outfit.garment.vertex_count())}));
}

TEST(Outfit, TheFirstIsWornOverTheOthers) {
    const std::vector<std::string> names = {"shirt_1000", "tshirt_1000", "pants_1000"};
    const Outfit outfit = load_outfit("shirt_1000+tshirt_1000+pants_1000");
    ASSERT_EQ(outfit.first_vertex.size(), 4u);
    EXPECT_TRUE(outfit.has_layers());
    for (size_t outer = 0; outer < names.size(); ++outer)
        for (size_t inner = outer + 1; inner < names.size(); ++inner) {
            const SurfaceDistance below(worn_part(outfit, names[inner], inner));
            const TriMesh above = worn_part(outfit, names[outer], outer);
            int close = 0;
            for (Eigen::Index i = 0; i < above.vertices.rows(); ++i) {
                const Vec3 p = above.vertices.row(i);
                const auto near = below.nearest_within(0.02, p);
                if (!near) continue;
                const double height = (p - near->point).dot(near->normal);
                if ((p - near->point).norm() - height > 1e-6) continue;  // beside a border
                ++close;
                EXPECT_GT(height, Outfit::gap - 1e-6) << names[outer] << " over " << names[inner];
            }
            EXPECT_GT(close, 20) << names[outer] << " over " << names[inner];
        }
}

TEST(Outfit, TheInnermostIsWornAsAlone) {
    const Outfit outfit = load_outfit("tshirt_1000+pants_1000");
    EXPECT_EQ(worn_part(outfit, "pants_1000", 1).vertices, load_garment_start("pants_1000").x);
    const Body body = Body::load_default();
    EXPECT_GT(
        smallest_clearance(worn_part(outfit, "tshirt_1000", 0), SurfaceDistance(body.rest_mesh())),
        4e-3);
}

TEST(Outfit, AnotherBodyWearsItInTheSameOrder) {
    const Outfit outfit = load_outfit("tshirt_1000+pants_1000");
    const Body body = Body::load_default();
    Points broad = body.rest();
    broad.col(0) *= 1.06;
    broad.col(2) *= 1.12;
    const Body other = body.with_rest(broad);
    const Outfit fitted = fit_outfit(outfit, body, other);
    ASSERT_EQ(fitted.part_count(), 2);
    EXPECT_EQ(fitted.first_vertex, outfit.first_vertex);
    EXPECT_EQ(fitted.garment.rest().faces, outfit.garment.rest().faces);
    const SurfaceDistance skin(other.rest_mesh());
    const TriMesh shirt = worn_part(fitted, "tshirt_1000", 0),
                  pants = worn_part(fitted, "pants_1000", 1);
    EXPECT_GT(smallest_clearance(shirt, skin), 4e-3);
    EXPECT_GT(smallest_clearance(pants, skin), 4e-3);
    const SurfaceDistance below(pants);
    for (Eigen::Index i = 0; i < shirt.vertices.rows(); ++i) {
        const auto near = below.nearest_within(0.02, shirt.vertices.row(i));
        if (!near) continue;
        const Vec3 away = Vec3(shirt.vertices.row(i)) - near->point;
        const double height = away.dot(near->normal);
        if (away.norm() - height > 1e-6) continue;  // beside a border
        EXPECT_GT(height, Outfit::gap - 1e-6);
    }
    // Ease and waistband are kept: rest and worn shape move alike.
    EXPECT_LT(((fitted.garment.rest().vertices - outfit.garment.rest().vertices) -
               (fitted.start.x - outfit.start.x))
                  .cwiseAbs()
                  .maxCoeff(),
              1e-12);
    EXPECT_GT((fitted.start.x - outfit.start.x).rowwise().norm().maxCoeff(), 0.01);
}

TEST(Outfit, FacesOfAPartAreItsOwn) {
    const Outfit outfit = load_outfit("tshirt_1000+pants_1000");
    Eigen::Index faces = 0;
    for (int part = 0; part < outfit.part_count(); ++part) {
        const Faces own = outfit.faces_of_part(part);
        EXPECT_GE(own.minCoeff(), outfit.first_vertex[static_cast<size_t>(part)]);
        EXPECT_LT(own.maxCoeff(), outfit.first_vertex[static_cast<size_t>(part) + 1]);
        faces += own.rows();
    }
    EXPECT_EQ(faces, outfit.garment.face_count());
}

TEST(Outfit, WrongNamesAreNamed) {
    EXPECT_THROW(load_outfit("tshirt_1000+toga"), LoadError);
    EXPECT_THROW(load_outfit(""), LoadError);
}

}  // namespace

}  // namespace cloth::outfit_test
