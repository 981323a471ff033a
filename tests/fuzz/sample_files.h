#pragma once

#include <string>

/// Small valid files, made here, with what real ones have.
namespace cloth::test {

std::string obj_file();  ///< groups, quads, texture coordinates, normals, indices from the end
std::string ascii_ply_file();
std::string binary_ply_file(bool big_endian);
std::string gltf_file();  ///< a skinned, animated strip; its numbers as base64
std::string glb_file();
/// The same with limits of goals on their vertices.
std::string painted_gltf_file();
std::string painted_glb_file();
std::string painted_ply_file(bool big_endian);
std::string coloured_obj_file();  ///< the same, its numbers as a binary chunk
std::string collada_file();       ///< centimetres, Z up, nested nodes, an animation
/// The COLLADA file zipped (.zae), written to `path`.
void write_zipped_collada(const std::string& path);
std::string pc2_file();  ///< three frames of two vertices
std::string mdd_file();
std::string bvh_file();
std::string garment_recipe_file();
std::string rig_recipe_file();
std::string shape_target_file();
std::string mhclo_file();  ///< five rows of both kinds, scales, skin to delete

}  // namespace cloth::test
