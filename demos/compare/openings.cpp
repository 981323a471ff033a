#include "demos/compare/openings.h"

#include <algorithm>
#include <map>

#include "data/core/mesh_pieces.h"
#include "data/core/triangle.h"

namespace cloth {
namespace {

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

/// The skin that follows a joint as much as its parent lies around the joint. A tip is the vertex
/// that is farthest from its joint, of those that follow it more than any other.
void Openings::find_marks(const Body& body) {
    const SkinWeights& weights = body.weights();
    for (size_t j = 0; j < body.joints().size(); ++j) {
        Mean& mean = m_marks.emplace_back();
        const int parent = body.joints()[j].parent;
        double sum = 0.0;
        for (int v = 0; parent >= 0 && v < weights.vertex_count(); ++v) {
            const double weight = weights.at(v, static_cast<int>(j)) * weights.at(v, parent);
            if (weight == 0.0) continue;
            mean.emplace_back(v, weight);
            sum += weight;
        }
        for (auto& [vertex, weight] : mean) weight /= sum;
    }
    const std::vector<int> dominant = body.dominant_joint();
    for (const int end : end_joints(body)) {
        const Vec3 at = body.joints()[static_cast<size_t>(end)].position;
        std::pair<double, int> farthest{-1.0, -1};
        for (size_t v = 0; v < dominant.size(); ++v)
            if (dominant[v] == end) {
                const Vec3 vertex = body.rest().row(static_cast<Eigen::Index>(v));
                farthest = std::max(farthest, {(vertex - at).squaredNorm(), static_cast<int>(v)});
            }
        Mean& tip = m_marks.emplace_back();
        if (farthest.second >= 0) tip = {{farthest.second, 1.0}};
    }
}

void Openings::find_lines(const Body& body) {
    const std::vector<int> ends = end_joints(body);
    const auto tip = [&](size_t end) { return body.joints().size() + end; };
    for (size_t a = 0; a < ends.size(); ++a)
        for (size_t b = a + 1; b < ends.size(); ++b) {
            std::vector<int> up = way_up(body, ends[a]), down = way_up(body, ends[b]);
            while (!up.empty() && !down.empty() && up.back() == down.back()) {
                up.pop_back();
                down.pop_back();
            }
            Line line{ends[a], ends[b], {tip(a)}};
            line.marks.insert(line.marks.end(), up.begin(), up.end());
            line.marks.insert(line.marks.end(), down.rbegin(), down.rend());
            line.marks.push_back(tip(b));
            const auto is_unknown = [&](size_t mark) { return m_marks[mark].empty(); };
            line.marks.erase(std::remove_if(line.marks.begin(), line.marks.end(), is_unknown),
                             line.marks.end());
            m_lines.push_back(std::move(line));
        }
}

Points Openings::marks(const Points& skin) const {
    Points marks = Points::Zero(static_cast<Eigen::Index>(m_marks.size()), 3);
    for (size_t k = 0; k < m_marks.size(); ++k)
        for (const auto& [vertex, weight] : m_marks[k])
            marks.row(static_cast<Eigen::Index>(k)) += weight * skin.row(vertex);
    return marks;
}

/// How often the line passes through a surface that the border bounds, any surface: a fan.
int Openings::times_through(const Border& border, const Points& x, const Line& line,
                            const Points& marks) {
    Vec3 apex = Vec3::Zero();
    for (const auto& [from, to] : border) apex += x.row(from).transpose();
    apex /= static_cast<double>(border.size());
    apex += 0.1 * (x.row(border.front().second).transpose() - apex) +
            Vec3(3e-5, 1e-5, 2e-5);  // no line of a symmetric body meets an edge of the fan
    int times = 0;
    for (const auto& [from, to] : border) {
        const Vec3 a = x.row(from), b = x.row(to);
        for (size_t k = 1; k < line.marks.size(); ++k) {
            const Vec3 begin = marks.row(static_cast<Eigen::Index>(line.marks[k - 1]));
            const Vec3 end = marks.row(static_cast<Eigen::Index>(line.marks[k]));
            const auto hit = meet_line(begin, end - begin, apex, a, b);
            if (hit && hit->at >= 0.0 && hit->at < 1.0 && hit->is_inside())
                times += (end - begin).dot((a - apex).cross(b - apex)) > 0.0 ? 1 : -1;
        }
    }
    return times;
}

/// Borders that touch each other count as one.
std::vector<Openings::Border> Openings::borders(const Faces& faces) {
    const Border all = border_edges(faces);
    Faces flat(static_cast<Eigen::Index>(all.size()), 3);  // to be sorted into pieces
    for (size_t e = 0; e < all.size(); ++e)
        flat.row(static_cast<Eigen::Index>(e)) << all[e].first, all[e].second, all[e].second;
    const std::vector<int> piece = face_pieces(flat);
    std::vector<Border> borders(static_cast<size_t>(piece_count(piece)));
    for (size_t e = 0; e < all.size(); ++e)
        borders[static_cast<size_t>(piece[e])].push_back(all[e]);
    return borders;
}

Openings::Openings(const Garment& garment, const Points& start, const Body& body) {
    find_marks(body);
    find_lines(body);
    const Points inside = marks(body.rest());
    for (Border& border : borders(garment.rest().faces)) {
        Opening opening;
        std::map<int, int> side;  // of each end: the sign of where lines from it lead
        for (size_t line = 0; line < m_lines.size(); ++line) {
            const int times = times_through(border, start, m_lines[line], inside);
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
    const Points inside = marks(skin);
    for (const Opening& opening : m_openings) {
        const auto passes = [&](const Passage& passage) {
            return times_through(opening.border, x, m_lines[passage.line], inside) == passage.times;
        };
        if (std::none_of(opening.passages.begin(), opening.passages.end(), passes))
            return opening.limb;
    }
    return {};
}

}  // namespace cloth
