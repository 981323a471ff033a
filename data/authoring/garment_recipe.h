#pragma once

#include <map>
#include <optional>
#include <string>

#include "data/authoring/body_landmarks.h"

namespace cloth {

/// How a garment is cut: which parts of the body it covers, and how far it stands off them. Lengths
/// along limbs are given by joints, so that one recipe serves bodies of any size.
/// The defaults make a T-shirt; data/assets/garments has variants.
struct GarmentRecipe {
    enum class From { shoulders, waist };  ///< hangs from the shoulders, or sits on the waist
    enum class To { hem, legs };           ///< one hem around both legs, or a tube for each leg

    int target_vertices = 4000;  ///< met within 3 %, 500 to 60,000

    From from = From::shoulders;
    To to = To::hem;

    // Where it ends.
    double sleeve_length = 0.55;  ///< along the arm: 1 elbow, 2 wrist; 0.3 to 1.95, or 0 for
                                  ///< armholes without sleeves
    double hem = 0.14;            ///< along the leg: 0 hip joint, 1 knee, 2 ankle; -0.5 to 1.95,
                                  ///< 0.35 to 1.95 for legs
    std::optional<double> hem_height;  ///< instead of `hem`: above the ground (m), 0.02 to 1.5
    double rise = 0.01;  ///< upper edge above the waist, if it sits there (m), -0.1 to 0.15

    // Neck and armholes.
    double neck_tilt = 29.0;         ///< how far the opening leans forward (degrees), 0 to 60
    double neck_half_width = 0.078;  ///< of the opening, left to right (m), 0.05 to 0.15
    double neck_half_depth = 0.070;  ///< of the opening, front to back (m), 0.05 to 0.15
    double strap_width = 0.05;       ///< from neck to armhole on the shoulder, without sleeves (m),
                                     ///< 0.02 to 0.1
    double armhole_drop = 0.03;  ///< lowest point of the armhole below the armpit, without sleeves
                                 ///< (m), 0 to 0.1

    // Width.
    double ease = 0.014;  ///< from the hull of the trunk to the cloth (m), 0.006 to 0.05
    double sleeve_ease =
        0.012;                  ///< from the widest part of the arm to the cloth (m), 0.006 to 0.05
    double leg_ease = 0.014;    ///< from the hull of a leg to the cloth (m), 0.006 to 0.05
    double drape_radius = 0.6;  ///< hollows curved more than this are bridged (m), 0.3 to 10
    std::optional<double> flare;  ///< cloth below the waist, or a leg below the hip, never narrows
                                  ///< but hangs, and widens by this per metre, 0 to 1; without it,
                                  ///< it follows the body
    double clearance =
        0.0045;  ///< the cloth is nowhere nearer to the body than this (m), 0.001 to 0.01

    // Waistband of what sits on the waist.
    double band_width = 0.04;  ///< (m), 0.02 to 0.1
    double band_ratio = 0.7;   ///< its length at rest by that worn, 0.5 to 1

    /// Landmarks by name, each coordinate -5 to 5 (m), instead of those of the body.
    std::map<std::string, Vec3> landmarks;

    /// @throws ArgumentError naming the field that is out of range
    void check() const;

    /// The body's landmarks, where the recipe has none of its own.
    BodyLandmarks landmarks_on(const BodyLandmarks& body) const;
};

/// The fields of a recipe are those of the struct; "from" is "shoulders" or "waist", "to" is "hem"
/// or "legs", a landmark is a list of three numbers.
/// @throws LoadError if the file is missing, is not JSON, or has a field that is unknown, of the
///         wrong type or out of range
GarmentRecipe load_garment_recipe(const std::string& path);

}  // namespace cloth
