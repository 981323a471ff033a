#include "data/authoring/garment_shape.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "data/authoring/body_sections.h"
#include "data/authoring/scalar_grid.h"
#include "data/authoring/sleeve.h"
#include "data/core/surface_distance.h"

namespace cloth {

namespace {

constexpr double kCell = 0.006;  // of the grid that the surface is drawn from (m)
constexpr double kMirrorX[2] = {1.0, -1.0};

bool from_shoulders(const GarmentRecipe& recipe) {
    return recipe.from == GarmentRecipe::From::shoulders;
}

bool has_legs(const GarmentRecipe& recipe) {
    return recipe.to == GarmentRecipe::To::legs;
}

/// Largest |x| that belongs to the trunk at a height: the armpit's, and more below, where the arms
/// stand off.
double trunk_limit(const BodyLandmarks& marks, double y) {
    return marks.armpit.x() + 0.4 * std::max(0.0, marks.armpit.y() - y);
}

/// What the trunk's sections and the legs' have in common.
BodySections::Settings common_settings(const BodyLandmarks& marks, const GarmentRecipe& recipe,
                                       double low, double high) {
    BodySections::Settings settings;
    settings.low = low;
    settings.high = high;
    settings.drape_radius = recipe.drape_radius;
    settings.drape_below = marks.armpit.y();
    settings.flare = recipe.flare;
    settings.hang_from = marks.waist.y();
    settings.flare_from = marks.hip.y();
    settings.freeze_below = marks.ankle.y() + 0.04;
    return settings;
}

BodySections trunk_sections(const TriMesh& body, const BodyLandmarks& marks,
                            const GarmentRecipe& recipe, double low, double high) {
    BodySections::Settings settings = common_settings(marks, recipe, low, high);
    settings.axis = [z = marks.neck.z()](double) { return Vec3(0.0, 0.0, z); };
    settings.belongs = [&marks](double x, double y) -> std::optional<double> {
        const double limit = trunk_limit(marks, y);
        if (std::abs(x) > marks.armpit.x() + 0.1 + limit) return std::nullopt;
        if (y < marks.armpit.y() && std::abs(x) > limit) return std::nullopt;
        return std::clamp(x, -limit, limit);
    };
    if (has_legs(recipe)) settings.flare.reset();  // the legs have it
    // What sits on the waist does not hang straight up from the hips.
    if (!from_shoulders(recipe)) settings.drape_below = marks.hip.y();
    return {body, settings};
}

/// The left leg's, around a line from the hip joint over the knee to the ankle.
BodySections leg_sections(const TriMesh& body, const BodyLandmarks& marks,
                          const GarmentRecipe& recipe, double low) {
    BodySections::Settings settings = common_settings(marks, recipe, low, marks.hip.y());
    settings.hang_from = marks.crotch.y();
    settings.axis = [marks](double y) -> Vec3 {
        const bool thigh = y > marks.knee.y();
        const Vec3& a = thigh ? marks.hip : marks.knee;
        const Vec3& b = thigh ? marks.knee : marks.ankle;
        return a + std::max(0.0, (a.y() - y) / (a.y() - b.y())) * (b - a);
    };
    settings.belongs = [&marks](double x, double y) -> std::optional<double> {
        if (x < 0.0 || x > trunk_limit(marks, y)) return std::nullopt;
        return x;
    };
    return {body, settings};
}

/// Half as much ease at the neck as from the shoulders down.
double trunk_ease(const BodyLandmarks& marks, const GarmentRecipe& recipe, double y) {
    const double t =
        std::clamp((y - marks.shoulder.y()) / (marks.neck.y() - marks.shoulder.y()), 0.0, 1.0);
    return recipe.ease * (1.0 - 0.5 * t);
}

/// The trunk's ease at the hip joint, the leg's own from the crotch down.
double leg_ease(const BodyLandmarks& marks, const GarmentRecipe& recipe, double y) {
    const double t = std::clamp((marks.hip.y() - y) / (marks.hip.y() - marks.crotch.y()), 0.0, 1.0);
    return recipe.ease + t * (recipe.leg_ease - recipe.ease);
}

/// Union with a fillet of size `k` (m) in the corners (Quilez' polynomial smooth minimum).
double smooth_union(double a, double b, double k) {
    const double h = std::max(0.0, k - std::abs(a - b)) / k;
    return std::min(a, b) - 0.25 * h * h * k;
}

/// The solid inside of the garment.
class GarmentSolid {
 public:
    GarmentSolid(const TriMesh& body, const BodyLandmarks& marks, const GarmentRecipe& recipe,
                 double low, double high)
        : m_marks(marks),
          m_recipe(recipe),
          m_trunk(trunk_sections(body, marks, recipe, low, high)),
          m_skin(body),
          m_skin_gap(recipe.clearance + 0.003) {
        if (has_legs(recipe))
            m_leg = std::make_unique<BodySections>(leg_sections(body, marks, recipe, low));
        if (from_shoulders(recipe) && recipe.sleeve_length > 0.0)
            m_sleeve = std::make_unique<Sleeve>(body, marks, recipe);
    }

