#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace cloth {

// Which clips and garments a training is validated on. Names that are not there are refused, with
// the option that has them, before hours are spent on training.

/// The clips that states of garments are taken from: 07_02 and 16_35, a walk and a run, of the
/// shared data folder's motions/validation; where it has not both its first two; without the folder
/// 01_01.
/// @throws LoadError if the folder has no motion
std::vector<std::string> validation_clips();

/// The clips of rollouts, where none are given: all of the shared data folder's motions/validation;
/// without the folder 01_01.
/// @throws LoadError if the folder has no motion
std::vector<std::string> default_rollout_clips();

/// @throws LoadError for a clip that load_motion_by_name() does not take, naming the option
void check_clips(const std::vector<std::string>& clips);

/// The file's name without folder and ending; the whole path where another of the clips has that
/// name.
std::string clip_name(const std::string& clip, const std::vector<std::string>& clips);

/// Places of the chosen garments among those that are trained on; none chosen: tshirt, pants_1000
/// and dress_1000, or those of them that there are, or else the last one.
/// @throws ArgumentError for a garment that is not trained on, naming those that are
std::vector<std::size_t> validated_garments(const std::vector<std::string>& chosen,
                                            const std::vector<std::string>& trained);

}  // namespace cloth
