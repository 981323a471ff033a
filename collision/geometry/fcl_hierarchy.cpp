#include "collision/geometry/fcl_hierarchy.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/AABB.h>

namespace cloth {

using Model = fcl::BVHModel<fcl::AABB<double>>;

static bool build_model(const Points& vertices, const Faces& faces, Model& model) {
    std::vector<fcl::Vector3d> points(static_cast<size_t>(vertices.rows()));
    for (size_t i = 0; i < points.size(); ++i) {
        const Vec3 x = vertices.row(static_cast<Eigen::Index>(i));
        points[i] = x.allFinite() ? x : Vec3::Zero();
    }
    std::vector<fcl::Triangle> triangles;
    triangles.reserve(static_cast<size_t>(faces.rows()));
    for (Eigen::Index f = 0; f < faces.rows(); ++f)
        triangles.emplace_back(faces(f, 0), faces(f, 1), faces(f, 2));

    model.beginModel(static_cast<int>(faces.rows()), static_cast<int>(vertices.rows()));
    model.addSubModel(points, triangles);
    return model.endModel() == fcl::BVH_OK;
}

std::vector<BinaryNode> build_fcl_hierarchy(const Points& vertices, const Faces& faces) {
    Model model;
    if (faces.rows() == 0 || !build_model(vertices, faces, model)) return {};
    std::vector<BinaryNode> nodes(static_cast<size_t>(model.getNumBVs()));
    for (int i = 0; i < model.getNumBVs(); ++i) {
        const auto& bv = model.getBV(i);
        BinaryNode& node = nodes[static_cast<size_t>(i)];
        node.face_count = bv.num_primitives;
        if (bv.isLeaf()) {
            node.face = bv.primitiveId();
        } else {
            node.left = bv.leftChild();
            node.right = bv.rightChild();
        }
    }
    return nodes;
}

}  // namespace cloth
