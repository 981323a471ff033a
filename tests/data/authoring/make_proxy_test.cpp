#include "data/authoring/make_proxy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "data/authoring/mesh_quality.h"
#include "data/authoring/sheet.h"
#include "data/core/errors.h"
#include "data/core/garment_pieces.h"
#include "data/core/mesh_embedding.h"
#include "data/core/surface_distance.h"
#include "data/files/garment_assets.h"
#include "tests/test_meshes.h"

namespace cloth::make_proxy_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

ProxySettings about(int vertices) {
    ProxySettings settings;
    settings.vertices = vertices;
    return settings;
}

/// The nearest vertex of the proxy (m).
double distance_to(const Garment& proxy, const Vec3& p) {
    return (proxy.rest().vertices.rowwise() - p.transpose()).rowwise().norm().minCoeff();
}

std::string refusal(const Garment& fine, const ProxySettings& settings) {
    try {
        make_proxy(fine, settings);
    } catch (const ArgumentError& error) {
        return error.what();
    }
    return "";
}

void expect_words(const std::string& text, const std::vector<std::string>& words) {
    for (const std::string& word : words)
        EXPECT_NE(text.find(word), std::string::npos) << word << " is not in: " << text;
}

/// A sheet of a metre.
Garment fine_sheet(std::vector<int> pins = {}) {
    return Garment("sheet", make_sheet(1.0, 1.0, 2500), Fabric::soft_cotton(), std::move(pins));
}

TriMesh moved(TriMesh mesh, const Vec3& by) {
    mesh.vertices.rowwise() += by.transpose();
    return mesh;
}

/// Two triangles, 0.1 m wide.
TriMesh small_square() {
    TriMesh mesh = test::square_mesh(2);
    mesh.vertices *= 0.1;
    return mesh;
}

TriMesh joined(const TriMesh& a, const TriMesh& b) {
    TriMesh all{Points(a.vertices.rows() + b.vertices.rows(), 3),
                Faces(a.faces.rows() + b.faces.rows(), 3)};
    all.vertices << a.vertices, b.vertices;
    all.faces << a.faces, (b.faces.array() + static_cast<int>(a.vertices.rows())).matrix();
    return all;
}

}  // namespace

class ProxyOfGarment : public testing::TestWithParam<std::string> {};

TEST_P(ProxyOfGarment, IsTheSameSurfaceOfFewerAndGoodTriangles) {
    const Garment fine = load_garment(GetParam());
    for (const int vertices : {300, 1000}) {
        SCOPED_TRACE(vertices);
        if (vertices >= fine.vertex_count()) continue;
        const Garment proxy = make_proxy(fine, about(vertices));
        EXPECT_NEAR(static_cast<double>(proxy.vertex_count()), vertices, 0.05 * vertices);
        EXPECT_GT(smallest_angle(proxy.rest()), 18.0);
        const Topology before = topology(fine.rest().faces), after = topology(proxy.rest().faces);
        EXPECT_TRUE(after.manifold && after.oriented);
        EXPECT_EQ(after.components, before.components);
        EXPECT_EQ(after.boundary_loops, before.boundary_loops);
        EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
        const double edge = proxy.mean_edge_length();
        EXPECT_NEAR(proxy.face_areas().sum() / fine.face_areas().sum(), 1.0, 0.04);
        // Both ways: nothing is added, and nothing is left out. Pants are farthest in the fork.
        const SurfaceDistance surface(fine.rest());
        for (Eigen::Index i = 0; i < proxy.vertex_count(); ++i)
            EXPECT_LT(std::abs(surface.nearest(proxy.rest().vertices.row(i).transpose()).distance),
                      1e-9);
        EXPECT_LT(MeshEmbedding(proxy.rest(), fine.rest(), {0.5}).farthest(), 0.7 * edge);
        // Borders lie on the borders.
        for (const std::vector<int>& loop : boundary_loops(proxy.rest().faces))
            for (const int v : loop)
                EXPECT_LT(distance_to(fine, proxy.rest().vertices.row(v).transpose()),
                          fine.mean_edge_length());
        EXPECT_EQ(proxy.fabric().mu, fine.fabric().mu);
    }
}

