#include "collision/geometry/fcl_model.h"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/AABB.h>

namespace cloth {

using Model = fcl::BVHModel<fcl::AABB<double>>;

static bool build_model(const double* vertices, int vertex_count, const int* faces, int face_count,
                        Model& model) {
    std::vector<fcl::Vector3d> points(static_cast<size_t>(vertex_count));
    for (fcl::Vector3d& point : points) {
        point = {vertices[0], vertices[1], vertices[2]};
        vertices += 3;
    }
    std::vector<fcl::Triangle> triangles;
    triangles.reserve(static_cast<size_t>(face_count));
    for (int f = 0; f < face_count; ++f, faces += 3)
        triangles.emplace_back(faces[0], faces[1], faces[2]);

    model.beginModel(face_count, vertex_count);
    model.addSubModel(points, triangles);
    return model.endModel() == fcl::BVH_OK;
}

std::vector<BinaryNode> fcl_model_nodes(const double* vertices, int vertex_count, const int* faces,
                                        int face_count) {
    Model model;
    if (!build_model(vertices, vertex_count, faces, face_count, model)) return {};
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
