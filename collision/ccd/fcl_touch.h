#pragma once

namespace cloth {

/// What FCL says of a point and a triangle that move evenly: whether they meet, and when. It gets
/// plain arrays, for the reason in collision/geometry/fcl_model.h. FCL's thresholds are absolute:
/// the triangle shall be of the order of 1.
/// @param start, end  the corners of the triangle, then the point
/// @param time        of the step; unchanged if they do not meet
bool fcl_touch(const double (&start)[4][3], const double (&end)[4][3], double& time);

}  // namespace cloth
