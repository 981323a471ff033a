#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "data/body/skinning.h"

namespace cloth {

/// Values over time, to be interpolated linearly (rotations: spherically). None of them is empty.
struct CharacterTrack {
    std::vector<double> position_times, rotation_times, scale_times;  ///< (s), ascending
    std::vector<Vec3> positions, scales;
    std::vector<Eigen::Quaterniond> rotations;
};

/// A node of the file's scene.
struct CharacterNode {
    int parent = -1;                                     ///< parents come first
    Eigen::Affine3d rest = Eigen::Affine3d::Identity();  ///< relative to the parent
    std::optional<int> track;                            ///< none: it does not move
};

/// What skin weights refer to: a node, and the map from the mesh's frame to the node's at binding.
struct CharacterJoint {
    std::string name;
    int node = 0;
    Eigen::Affine3d offset = Eigen::Affine3d::Identity();
};

/// Skin, skeleton and one animation of a file, in the file's units. Without an animation there are
/// no tracks, and without a skeleton there is a joint for each mesh.
struct CharacterRig {
    std::vector<CharacterNode> nodes;
    std::vector<CharacterTrack> tracks;
    std::vector<CharacterJoint> joints;  ///< a bone of two meshes is two joints
    SkinWeights weights;
    Points rest;  ///< |V| x 3: in the frames of the meshes
    Faces faces;
    double duration = 0.0;       ///< (s); 0: no joint has a track
    bool unread_morphs = false;  ///< the animation changes morph targets, which are not read
};

/// Reads a rig with assimp. Vertices at exactly the same position of a mesh become one; vertices
/// without weights follow the node that holds their mesh.
/// @param animation  its name in the file; empty: the first one, or none if there is none
/// @param mesh_name  the mesh or node that is skin; empty: all meshes
/// @throws LoadError if the file cannot be read or has no such mesh or animation, if its bones name
///         joints that do not exist, or if its numbers are not finite
CharacterRig load_character_rig(const std::string& path, const std::string& animation = "",
                                const std::string& mesh_name = "");

}  // namespace cloth
