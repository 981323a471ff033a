#include "data/authoring/garment_support.h"

#include <algorithm>

#include "data/authoring/mesh_quality.h"

namespace cloth {

namespace {

constexpr double looks_up = 0.7;       // y of the way out of the skin
constexpr double lies_within = 0.03;   // of the skin (m)
constexpr double least_lying = 0.004;  // of the area: straps are narrow
constexpr double pin_band = 0.03;      // height of the pins below the upper edge (m)

/// Heights of the skin, as parts of the body's.
struct Heights {
    double low = 0.0, size = 1.0;
    explicit Heights(const Points& skin)
        : low(skin.col(1).minCoeff()), size(skin.col(1).maxCoeff() - skin.col(1).minCoeff()) {}
    double operator()(double y) const { return (y - low) / size; }
};

/// The part of the upper half's faces that lies on skin which looks upwards, by area.
double lying_share(const TriMesh& worn, const SurfaceDistance& skin) {
    const VectorX area = face_area_vectors(worn.vertices, worn.faces).rowwise().norm();
    const double middle = 0.5 * (worn.vertices.col(1).minCoeff() + worn.vertices.col(1).maxCoeff());
    double lying = 0.0;
    for (Eigen::Index f = 0; f < worn.faces.rows(); ++f) {
        const Vec3 at = (worn.vertices.row(worn.faces(f, 0)) + worn.vertices.row(worn.faces(f, 1)) +
                         worn.vertices.row(worn.faces(f, 2))) /
                        3.0;
        if (at.y() < middle) continue;
        const auto near = skin.nearest_within(lies_within, at);
        if (near && near->normal.y() > looks_up) lying += area[f];
    }
    return lying / area.sum();
}

struct Loop {
    std::vector<int> vertices;
    Vec3 centre;
    bool around_body;
};

std::vector<Loop> loops_of(const TriMesh& worn, const SurfaceDistance& skin) {
    std::vector<Loop> loops;
    for (std::vector<int>& loop : boundary_loops(worn.faces)) {
        const Vec3 centre = worn.vertices(loop, Eigen::all).colwise().mean().transpose();
        loops.push_back({std::move(loop), centre, skin.nearest(centre).distance < 0.0});
    }
    std::sort(loops.begin(), loops.end(),
              [](const Loop& a, const Loop& b) { return a.centre.y() > b.centre.y(); });
    return loops;
}

std::string sort_of(const GarmentSupport& support, const std::vector<Loop>& loops, double bottom,
                    double top) {
    if (bottom > 0.85) return "hat";
    if (top < 0.2) return "shoes";
    const auto legs = std::count_if(loops.begin() + (loops.empty() ? 0 : 1), loops.end(),
                                    [](const Loop& loop) { return loop.around_body; });
    if (support.kind == GarmentSupport::Kind::shoulders) {
        if (bottom > 0.4) return "top";
        return loops.size() >= 5 ? "suit" : "dress";
    }
    if (support.kind == GarmentSupport::Kind::pins) return "piece";
    if (legs == 2) return "trousers";
    return top > 0.7 ? "dress" : "skirt";
}

}  // namespace

const char* name_of(GarmentSupport::Kind kind) {
    switch (kind) {
        case GarmentSupport::Kind::shoulders:
            return "shoulders";
        case GarmentSupport::Kind::waistband:
            return "waistband";
        case GarmentSupport::Kind::pins:
            break;
    }
    return "pins";
}

GarmentSupport find_support(const TriMesh& worn, const SurfaceDistance& skin) {
    GarmentSupport support;
    support.lying_share = lying_share(worn, skin);
    const std::vector<Loop> loops = loops_of(worn, skin);
    const double top = worn.vertices.col(1).maxCoeff();
    support.pin_low = top - pin_band;
    support.pin_high = top;
    if (support.lying_share > least_lying) {
        support.kind = GarmentSupport::Kind::shoulders;
    } else if (!loops.empty() && loops.front().around_body) {
        support.kind = GarmentSupport::Kind::waistband;
        support.upper_edge = loops.front().vertices;
        support.pin_low = worn.vertices(support.upper_edge, Eigen::all).col(1).minCoeff() - 1e-3;
    }
    const Heights part(skin.surface().vertices);
    support.sort = sort_of(support, loops, part(worn.vertices.col(1).minCoeff()), part(top));
    return support;
}

}  // namespace cloth
