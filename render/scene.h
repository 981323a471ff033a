#pragma once

#include <memory>
#include <string>
#include <vector>

#include "data/core/types.h"
#include "render/image.h"

namespace cloth {

/// A surface to draw, with smooth normals. Faces that touch a vertex without a usable position
/// (not finite, or farther than 1 km from the origin) are left out: a solver that failed can still
/// be shown.
struct SceneMesh {
    Points vertices;                     ///< (N x 3, m)
    std::shared_ptr<const Faces> faces;  ///< (M x 3), counter-clockwise seen from the front
    Rgb colour = {200, 200, 200};        ///< of the front
    Rgb back_colour = {160, 160, 160};   ///< of the back, if it is drawn
    bool two_sided = false;              ///< false: faces seen from behind are not drawn
    double gloss = 0.15;                 ///< strength of the highlight, 0 (cloth) to 1 (varnish)
    double depth_offset = 0.0;  ///< drawn as if this much farther away (m), 0 to 1. A body under
                                ///< thin cloth with 0.002 does not shine through it where
                                ///< flat faces cut round ones; 0 shows all as it is.
};

/// A shirt-like colour pair: the back is darker and less saturated, so that the two sides differ.
Rgb back_of(Rgb front);

enum class LabelCorner { top_left, top_right, bottom_left, bottom_right };

/// A text on a translucent plate in a corner of the picture.
struct Label {
    std::string text;  ///< UTF-8; '\n' begins a new line; the first line is the heading
    LabelCorner corner = LabelCorner::top_left;
    int text_height = 22;  ///< size of the font (pixels), 8 to 200
    Rgb colour = {255, 255, 255};
    Rgb heading = {255, 214, 120};  ///< colour of the first line
};

/// The floor: a horizontal plane with a grid of lines, which fades into the background.
struct Ground {
    bool visible = true;
    double height = 0.0;         ///< along y (m), -1000 to 1000
    double grid = 0.5;           ///< distance of the lines (m), 0.01 to 100
    Vec3 centre = Vec3::Zero();  ///< where the floor is clearest (m); follow the figure with it
    double radius = 4.0;         ///< where it has faded (m), 0.1 to 1000
    Rgb colour = {126, 132, 140};
    Rgb line = {104, 110, 118};
};

/// Directional lights; directions, of any length, point to the light. Strengths are 0 to 10.
struct Lights {
    Vec3 key = Vec3(0.75, 0.9, 0.55);
    double key_strength = 0.72;
    Vec3 fill = Vec3(-0.9, 0.35, 0.6);
    double fill_strength = 0.22;
    double ambient_sky = 0.30;     ///< light from above
    double ambient_ground = 0.22;  ///< light from below
    bool shadows = true;           ///< of the key light
};

/// All that a picture shows.
struct Scene {
    std::vector<SceneMesh> meshes;
    std::vector<Label> labels;
    Ground ground;
    Lights lights;
    Rgb background = {168, 174, 182};
};

}  // namespace cloth
