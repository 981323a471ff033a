#include "demos/viewer/vertex_colours.h"

#include "collision/proximity/proximity.h"

namespace cloth {

Vec3 ColourScale::colour(double value) const {
    if (!(value > stops.front().value)) return stops.front().colour;
    for (size_t k = 1; k < stops.size(); ++k) {
        if (value >= stops[k].value) continue;
        const double share = (value - stops[k - 1].value) / (stops[k].value - stops[k - 1].value);
        return (1.0 - share) * stops[k - 1].colour + share * stops[k].colour;
    }
    return stops.back().colour;
}

const ColourScale& stretch_scale() {
    static const ColourScale scale{{{0.8, {0.16, 0.32, 0.78}, "0.8"},
                                    {0.9, {0.45, 0.66, 0.88}, ""},
                                    {1.0, {0.86, 0.86, 0.84}, "1"},
                                    {1.15, {0.96, 0.72, 0.30}, ""},
                                    {1.3, {0.80, 0.13, 0.10}, "1.3"}}};
    return scale;
}

const ColourScale& contact_scale() {
    static const ColourScale scale{{{-2e-3, {0.85, 0.05, 0.75}, "inside"},
                                    {0.0, {0.85, 0.05, 0.75}, ""},
                                    {2e-3, {0.86, 0.22, 0.12}, ""},
                                    {6e-3, {0.95, 0.60, 0.22}, "6 mm"},
                                    {2e-2, {0.55, 0.68, 0.72}, ""},
                                    {8e-2, {0.30, 0.40, 0.55}, "80 mm"}}};
    return scale;
}

VectorX vertex_stretch(const Garment& garment, const Points& x) {
    const Points& rest = garment.rest().vertices;
    VectorX sum = VectorX::Zero(garment.vertex_count()), count = sum;
    for (const auto& [a, b] : garment.edges()) {
        const double length = (rest.row(b) - rest.row(a)).norm();
        if (length == 0.0) continue;
        for (const int i : {a, b}) {
            sum[i] += (x.row(b) - x.row(a)).norm() / length;
            count[i] += 1.0;
        }
    }
    for (Eigen::Index i = 0; i < sum.size(); ++i) sum[i] = count[i] > 0 ? sum[i] / count[i] : 1.0;
    return sum;
}

Points vertex_colours(ColourMode mode, const Garment& garment, const Points& x,
                      const Boundary& boundary, Proximity& proximity) {
    if (mode == ColourMode::garments) return {};
    VectorX values;
    if (mode == ColourMode::stretch)
        values = vertex_stretch(garment, x);
    else
        proximity.signed_distance(x, boundary, StepEnd::end, values);
    const ColourScale& scale = mode == ColourMode::stretch ? stretch_scale() : contact_scale();
    Points colours(x.rows(), 3);
    for (Eigen::Index i = 0; i < x.rows(); ++i)
        colours.row(i) = scale.colour(values[i]).transpose();
    return colours;
}

}  // namespace cloth
