#include "data/body/body.h"

#include <algorithm>
#include <utility>

#include "data/body/skinning.h"
#include "data/core/errors.h"
#include "data/core/paths.h"
#include "data/files/mesh_io.h"

namespace cloth {

Body Body::load_default() {
    RigRecipe recipe = load_rig_recipe(asset_path("body_rig.json"));
    const std::string path = model_path(recipe.model);
    TriMesh mesh = load_mesh(path, recipe.mesh_name);
    if (mesh.vertices.rows() != recipe.vertex_count)
        throw LoadError(path, "mesh " + recipe.mesh_name,
                        "has " + std::to_string(mesh.vertices.rows()) + " vertices instead of " +
                            std::to_string(recipe.vertex_count),
                        "install Debian 12's assimp-testmodels, or write a recipe for this mesh");
    return Body(std::move(mesh), std::move(recipe));
}

Body::Body(TriMesh rest, RigRecipe recipe)
    : m_rest(std::move(rest.vertices)),
      m_faces(std::make_shared<const Faces>(std::move(rest.faces))),
      m_recipe(std::make_shared<const RigRecipe>(std::move(recipe))) {
    if (m_rest.rows() != m_recipe->vertex_count)
        throw ArgumentError("recipe", "is for a mesh with another number of vertices",
                            "use the recipe made for this mesh");
    validate_mesh("body", rest_mesh());
    place_joints();
    m_weights = std::make_shared<const SkinWeights>(
        heat_weights(rest_mesh(), m_bones, static_cast<int>(m_joints.size())));
    name_limbs();
}

Body Body::with_rest(const Points& rest) const {
    if (rest.rows() != m_rest.rows() || !rest.allFinite())
        throw ArgumentError("rest", "does not fit this body or is not finite",
                            "give " + std::to_string(m_rest.rows()) + " finite vertices");
    Body body = *this;
    body.m_rest = rest;
    body.place_joints();
    return body;
}

void Body::place_joints() {
    m_joints.clear();
    m_bones.clear();
    const auto position = [&](int point) { return m_recipe->points[point].position(m_rest); };
    for (const RigJoint& joint : m_recipe->joints)
        m_joints.push_back({joint.name, joint.parent, position(joint.point)});
    for (const RigBone& bone : m_recipe->bones)
        m_bones.push_back({bone.joint, position(bone.from), position(bone.to)});
}

/// A limb begins at each of these joints; other joints belong to their parent's.
void Body::name_limbs() {
    const std::vector<std::string> begins = {"Head",         "LeftArm",    "LeftForeArm",
                                             "LeftUpLeg",    "LeftLeg",    "RightArm",
                                             "RightForeArm", "RightUpLeg", "RightLeg"};
    std::vector<std::uint8_t> limb_of_joint(m_joints.size(), 0);
    for (size_t j = 0; j < m_joints.size(); ++j) {
        const auto found = std::find(begins.begin(), begins.end(), m_joints[j].name);
        if (found != begins.end())
            limb_of_joint[j] = static_cast<std::uint8_t>(1 + (found - begins.begin()));
        else if (m_joints[j].parent >= 0)
            limb_of_joint[j] = limb_of_joint[static_cast<size_t>(m_joints[j].parent)];
    }
    const std::vector<int> joints = dominant_joint();
    auto limbs = std::make_shared<std::vector<std::uint8_t>>();
    for (Eigen::Index f = 0; f < m_faces->rows(); ++f)
        limbs->push_back(
            limb_of_joint[static_cast<size_t>(joints[static_cast<size_t>((*m_faces)(f, 0))])]);
    m_limbs = limbs;
}

int Body::joint(const std::string& name) const {
    for (size_t j = 0; j < m_joints.size(); ++j)
        if (m_joints[j].name == name) return static_cast<int>(j);
    throw ArgumentError("joint " + name, "is not in this body", "use a name of its recipe");
}

Vec3 Body::point(const std::string& name) const {
    for (const RigPoint& point : m_recipe->points)
        if (point.name == name) return point.position(m_rest);
    throw ArgumentError("point " + name, "is not in this body", "use a name of its recipe");
}

double Body::leg_length() const {
    double sum = 0.0;
    for (const std::string side : {"Left", "Right"}) {
        const Vec3 hip = m_joints[joint(side + "UpLeg")].position;
        const Vec3 knee = m_joints[joint(side + "Leg")].position;
        const Vec3 ankle = m_joints[joint(side + "Foot")].position;
        sum += (knee - hip).norm() + (ankle - knee).norm();
    }
    return 0.5 * sum;
}

Points Body::skin(const JointTransforms& transforms) const {
    if (transforms.size() != m_joints.size())
        throw ArgumentError("transforms", "there is not one per joint",
                            "give " + std::to_string(m_joints.size()) + " transforms");
    std::vector<SkinMatrix> matrices;
    for (const Eigen::Isometry3d& transform : transforms)
        matrices.emplace_back(transform.matrix().topRows<3>());
    return skin_points(m_rest, *m_weights, matrices);
}

}  // namespace cloth
