#include "data/authoring/seams.h"

#include <algorithm>
#include <vector>

#include "data/core/mesh_pieces.h"
#include "data/core/weld.h"

namespace cloth {

namespace {

constexpr double tolerances[] = {2e-4, 5e-4, 1e-3, 2e-3, 3e-3, 5e-3};  // (m)
constexpr int fewest = 4;  // vertices: fewer are chance, not a seam

double border_edge_count(const Faces& faces) {
    return border_share(faces) * static_cast<double>(undirected_edges(faces).size());
}

}  // namespace

OpenSeams find_open_seams(const TriMesh& mesh) {
    const double before = border_edge_count(mesh.faces);
    std::vector<OpenSeams> found;
    std::vector<double> closed;  // border edges that are gone
    for (const double tolerance : tolerances) {
        const WeldedMesh welded = weld_mesh(mesh, tolerance);
        if (welded.dropped_faces > 0) break;
        if (welded.merged < fewest) continue;
        const double gone = before - border_edge_count(welded.mesh.faces);
        if (gone < fewest) continue;
        found.push_back({tolerance, welded.merged});
        closed.push_back(gone);
    }
    for (size_t k = 0; k < found.size(); ++k)
        if (closed[k] >= 0.9 * closed.back()) return found[k];
    return {};
}

}  // namespace cloth
