#include "demos/compare/openings.h"

#include <algorithm>
#include <map>

#include "data/core/mesh_pieces.h"
#include "data/core/triangle.h"

namespace cloth {
namespace {

using Mean = std::vector<std::pair<int, double>>;

Vec3 mean_of(const Mean& mean, const Points& x) {
    Vec3 sum = Vec3::Zero();
    for (const auto& [vertex, weight] : mean) sum += weight * x.row(vertex).transpose();
    return sum;
}

/// The skin that follows a joint as much as its parent lies around the joint.
Mean around_joint(const Body& body, int joint) {
    const SkinWeights& weights = body.weights();
    const int parent = body.joints()[static_cast<size_t>(joint)].parent;
    Mean mean;
    double sum = 0.0;
    for (int v = 0; v < weights.vertex_count(); ++v) {
        const double weight = weights.at(v, joint) * weights.at(v, parent);
        if (weight == 0.0) continue;
        mean.emplace_back(v, weight);
        sum += weight;
    }
    for (auto& [vertex, weight] : mean) weight /= sum;
    return mean;
}

/// The vertex that is farthest from the joint, of those that follow it more than any other.
Mean tip(const Body& body, int joint) {
    const std::vector<int> dominant = body.dominant_joint();
    const Vec3 at = body.joints()[static_cast<size_t>(joint)].position;
    std::pair<double, int> farthest{-1.0, 0};
    for (Eigen::Index v = 0; v < body.rest().rows(); ++v)
        if (dominant[static_cast<size_t>(v)] == joint)
            farthest = std::max(farthest, {(body.rest().row(v).transpose() - at).squaredNorm(),
                                           static_cast<int>(v)});
    return {{farthest.second, 1.0}};
}

/// Joints that are no other's parent.
std::vector<int> end_joints(const Body& body) {
    std::vector<char> is_parent(body.joints().size(), 0);
    for (const Joint& joint : body.joints())
        if (joint.parent >= 0) is_parent[static_cast<size_t>(joint.parent)] = 1;
    std::vector<int> ends;
    for (size_t j = 0; j < is_parent.size(); ++j)
        if (!is_parent[j]) ends.push_back(static_cast<int>(j));
    return ends;
}

/// From the joint up to the root.
std::vector<int> way_up(const Body& body, int joint) {
    std::vector<int> way;
    for (; joint >= 0; joint = body.joints()[static_cast<size_t>(joint)].parent)
        way.push_back(joint);
    return way;
}

}  // namespace

std::vector<Openings::Border> Openings::borders(const Faces& faces) {
    std::map<std::pair<int, int>, int> uses;
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int c = 0; c < 3; ++c) ++uses[{faces(f, c), faces(f, (c + 1) % 3)}];
    Border all;
    for (const auto& [edge, count] : uses)
        if (!uses.count({edge.second, edge.first})) all.push_back(edge);
    Faces flat(static_cast<Eigen::Index>(all.size()), 3);  // to be sorted into pieces
    for (size_t e = 0; e < all.size(); ++e)
        flat.row(static_cast<Eigen::Index>(e)) << all[e].first, all[e].second, all[e].second;
    const std::vector<int> piece = face_pieces(flat);
    std::vector<Border> borders(static_cast<size_t>(piece_count(piece)));
    for (size_t e = 0; e < all.size(); ++e)
        borders[static_cast<size_t>(piece[e])].push_back(all[e]);
    return borders;
}

std::vector<Openings::Line> Openings::lines(const Body& body) {
    const std::vector<int> ends = end_joints(body);
    std::vector<Line> lines;
    for (size_t a = 0; a < ends.size(); ++a)
        for (size_t b = a + 1; b < ends.size(); ++b) {
            std::vector<int> up = way_up(body, ends[a]), down = way_up(body, ends[b]);
            while (!up.empty() && !down.empty() && up.back() == down.back()) {
                up.pop_back();
                down.pop_back();
            }
            Line line{ends[a], ends[b], {tip(body, ends[a])}};
            for (const int joint : up) line.points.push_back(around_joint(body, joint));
            for (auto joint = down.rbegin(); joint != down.rend(); ++joint)
                line.points.push_back(around_joint(body, *joint));
            line.points.push_back(tip(body, ends[b]));
            lines.push_back(std::move(line));
        }
    return lines;
}

/// How often the line passes through a surface that the border bounds, any surface: a fan.
int Openings::times_through(const Border& border, const Points& x, const Points& line) {
    Vec3 apex = Vec3::Zero();
    for (const auto& [from, to] : border) apex += x.row(from).transpose();
    apex /= static_cast<double>(border.size());
    apex += 0.1 * (x.row(border.front().second).transpose() - apex) +
            Vec3(3e-5, 1e-5, 2e-5);  // no line of a symmetric body meets an edge of the fan
    int times = 0;
    for (const auto& [from, to] : border) {
        const Vec3 a = x.row(from), b = x.row(to);
        for (Eigen::Index k = 1; k < line.rows(); ++k) {
            const Vec3 begin = line.row(k - 1), way = line.row(k) - line.row(k - 1);
            const auto hit = meet_line(begin, way, apex, a, b);
            if (hit && hit->at >= 0.0 && hit->at < 1.0 && hit->is_inside())
                times += way.dot((a - apex).cross(b - apex)) > 0.0 ? 1 : -1;
        }
    }
    return times;
}

std::vector<Points> Openings::lines_in(const Points& skin) const {
    std::vector<Points> all;
    for (const Line& line : m_lines) {
        Points points(static_cast<Eigen::Index>(line.points.size()), 3);
        for (size_t k = 0; k < line.points.size(); ++k)
            points.row(static_cast<Eigen::Index>(k)) = mean_of(line.points[k], skin);
        all.push_back(std::move(points));
    }
    return all;
}

Openings::Openings(const Garment& garment, const Points& start, const Body& body)
    : m_lines(lines(body)) {
    const std::vector<Points> inside = lines_in(body.rest());
    for (Border& border : borders(garment.rest().faces)) {
        Opening opening;
        std::map<int, int> side;  // of each end: the sign of where lines from it lead
        for (size_t line = 0; line < m_lines.size(); ++line) {
            const int times = times_through(border, start, inside[line]);
            if (times == 0) continue;
            opening.passages.push_back({line, times});
            side[m_lines[line].from] = times > 0 ? 1 : -1;
            side[m_lines[line].to] = times > 0 ? -1 : 1;
        }
        if (opening.passages.empty()) continue;
        const auto ahead =
            std::count_if(side.begin(), side.end(), [](const auto& end) { return end.second > 0; });
        const int fewer = 2 * static_cast<size_t>(ahead) <= side.size() ? 1 : -1;
        for (const auto& [joint, sign] : side)
            if (sign == fewer) opening.limb = body.joints()[static_cast<size_t>(joint)].name;
        opening.border = std::move(border);
        m_openings.push_back(std::move(opening));
    }
}

std::string Openings::slipped_limb(const Points& skin, const Points& x) const {
    const std::vector<Points> inside = lines_in(skin);
    for (const Opening& opening : m_openings) {
        const bool is_worn = std::any_of(
            opening.passages.begin(), opening.passages.end(), [&](const Passage& passage) {
                return times_through(opening.border, x, inside[passage.line]) == passage.times;
            });
        if (!is_worn) return opening.limb;
    }
    return {};
}

}  // namespace cloth