    /// Negative inside.
    double operator()(const Vec3& p) const {
        double value = m_trunk(p) - trunk_ease(m_marks, m_recipe, p.y());
        if (m_leg) {
            value = std::max(value, m_marks.crotch.y() - kBelowCrotch - p.y());
            for (double side : kMirrorX)
                value = smooth_union(value, leg(mirrored(p, side)), kLegFillet);
        }
        if (m_sleeve)
            for (double side : kMirrorX)
                value = smooth_union(value, (*m_sleeve)(mirrored(p, side)), kSleeveFillet);
        if (value > 0.0 && value < 0.05) {
            if (const auto near = m_skin.nearest_within(0.04, p))
                value = smooth_union(value, near->distance - m_skin_gap, 0.01);
        }
        return value;
    }

    /// How far trunk and legs reach to the side (m).
    double reach() const {
        const double trunk = m_trunk.widest() + m_recipe.ease;
        if (!m_leg) return trunk;
        const double axis = std::max({m_marks.hip.x(), m_marks.knee.x(), m_marks.ankle.x()});
        return std::max(trunk, axis + m_leg->widest() + m_recipe.leg_ease);
    }

 private:
    static constexpr double kSleeveFillet = 0.035, kLegFillet = 0.02;  // (m)
    static constexpr double kBelowCrotch = 0.02;  // where the seat of trousers ends (m)

    double leg(const Vec3& p) const {
        return std::max((*m_leg)(p)-leg_ease(m_marks, m_recipe, p.y()), p.y() - m_marks.hip.y());
    }

    const BodyLandmarks& m_marks;
    const GarmentRecipe& m_recipe;
    BodySections m_trunk;
    std::unique_ptr<BodySections> m_leg;
    std::unique_ptr<Sleeve> m_sleeve;
    SurfaceDistance m_skin;
    double m_skin_gap;
};

}  // namespace

double hem_height(const BodyLandmarks& marks, const GarmentRecipe& recipe) {
    if (recipe.hem_height) return *recipe.hem_height;
    if (recipe.hem <= 1.0) return marks.hip.y() + recipe.hem * (marks.knee.y() - marks.hip.y());
    return marks.knee.y() + (recipe.hem - 1.0) * (marks.ankle.y() - marks.knee.y());
}

double waist_height(const BodyLandmarks& marks, const GarmentRecipe& recipe) {
    return marks.waist.y() + recipe.rise;
}

TriMesh garment_surface(const TriMesh& body, const BodyLandmarks& marks,
                        const GarmentRecipe& recipe) {
    const double low = hem_height(marks, recipe) - 0.06;
    const double high =
        from_shoulders(recipe) ? marks.neck.y() + 0.075 : waist_height(marks, recipe) + 0.04;
    const GarmentSolid solid(body, marks, recipe, low, high);
    const double trunk_reach = solid.reach() + 0.02;
    double reach = trunk_reach, front = 0.26;
    if (from_shoulders(recipe)) {
        const bool forearm = recipe.sleeve_length > 1.0;
        reach = std::max(reach, (forearm ? marks.wrist.x() : marks.elbow.x()) + 0.08);
        if (forearm) front = std::max(front, marks.wrist.z() + 0.1);
    }
    const double middle = marks.neck.z();
    ScalarGrid grid(Vec3(-reach, low, std::min(-0.22, middle - trunk_reach)),
                    Vec3(reach, high, std::max(front, middle + trunk_reach)), kCell,
                    [&](const Vec3& p) { return solid(p); });
    grid.blur(3);
    return grid.zero_surface();
}

}  // namespace cloth
