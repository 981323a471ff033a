#pragma once

#include <string>
#include <vector>

namespace cloth {

// What is kept of a run may be used again as long as the files that it was computed from are the
// same: their names alone do not tell.

/// Tells files apart: a hash of their bytes (FNV-1a, 64 bits), in hexadecimal digits; empty for an
/// empty path.
/// @throws LoadError if the file cannot be read
std::string fingerprint(const std::string& file);

/// Names, sizes and fingerprints of files, in a line; empty: there are none. It changes when one of
/// them does.
/// @throws LoadError if one cannot be read
std::string files_key(const std::vector<std::string>& files);

/// The same in few characters, which may stand in a file's name: "_" and sixteen digits, or
/// nothing.
std::string short_key(const std::vector<std::string>& files);

/// The files of one's own that a garment, as load_outfit() takes it, is read from: with worn shapes
/// and the buffers of glTF. Committed garments have none: a program's commit tells them apart.
std::vector<std::string> garment_files(const std::string& garment);

/// The file of a motion, as load_motion_by_name() takes it; none: it is a known clip.
std::vector<std::string> motion_files(const std::string& motion);

/// All files that a scene of the garment and the motion is read from.
std::vector<std::string> scene_files(const std::string& garment, const std::string& motion);

/// The files that a solver, as make_solver() takes it, may be made of: weights of networks that its
/// name holds, and a proxy of one's own.
/// @param weights  their folder; empty: the committed ones
std::vector<std::string> solver_files(const std::string& solver, const std::string& weights);

}  // namespace cloth
