#pragma once

#include "demos/doc_tables/registry.h"

namespace cloth {

/// Reports of `hard_cases`: scenes and motions that are held or not.
MarkdownTable hard_cases_table(const std::vector<DataFile>& files);
/// From how many starts cases are held that are held by chance.
MarkdownTable starts_table(const std::vector<DataFile>& files);
/// @param files  with limbs, and as one surface
MarkdownTable motions_table(const std::vector<DataFile>& files);
/// Networks alone, beside others. @param files  of each of garments_over_proxies
MarkdownTable alone_table(const std::vector<DataFile>& files);
/// How evenly time is spent, clip by clip.
MarkdownTable clip_times_table(const std::vector<DataFile>& files);

/// Reports of `bullet_scenes`: scenes of our own, and those of Bullet's demos.
MarkdownTable bullet_scenes_table(const std::vector<DataFile>& files);
MarkdownTable bullet_demos_table(const std::vector<DataFile>& files);

}  // namespace cloth
