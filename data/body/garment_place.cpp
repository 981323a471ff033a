#include "data/body/garment_place.h"

namespace cloth {

namespace {

// Parts of the body's height.
constexpr double room_beside = 0.6;  // for capes and wide skirts
constexpr double room_above = 0.15;  // for hats and trains
constexpr double smallest_size = 0.05;

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

std::vector<PlaceGuess> guess_place(const Points& file_vertices, const Points& skin) {
    std::vector<PlaceGuess> found;
    const Points turned = with_y_up(file_vertices);
    for (const bool z_up : {false, true})
        for (const LengthUnit& unit : length_units())
            if (is_in_place(unit.metres * (z_up ? turned : file_vertices), skin))
                found.push_back({unit, z_up});
    return found;
}

}  // namespace cloth