INSTANTIATE_TEST_SUITE_P(Wardrobe, ProxyOfGarment,
                         testing::Values("tshirt", "pants", "dress_4000", "shirt", "skirt", "cape"),
                         [](const auto& garment) { return garment.param; });

TEST(MakeProxy, EqualArgumentsGiveEqualBits) {
    const Garment fine = load_garment("tshirt_2000");
    const Garment a = make_proxy(fine, about(500)), b = make_proxy(fine, about(500));
    EXPECT_TRUE(a.rest().vertices == b.rest().vertices);
    EXPECT_TRUE(a.rest().faces == b.rest().faces);
}

TEST(MakeProxy, CornersOfBordersStay) {
    const Garment fine = fine_sheet();
    const Garment proxy = make_proxy(fine, about(200));
    for (const int corner : sheet_corners(fine.rest()))
        EXPECT_LT(distance_to(proxy, fine.rest().vertices.row(corner).transpose()), 1e-12);
    EXPECT_NEAR(proxy.face_areas().sum(), 1.0, 1e-9);
}

TEST(MakeProxy, SinglePinsStayWhereTheyAre) {
    // Two corners, a place on a side, and one in the middle.
    Garment fine = fine_sheet();
    std::vector<int> pins = {sheet_corners(fine.rest())[0], sheet_corners(fine.rest())[1],
                             sheet_side(fine.rest(), SheetSide::front)[20]};
    Eigen::Index middle = 0;
    fine.rest().vertices.rowwise().norm().minCoeff(&middle);
    pins.push_back(static_cast<int>(middle));
    fine = fine.with_pins(pins);
    const Garment proxy = make_proxy(fine, about(200));
    ASSERT_EQ(proxy.pins().size(), 4u);
    for (const int pin : fine.pins())
        EXPECT_LT(distance_to(proxy, fine.rest().vertices.row(pin).transpose()), 1e-12);
    EXPECT_GT(smallest_angle(proxy.rest()), 15.0);
}

TEST(MakeProxy, APinnedRegionIsPinned) {
    Garment fine = fine_sheet();
    std::vector<int> pins;
    for (int i = 0; i < fine.vertex_count(); ++i)
        if (fine.rest().vertices(i, 0) < -0.2) pins.push_back(i);
    fine = fine.with_pins(pins);
    const Garment proxy = make_proxy(fine, about(300));
    const double edge = fine.mean_edge_length();
    for (int i = 0; i < proxy.vertex_count(); ++i) {
        const double x = proxy.rest().vertices(i, 0);
        if (x < -0.2 - edge) {
            EXPECT_TRUE(proxy.is_pinned()[static_cast<size_t>(i)]) << x;
        }
        if (x > -0.2 + edge) {
            EXPECT_FALSE(proxy.is_pinned()[static_cast<size_t>(i)]) << x;
        }
    }
}

TEST(MakeProxy, APinnedSideIsPinned) {
    Garment fine = fine_sheet();
    fine = fine.with_pins(sheet_side(fine.rest(), SheetSide::left));
    const Garment proxy = make_proxy(fine, about(300));
    for (int i = 0; i < proxy.vertex_count(); ++i)
        EXPECT_EQ(proxy.is_pinned()[static_cast<size_t>(i)] != 0,
                  proxy.rest().vertices(i, 0) < -0.5 + 1e-9)
            << i;
}

TEST(MakeProxy, GoalsAndRestAnglesAreCarriedOver) {
    const TriMesh mesh = make_sheet(1.0, 1.0, 2500);
    GoalLimits limits;
    limits.max_distance = 0.5 * (mesh.vertices.col(0).array() + 0.5);
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i)
        if (mesh.vertices(i, 0) > 0.2) limits.max_distance[i] = infinity;
    limits.drive_stiffness = VectorX::Constant(mesh.vertices.rows(), 30.0);
    const Garment fine = Garment("cape", mesh, Fabric::soft_cotton(), {}, true).with_goals(limits);
    const Garment proxy = make_proxy(fine, about(200));
    EXPECT_TRUE(proxy.rest_angles_from_mesh());
    const GoalLimits& carried = proxy.goal_limits();
    EXPECT_EQ(carried.backstop.size(), 0);
    for (Eigen::Index i = 0; i < proxy.vertex_count(); ++i) {
        const double x = proxy.rest().vertices(i, 0);
        EXPECT_NEAR(carried.drive_stiffness[i], 30.0, 1e-9);
        if (x < 0.15) {
            EXPECT_NEAR(carried.max_distance[i], 0.5 * (x + 0.5), 1e-9);
        }
        if (x > 0.25) {
            EXPECT_EQ(carried.max_distance[i], infinity);
        }
    }
}

