#pragma once

#include <vector>

namespace cloth {

/// An upright rectangle of a picture (pixels, y down).
struct Box {
    double left, top, right, bottom;
};

/// Finds places for texts beside points, so that they hide neither points nor each other. Points
/// are announced first; each text that was placed is in the way of those that follow.
class LabelPlacement {
 public:
    explicit LabelPlacement(const Box& picture) : m_picture(picture) {}

    void block(const Box& box) { m_taken.push_back(box); }

    /// The place of a text of this size near the point: right above it if that is free, else
    /// around it, else where it hides least.
    Box place(double x, double y, double width, double height);

 private:
    double hidden_by(const Box& box) const;

    Box m_picture;
    std::vector<Box> m_taken;
};

}  // namespace cloth
