#include "demos/bake/slip_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "data/core/garment_pieces.h"
#include "data/core/surface_distance.h"

namespace cloth {
namespace {

// As parts of the character's height, and of a person of 1.7 m: 3 cm, 17 cm and 30 cm. Waistbands
// come to hang on the hips, up to 15 cm below where they were modelled; pinned cloth swings.
constexpr double near_skin = 0.018, far_slid = 0.1, far_swung = 0.18;

/// A tenth of them, at least one.
Eigen::Index tenth(size_t count) {
    return static_cast<Eigen::Index>((count + 9) / 10);
}

double median(VectorX values) {
    double* const middle = values.data() + values.size() / 2;
    std::nth_element(values.data(), middle, values.data() + values.size());
    return *middle;
}

/// Where the skin is nearest to vertices of a garment.
struct Lying {
    std::vector<int> vertices;
    std::vector<NearestPoint> skin;
};

/// The upper half of the vertices that lie on the skin; of cloth that lies nowhere, of the nearest
/// tenth.
Lying hanging_part(const SurfaceDistance& skin, const Points& x, const std::vector<int>& vertices,
                   double near) {
    std::vector<std::pair<double, int>> order;
    for (const int v : vertices) order.emplace_back(std::abs(skin.nearest(x.row(v)).distance), v);
    std::sort(order.begin(), order.end());
    const auto fewest = static_cast<size_t>(tenth(order.size()));
    size_t count = fewest;
    while (count < order.size() && order[count].first <= near) ++count;
    order.resize(count);
    for (auto& [key, v] : order) key = -x(v, 1);
    std::sort(order.begin(), order.end());
    order.resize((count + 1) / 2);
    Lying part;
    for (const auto& [key, v] : order) {
        part.vertices.push_back(v);
        part.skin.push_back(skin.nearest(x.row(v)));
    }
    return part;
}

}  // namespace

SlipCheck::SlipCheck(const Garment& garment, const Points& start, const TriMesh& skin,
                     double height) {
    const std::vector<int> number = garment_pieces(garment);
    std::vector<std::vector<int>> pieces;
    for (size_t v = 0; v < number.size(); ++v) {
        const auto piece = static_cast<size_t>(number[v]);
        pieces.resize(std::max(pieces.size(), piece + 1));
        pieces[piece].push_back(static_cast<int>(v));
    }
    std::vector<bool> held(pieces.size(), garment.has_goals());
    for (const int pin : garment.pins())
        held[static_cast<size_t>(number[static_cast<size_t>(pin)])] = true;
    for (size_t p = 0; p < pieces.size(); ++p)
        m_pieces.push_back(piece_of(start, skin, height, std::move(pieces[p]), held[p]));
}

SlipCheck::Piece SlipCheck::piece_of(const Points& start, const TriMesh& skin, double height,
                                     std::vector<int> vertices, bool is_held) {
    Lying part = hanging_part(SurfaceDistance(skin), start, vertices, near_skin * height);
    Points below(static_cast<Eigen::Index>(part.skin.size()), 3);
    double above = 0.0;  // cloth that is modelled loose comes down to the skin
    for (size_t i = 0; i < part.skin.size(); ++i) {
        below.row(static_cast<Eigen::Index>(i)) = part.skin[i].point;
        above += std::abs(part.skin[i].distance) / static_cast<double>(part.skin.size());
    }
    return {std::move(vertices), std::move(part.vertices), SkinBinding(skin, below),
            above + (is_held ? far_swung : far_slid) * height, is_held};
}

/// From the highest tenth of the skin that it hung from to the nearest cloth, on the average (m).
double SlipCheck::bare(const Piece& piece, const Points& below, const Points& x) {
    const Points cloth = x(piece.all, Eigen::all);
    const Eigen::Index count = tenth(piece.hanging.size());
    double sum = 0.0;
    for (Eigen::Index i = 0; i < count; ++i)
        sum += std::sqrt((cloth.rowwise() - below.row(i)).rowwise().squaredNorm().minCoeff());
    return sum / static_cast<double>(count);
}

std::vector<Slip> SlipCheck::slips(const Points& skin, const Points& x) const {
    std::vector<Slip> slips;
    for (size_t p = 0; p < m_pieces.size(); ++p) {
        const Piece& piece = m_pieces[p];
        const Points below = piece.below.positions(skin);
        const double moved = median((x(piece.hanging, Eigen::all) - below).rowwise().norm());
        if (moved <= piece.far) continue;
        const double way = std::min(moved, bare(piece, below, x));
        if (way > piece.far)
            slips.push_back(
                {static_cast<int>(p), static_cast<int>(m_pieces.size()), way, piece.is_held});
    }
    return slips;
}

std::string slip_message(const std::vector<Slip>& slips) {
    if (slips.empty()) return "";
    const Slip& slip = slips.front();
    const std::string piece = slip.pieces == 1 ? "the garment"
                                               : "piece " + std::to_string(slip.piece + 1) +
                                                     " of " + std::to_string(slip.pieces);
    char text[64];
    std::snprintf(text, sizeof text, "%.2f m from where it was worn", slip.way);
    if (slip.is_held) return piece + " came off the body: it is " + text;
    return piece + " slid off: it is " + text +
           "; give --pin LOW HIGH, the heights of what holds it";
}

}  // namespace cloth