TEST(MakeProxy, PiecesAreMadeOneByOne) {
    const TriMesh big = make_sheet(1.0, 1.0, 2000),
                  small = moved(make_sheet(0.5, 0.5, 500), {0.0, 0.01, 0.0}),
                  patch = moved(small_square(), {2.0, 0.0, 0.0});
    const Garment fine("two layers and a patch", joined(joined(big, small), patch),
                       Fabric::soft_cotton());
    const Garment proxy = make_proxy(fine, about(600));
    const std::vector<int> piece = garment_pieces(proxy);
    std::vector<int> sizes(3, 0);
    for (const int p : piece) ++sizes.at(static_cast<size_t>(p));
    EXPECT_NEAR(sizes[0], 600.0 / 1.26, 24.0);
    EXPECT_NEAR(sizes[1], 150.0 / 1.26, 12.0);
    EXPECT_EQ(sizes[2], 4) << "it has fewer than its share";
    for (Eigen::Index i = 0; i < proxy.vertex_count(); ++i) {
        const double height = piece[static_cast<size_t>(i)] == 1 ? 0.01 : 0.0;
        EXPECT_NEAR(proxy.rest().vertices(i, 1), height, 1e-9) << "layers are not mixed";
    }
}

TEST(MakeProxy, AClosedSurfaceStaysClosed) {
    TriMesh ball = test::icosphere(4);
    ball.vertices *= 0.2;
    const Garment fine("ball", ball, Fabric::soft_cotton());
    const Garment proxy = make_proxy(fine, about(200));
    EXPECT_EQ(topology(proxy.rest().faces).boundary_loops, 0);
    EXPECT_EQ(topology(proxy.rest().faces).euler_characteristic, 2);
}

TEST(MakeProxy, BadInputIsRefusedByName) {
    const Garment fine = fine_sheet();
    expect_words(refusal(fine, about(19)), {"ProxySettings.vertices", "19"});
    expect_words(refusal(fine, about(100001)), {"ProxySettings.vertices"});
    ProxySettings steep;
    steep.smallest_angle = 30.0;
    expect_words(refusal(fine, steep), {"ProxySettings.smallest_angle"});
    expect_words(refusal(fine, about(2500)), {"sheet", "2500 vertices", "coarser", "Remedy"});

    const TriMesh scrap = moved(make_sheet(0.05, 0.05, 100), {2.0, 0.0, 0.0});
    const Garment with_scrap("coat", joined(fine.rest(), scrap), Fabric::soft_cotton());
    expect_words(refusal(with_scrap, about(300)),
                 {"coat, the piece of vertex 2500", "hardly larger than an edge", "Remedy: ask"});

    TriMesh torn = fine.rest();
    torn.faces.row(0).reverseInPlace();
    expect_words(refusal(Garment("torn", torn, Fabric::soft_cotton()), about(300)),
                 {"torn", "which side is outside"});

    // Two sheets that share one vertex.
    constexpr int last = 30 * 30 - 1;
    TriMesh bow_tie = joined(test::square_mesh(30), moved(test::square_mesh(30), {1.0, 0.0, 1.0}));
    bow_tie.faces = bow_tie.faces.unaryExpr([](int v) { return v > last ? v - 1 : v; }).eval();
    Points vertices(bow_tie.vertices.rows() - 1, 3);
    vertices << bow_tie.vertices.topRows(last + 1), bow_tie.vertices.bottomRows(last);
    bow_tie.vertices = vertices;
    expect_words(refusal(Garment("bow tie", bow_tie, Fabric::soft_cotton()), about(300)),
                 {"bow tie", "no two-manifold"});
}

}  // namespace cloth::make_proxy_test
