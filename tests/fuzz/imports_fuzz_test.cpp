// Somebody's meshes, made into garments on a ball. README.md says what must hold.

#include <gtest/gtest.h>

#include "data/authoring/garment_import.h"
#include "data/authoring/mesh_quality.h"
#include "data/core/errors.h"
#include "tests/fuzz/fuzz_meshes.h"
#include "tests/test_meshes.h"

namespace cloth::test {
namespace {

TriMesh ball() {
    TriMesh skin = icosphere(2);
    skin.vertices *= 0.5;
    skin.vertices.col(1).array() += 0.5;
    return skin;
}

GarmentImportSettings random_settings(Random& random) {
    GarmentImportSettings settings;
    settings.weld = random.chance(0.5) ? 1e-4 : random.uniform(0.0, 0.01);
    settings.clearance = random.uniform(1e-3, 0.05);
    settings.most_inside = random.chance(0.7) ? 1.0 : random.uniform(0.0, 1.0);
    settings.smallest_piece = random.chance(0.5) ? 0.0 : random.uniform(0.0, 1.0);
    settings.vertices = random.chance(0.15) ? random.between(500, 700) : 0;
    settings.band_width = random.uniform(0.02, 0.1);
    settings.band_ratio = random.uniform(0.5, 1.0);
    settings.together = random.chance(0.3);
    return settings;
}

/// Brings a mesh of any size near the ball, as is_in_place() asks for, most of the time.
void bring_near(TriMesh& mesh, Random& random) {
    if (random.chance(0.2) || !mesh.vertices.allFinite()) return;
    const Eigen::RowVector3d low = mesh.vertices.colwise().minCoeff(),
                             high = mesh.vertices.colwise().maxCoeff();
    const double size = (high - low).maxCoeff();
    if (!(size > 0.0)) return;
    mesh.vertices.rowwise() -= 0.5 * (low + high);
    mesh.vertices *= random.uniform(0.1, 1.5) / size;
    mesh.vertices.rowwise() += Eigen::RowVector3d(
        random.uniform(-0.5, 0.5), random.uniform(0.0, 1.0), random.uniform(-0.5, 0.5));
}

void expect_garment(const ImportedGarment& garment, const SurfaceDistance& skin) {
    ASSERT_NO_THROW(validate_mesh("worn", garment.worn));
    ASSERT_NO_THROW(validate_mesh("rest", {garment.rest, garment.worn.faces}));
    EXPECT_TRUE(topology(garment.worn.faces).manifold);
    EXPECT_TRUE(topology(garment.worn.faces).oriented);
    EXPECT_EQ(garment.inside, 0.0);
    EXPECT_GE(smallest_clearance(garment.worn, skin), 0.999e-3);
}

TEST(ImportsFuzz, AreRefusedWithARemedyOrWearable) {
    const TriMesh skin = ball();
    const SurfaceDistance distance(skin);
    int refused = 0, made = 0;
    for_each_seed(300, [&](unsigned seed) {
        SCOPED_TRACE(repeat_with(seed));
        Random random(seed);
        TriMesh mesh = random_mesh(random);
        bring_near(mesh, random);
        try {
            const GarmentImport import = import_garment(mesh, skin, random_settings(random));
            EXPECT_FALSE(import.garments.empty());
            for (const ImportedGarment& garment : import.garments)
                expect_garment(garment, distance);
            ++made;
        } catch (const ArgumentError& error) {
            EXPECT_NE(std::string(error.what()).find("Remedy: "), std::string::npos);
            ++refused;
        }
    });
    if (made + refused < 100) return;  // one round, seen again
    EXPECT_GT(made, 0);
    EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace cloth::test
