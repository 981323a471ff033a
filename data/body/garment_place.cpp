#include "data/body/garment_place.h"

#include <algorithm>

namespace cloth {

namespace {

// Parts of the body's height.
constexpr double room_beside = 0.6;  // for capes and wide skirts
constexpr double room_above = 0.15;  // for hats and trains
constexpr double smallest_size = 0.05;
constexpr double waist = 0.13;        // its width
constexpr double least_beside = 0.9;  // part of a guessed garment's height that is beside the body

}  // namespace

bool is_in_place(const Points& garment, const Points& skin) {
    if (garment.rows() == 0 || skin.rows() == 0) return false;
    const Eigen::RowVector3d low = garment.colwise().minCoeff(),
                             high = garment.colwise().maxCoeff();
    Eigen::RowVector3d from = skin.colwise().minCoeff(), to = skin.colwise().maxCoeff();
    const double height = to.y() - from.y();
    const Eigen::RowVector3d room =
        height * Eigen::RowVector3d(room_beside, room_above, room_beside);
    if ((low.array() < (from - room).array()).any()) return false;
    if ((high.array() > (to + room).array()).any()) return false;
    return (high - low).maxCoeff() >= smallest_size * height;
}

Points with_y_up(const Points& z_up) {
    Points turned(z_up.rows(), 3);
    turned << z_up.col(0), z_up.col(2), -z_up.col(1);
    return turned;
}

std::vector<LengthUnit> plausible_sizes(const Points& file_vertices, const Points& skin) {
    const double size =
        (file_vertices.colwise().maxCoeff() - file_vertices.colwise().minCoeff()).maxCoeff();
    const double height = skin.col(1).maxCoeff() - skin.col(1).minCoeff();
    return plausible_units(size, 0.1 * height, 1.1 * height);
}

std::vector<PlaceGuess> guess_place(const Points& file_vertices, const Points& skin) {
    const double low = skin.col(1).minCoeff(), high = skin.col(1).maxCoeff();
    std::vector<PlaceGuess> found;
    for (const bool z_up : {false, true}) {
        const Points upright = z_up ? with_y_up(file_vertices) : file_vertices;
        for (const LengthUnit& unit : length_units()) {
            const Points x = unit.metres * upright;
            const double from = x.col(1).minCoeff(), to = x.col(1).maxCoeff();
            const double beside = std::min(to, high) - std::max(from, low);
            const double width = std::max(x.col(0).maxCoeff() - x.col(0).minCoeff(),
                                          x.col(2).maxCoeff() - x.col(2).minCoeff());
            if (is_in_place(x, skin) && beside >= least_beside * (to - from) &&
                width >= waist * (high - low))
                found.push_back({unit, z_up});
        }
        if (!found.empty()) break;
    }
    return found;
}

}  // namespace cloth
