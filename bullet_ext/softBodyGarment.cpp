#include "bullet_ext/softBodyGarment.h"

#include <BulletSoftBody/btSoftBody.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include "data/core/errors.h"

namespace cloth {

namespace {

int nodeIndex(const btSoftBody& body, const btSoftBody::Node* node) {
    return static_cast<int>(node - &body.m_nodes[0]);
}

void checkNumbers(const btSoftBody& body) {
    for (int i = 0; i < body.m_nodes.size(); ++i) {
        const btSoftBody::Node& node = body.m_nodes[i];
        const std::string place = softBodyName(body) + ", node " + std::to_string(i);
        if (!toVec3(node.m_x).allFinite() || !toVec3(node.m_v).allFinite())
            throw ArgumentError(place, "position or velocity is not finite",
                                "set finite values before the body is simulated");
        if (!std::isfinite(node.m_im) || node.m_im < 0)
            throw ArgumentError(place, "inverse mass is negative or not finite",
                                "use setMass() or setTotalMass() with positive masses; 0 pins");
    }
}

/// Area of the faces around each node, a third each (|V|, m^2).
VectorX nodeAreas(const Points& x, const Faces& faces) {
    const VectorX areas = face_area_vectors(x, faces).rowwise().norm();
    VectorX node_areas = VectorX::Zero(x.rows());
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        for (int c = 0; c < 3; ++c) node_areas[faces(f, c)] += areas[f] / 3.0;
    return node_areas;
}

/// Mass per area of the nodes that are free to move (kg/m^2); 0 if all are pinned.
double bodyDensity(const btSoftBody& body, const Points& x, const Faces& faces) {
    const VectorX areas = nodeAreas(x, faces);
    double mass = 0.0, area = 0.0;
    for (int i = 0; i < body.m_nodes.size(); ++i)
        if (body.m_nodes[i].m_im > 0) {
            mass += 1.0 / static_cast<double>(body.m_nodes[i].m_im);
            area += areas[i];
        }
    return area > 0.0 ? mass / area : 0.0;
}

using Edge = std::array<int, 2>;

/// Faces at each edge: their number, and whether they run along it from the smaller node.
std::map<Edge, std::vector<std::pair<int, bool>>> facesAtEdges(const Faces& faces) {
    std::map<Edge, std::vector<std::pair<int, bool>>> edges;
    for (int f = 0; f < static_cast<int>(faces.rows()); ++f)
        for (int c = 0; c < 3; ++c) {
            const int a = faces(f, c), b = faces(f, (c + 1) % 3);
            edges[{std::min(a, b), std::max(a, b)}].emplace_back(f, a < b);
        }
    return edges;
}

/// A face twice would be an edge of three faces, or a bag without inside; better say what it is.
void checkFacesDiffer(const std::string& name, const Faces& faces) {
    std::map<std::array<int, 3>, int> seen;
    for (int f = 0; f < static_cast<int>(faces.rows()); ++f) {
        std::array<int, 3> corners = {faces(f, 0), faces(f, 1), faces(f, 2)};
        std::sort(corners.begin(), corners.end());
        const auto [it, inserted] = seen.try_emplace(corners, f);
        if (!inserted)
            throw ArgumentError(
                name + ", faces " + std::to_string(it->second) + " and " + std::to_string(f),
                "join the same nodes", "remove one of them");
    }
}

/// Turns faces so that neighbours run along their common edge in opposite directions.
void orientFaces(const std::string& name, Faces& faces) {
    const auto edges = facesAtEdges(faces);
    std::vector<std::vector<std::pair<int, bool>>> neighbours(static_cast<size_t>(faces.rows()));
    for (const auto& [edge, users] : edges) {
        if (users.size() > 2)
            throw ArgumentError(
                name + ", edge " + std::to_string(edge[0]) + "-" + std::to_string(edge[1]),
                "has more than two faces", "split the mesh there, or remove duplicate faces");
        if (users.size() < 2) continue;
        const bool same = users[0].second == users[1].second;
        neighbours[static_cast<size_t>(users[0].first)].emplace_back(users[1].first, same);
        neighbours[static_cast<size_t>(users[1].first)].emplace_back(users[0].first, same);
    }
    std::vector<int> turned(neighbours.size(), -1), queue;
    for (size_t seed_face = 0; seed_face < neighbours.size(); ++seed_face) {
        if (turned[seed_face] >= 0) continue;
        turned[seed_face] = 0;
        queue.assign(1, static_cast<int>(seed_face));
        while (!queue.empty()) {
            const auto f = static_cast<size_t>(queue.back());
            queue.pop_back();
            for (const auto& [g, same] : neighbours[f]) {
                const int wanted = turned[f] ^ static_cast<int>(same);
                int& now = turned[static_cast<size_t>(g)];
                if (now < 0) queue.push_back(g);
                if (now >= 0 && now != wanted)
                    throw ArgumentError(name, "the surface has one side only (Moebius strip)",
                                        "cut the mesh so that it has two sides");
                now = wanted;
            }
        }
    }
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        if (turned[static_cast<size_t>(f)]) std::swap(faces(f, 1), faces(f, 2));
}

/// Largest relative difference between link lengths in x and their rest lengths.
double lengthError(const btSoftBody& body, const Points& x) {
    double error = 0.0;
    for (int l = 0; l < body.m_links.size(); ++l) {
        const btSoftBody::Link& link = body.m_links[l];
        if (link.m_bbending || !(link.m_rl > 0)) continue;
        const double length =
            (x.row(nodeIndex(body, link.m_n[0])) - x.row(nodeIndex(body, link.m_n[1]))).norm();
        error = std::max(error, std::abs(length / static_cast<double>(link.m_rl) - 1.0));
    }
    return error;
}

/// Moves x until every link has its rest length: any such shape has the rest shape's strains.
void restoreLengths(const btSoftBody& body, Points& x) {
    for (int l = 0; l < body.m_links.size(); ++l) {
        const btSoftBody::Link& link = body.m_links[l];
        if (link.m_bbending || !(link.m_rl > 0)) continue;
        const int a = nodeIndex(body, link.m_n[0]), b = nodeIndex(body, link.m_n[1]);
        const Eigen::RowVector3d d = x.row(b) - x.row(a);
        const double length = d.norm();
        if (!(length > 0.0)) continue;
        const Eigen::RowVector3d move = (0.5 * (1.0 - static_cast<double>(link.m_rl) / length)) * d;
        x.row(a) += move;
        x.row(b) -= move;
    }
}

Points restPositions(const btSoftBody& body) {
    Points x = nodePositions(body);
    // Until its first step Bullet takes the present lengths for rest lengths, whatever m_rl says.
    if (body.m_bUpdateRtCst) return x;
    constexpr double kExact = 1e-4, kUsable = 0.02;
    constexpr int kSweeps = 2000;
    double error = lengthError(body, x);
    for (int sweep = 0; error > kExact && sweep < kSweeps; ++sweep) {
        restoreLengths(body, x);
        if (sweep % 20 == 19) error = lengthError(body, x);
    }
    if (error > kUsable)
        throw ArgumentError(softBodyName(body),
                            "rest lengths of the links do not fit together (" +
                                std::to_string(100.0 * error) + " % off)",
                            "attach the body in its rest shape, or give a Garment to attach()");
    return x;
}

}  // namespace

std::string softBodyName(const btSoftBody& body) {
    std::ostringstream name;
    name << "soft body " << body.getUserIndex() << " at " << static_cast<const void*>(&body);
    return name.str();
}

bool isCloth(const btSoftBody& body) {
    const btSoftBody::Config& cfg = body.m_cfg;
    const bool pose = cfg.kMT > 0 && body.m_pose.m_bframe;
    return body.m_faces.size() > 0 && body.m_tetras.size() == 0 && body.m_clusters.size() == 0 &&
           body.m_joints.size() == 0 && cfg.kPR == 0 && cfg.kVC == 0 && !pose;
}

bool isClosed(const btSoftBody& body) {
    if (body.m_faces.size() == 0) return false;
    const auto edges = facesAtEdges(faceNodes(body));
    return std::all_of(edges.begin(), edges.end(),
                       [](const auto& edge) { return edge.second.size() > 1; });
}

bool isHardAnchor(const btSoftBody::Anchor& anchor) {
    return anchor.m_influence >= btScalar(0.999);
}

std::vector<LinkAnchor> linkAnchors(const btSoftBody& body) {
    std::vector<LinkAnchor> anchors;
    for (int a = 0; a < body.m_deformableAnchors.size(); ++a) {
        const btSoftBody::DeformableNodeRigidAnchor& anchor = body.m_deformableAnchors[a];
        if (isLink(*anchor.m_cti.m_colObj))
            anchors.push_back(
                {nodeIndex(body, anchor.m_node), anchor.m_cti.m_colObj, anchor.m_local});
    }
    return anchors;
}

int idleAnchor(const btSoftBody& body) {
    for (int a = 0; a < body.m_deformableAnchors.size(); ++a) {
        const btSoftBody::DeformableNodeRigidAnchor& anchor = body.m_deformableAnchors[a];
        if (!isLink(*anchor.m_cti.m_colObj)) return nodeIndex(body, anchor.m_node);
    }
    return -1;
}

std::vector<int> pinnedNodes(const btSoftBody& body) {
    std::vector<int> pins;
    for (int i = 0; i < body.m_nodes.size(); ++i)
        if (!(body.m_nodes[i].m_im > 0)) pins.push_back(i);
    for (int a = 0; a < body.m_anchors.size(); ++a)
        if (isHardAnchor(body.m_anchors[a]))
            pins.push_back(nodeIndex(body, body.m_anchors[a].m_node));
    for (const LinkAnchor& anchor : linkAnchors(body)) pins.push_back(anchor.node);
    std::sort(pins.begin(), pins.end());
    pins.erase(std::unique(pins.begin(), pins.end()), pins.end());
    return pins;
}

Points nodePositions(const btSoftBody& body) {
    Points x(body.m_nodes.size(), 3);
    for (int i = 0; i < body.m_nodes.size(); ++i) x.row(i) = toVec3(body.m_nodes[i].m_x);
    return x;
}

Faces faceNodes(const btSoftBody& body) {
    Faces faces(body.m_faces.size(), 3);
    for (int f = 0; f < body.m_faces.size(); ++f)
        for (int c = 0; c < 3; ++c) faces(f, c) = nodeIndex(body, body.m_faces[f].m_n[c]);
    return faces;
}

void checkCloth(const btSoftBody& body) {
    const std::string name = softBodyName(body);
    if (body.m_faces.size() == 0)
        throw ArgumentError(name, "has no faces, so it is not cloth",
                            "leave it to Bullet, or add faces with appendFace()");
    if (!isCloth(body))
        throw ArgumentError(name,
                            "has tetrahedra, clusters, joints, pressure, volume or pose "
                            "matching, so it is not cloth",
                            "leave it to Bullet");
    checkNumbers(body);
}

Garment garmentOfSoftBody(const btSoftBody& body, Fabric fabric, bool use_body_density) {
    checkCloth(body);
    const Points rest = restPositions(body);
    if (use_body_density) {
        fabric.density = bodyDensity(body, rest, faceNodes(body));
        if (!(fabric.density > 0.0))
            throw ArgumentError(softBodyName(body),
                                "every node is pinned, so its density is unknown",
                                "free at least one node, or use the fabric's density");
    }
    return garmentOfSoftBody(body, fabric, rest, /*rest_angles=*/false);
}

Garment garmentOfSoftBody(const btSoftBody& body, Fabric fabric, const Points& rest,
                          bool rest_angles) {
    const std::string name = softBodyName(body);
    checkCloth(body);
    TriMesh mesh{rest, faceNodes(body)};
    checkFacesDiffer(name, mesh.faces);
    orientFaces(name, mesh.faces);
    return Garment(name, std::move(mesh), fabric, pinnedNodes(body), rest_angles);
}

double massRatio(const btSoftBody& body, const Garment& garment) {
    double of_nodes = 0.0, of_garment = 0.0;
    for (int i = 0; i < body.m_nodes.size(); ++i)
        if (body.m_nodes[i].m_im > 0) {
            of_nodes += 1.0 / static_cast<double>(body.m_nodes[i].m_im);
            of_garment += garment.masses()[i];
        }
    return of_garment > 0.0 ? of_nodes / of_garment : 0.0;
}

void checkGarmentFits(const btSoftBody& body, const Garment& garment) {
    const std::string name = softBodyName(body) + " with garment " + garment.name();
    if (body.m_nodes.size() != garment.vertex_count() ||
        body.m_faces.size() != garment.face_count())
        throw ArgumentError(name, "numbers of nodes or faces differ",
                            "make the body with createGarmentSoftBody()");
    auto sorted = [](Faces faces) {
        std::vector<std::array<int, 3>> rows;
        for (Eigen::Index f = 0; f < faces.rows(); ++f) {
            std::array<int, 3> row = {faces(f, 0), faces(f, 1), faces(f, 2)};
            std::sort(row.begin(), row.end());
            rows.push_back(row);
        }
        std::sort(rows.begin(), rows.end());
        return rows;
    };
    if (sorted(faceNodes(body)) != sorted(garment.rest().faces))
        throw ArgumentError(name, "faces join other nodes than the garment's",
                            "make the body with createGarmentSoftBody()");
}

size_t topologySignature(const btSoftBody& body) {
    size_t hash = static_cast<size_t>(body.m_nodes.size());
    for (int f = 0; f < body.m_faces.size(); ++f)
        for (int c = 0; c < 3; ++c)
            hash = hash * 1099511628211ull ^
                   static_cast<size_t>(nodeIndex(body, body.m_faces[f].m_n[c]));
    return hash;
}

std::vector<double> restLengths(const btSoftBody& body) {
    if (body.m_bUpdateRtCst) return lengthsAt(body, nodePositions(body));
    std::vector<double> lengths;
    for (int l = 0; l < body.m_links.size(); ++l)
        if (!body.m_links[l].m_bbending)
            lengths.push_back(static_cast<double>(body.m_links[l].m_rl));
    return lengths;
}

std::vector<double> lengthsAt(const btSoftBody& body, const Points& x) {
    std::vector<double> lengths;
    for (int l = 0; l < body.m_links.size(); ++l) {
        const btSoftBody::Link& link = body.m_links[l];
        if (!link.m_bbending)
            lengths.push_back(
                (x.row(nodeIndex(body, link.m_n[0])) - x.row(nodeIndex(body, link.m_n[1]))).norm());
    }
    return lengths;
}

std::optional<double> commonFactor(const std::vector<double>& from, const std::vector<double>& to) {
    constexpr double kSame = 1e-3;
    if (from.empty() || from.size() != to.size()) return std::nullopt;
    double sum_from = 0.0, sum_to = 0.0;
    for (size_t i = 0; i < from.size(); ++i) {
        sum_from += from[i];
        sum_to += to[i];
    }
    const double factor = sum_to / sum_from;
    if (!(factor >= 0.0) || !std::isfinite(factor)) return std::nullopt;
    for (size_t i = 0; i < from.size(); ++i)
        if (!(std::abs(to[i] - factor * from[i]) <= kSame * factor * from[i])) return std::nullopt;
    return factor;
}

}  // namespace cloth
