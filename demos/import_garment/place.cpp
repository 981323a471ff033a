#include "demos/import_garment/place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "data/authoring/garment_support.h"
#include "data/body/garment_place.h"
#include "data/core/errors.h"
#include "data/core/mesh_repair.h"
#include "data/core/surface_distance.h"
#include "data/core/weld.h"

namespace cloth {
namespace {

// Parts of the character's height.
constexpr double far_from_skin = 0.06;  // the middle vertex of what may lie beside the character
constexpr double trunk = 0.12;          // half its width

constexpr double clearly_nearer = 0.4;  // part of the distance as it is
constexpr double least_beside = 0.9;    // part of a garment's height that is beside the character

double height_of(const Points& skin) {
    return skin.col(1).maxCoeff() - skin.col(1).minCoeff();
}

std::string size_text(const Points& x) {
    const Eigen::RowVector3d low = x.colwise().minCoeff(), high = x.colwise().maxCoeff();
    char text[160];
    std::snprintf(text, sizeof text,
                  "x from %.3g to %.3g, y from %.3g to %.3g, z from %.3g to %.3g", low.x(),
                  high.x(), low.y(), high.y(), low.z(), high.z());
    return text;
}

/// What is left of a move when it is written with two decimals; zero has no sign.
Vec3 rounded(const Vec3& move) {
    return Vec3((100.0 * move).array().round() / 100.0 + 0.0);
}

std::string move_option(const Vec3& move) {
    char text[80];
    std::snprintf(text, sizeof text, "--move %.2f %.2f %.2f", move.x(), move.y(), move.z());
    return text;
}

Points moved(Points x, const Vec3& move) {
    x.rowwise() += move.transpose();
    return x;
}

/// How a garment lies on a skin.
struct Fit {
    double distance = 0.0;  ///< of the middle one of its vertices (m)
    double inside = 0.0;    ///< part of its vertices
    bool all_round = true;  ///< it has vertices on all sides of the skin
};

/// @param x  as many vertices as it takes; some hundred of them are looked at
Fit fit_of(const Points& x, const SurfaceDistance& skin) {
    constexpr Eigen::Index looked_at = 300;
    const Eigen::Index step = std::max<Eigen::Index>(1, x.rows() / looked_at);
    std::vector<double> distances;
    std::array<bool, 8> sides{};
    Fit fit;
    for (Eigen::Index i = 0; i < x.rows(); i += step) {
        const Vec3 p = x.row(i);
        const NearestPoint nearest = skin.nearest(p);
        distances.push_back(std::abs(nearest.distance));
        fit.inside += nearest.distance < 0.0;
        const Vec3 out = p - nearest.point;
        const double turn = (std::atan2(out.z(), out.x()) + M_PI) / (2.0 * M_PI);
        sides[std::min<size_t>(7, static_cast<size_t>(8.0 * turn))] = true;
    }
    fit.inside /= static_cast<double>(distances.size());
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    fit.distance = *middle;
    fit.all_round = std::count(sides.begin(), sides.end(), true) >= 7;
    return fit;
}

/// An axis that may point up in a file, and the file's vertices turned so that it does.
struct UpAxis {
    const char* name;
    Points upright;
};

std::vector<UpAxis> other_axes(const Points& x) {
    Points minus_z(x.rows(), 3), plus_x(x.rows(), 3), minus_x(x.rows(), 3);
    minus_z << x.col(0), -x.col(2), x.col(1);
    plus_x << -x.col(1), x.col(0), x.col(2);
    minus_x << x.col(1), -x.col(0), x.col(2);
    return {{"z", with_y_up(x)}, {"-z", minus_z}, {"x", plus_x}, {"-x", minus_x}};
}

/// What is beside the character may still be within its box.
void check_axis(const ImportOptions& options, const Points& in_file, const Points& garment,
                const TriMesh& skin) {
    const SurfaceDistance distance(skin);
    const double height = height_of(skin.vertices), as_it_is = fit_of(garment, distance).distance;
    if (as_it_is < far_from_skin * height) return;
    double nearest = clearly_nearer * as_it_is;
    std::string up;
    for (const UpAxis& axis : other_axes(in_file)) {
        const Points x = moved(options.scale * axis.upright, options.move);
        if (!is_in_place(x, skin.vertices)) continue;
        const Fit fit = fit_of(x, distance);
        if (!fit.all_round || fit.distance > nearest || fit.inside > options.import.most_inside)
            continue;
        nearest = fit.distance;
        up = axis.name;
    }
    if (up.empty()) return;
    char problem[200];
    std::snprintf(
        problem, sizeof problem,
        "it lies beside the character: half of its vertices are more than %.2f m from the "
        "skin, and %.2f m with %s up",
        as_it_is, nearest, up.c_str());
    throw ArgumentError(
        options.file, problem,
        (up == "z" ? std::string("--up z if the file has z up")
                   : "turn it upright in a mesh editor, where " + up + " points up now") +
            "; --up y takes it as it is");
}

/// Where what was made for a person who stands on the origin, or whose middle is there, as
/// MakeHuman has it, has to go.
Vec3 move_from_origin(const TriMesh& skin, bool middle) {
    const double low = skin.vertices.col(1).minCoeff(), high = skin.vertices.col(1).maxCoeff();
    const VectorX areas = face_area_vectors(skin.vertices, skin.faces).rowwise().norm();
    Vec3 centre = Vec3::Zero();
    for (Eigen::Index f = 0; f < areas.size(); ++f)
        for (int c = 0; c < 3; ++c)
            centre += areas[f] / (3.0 * areas.sum()) * skin.vertices.row(skin.faces(f, c));
    return {centre.x(), middle ? 0.5 * (low + high) : low, centre.z()};
}

/// The middle of the trunk between two heights, seen from above; of all the skin if there is none.
Vec3 trunk_between(const Points& skin, double low, double high) {
    const double height = height_of(skin);
    const double middle = 0.5 * (skin.col(0).minCoeff() + skin.col(0).maxCoeff());
    Vec3 from = Vec3::Constant(INFINITY), to = Vec3::Constant(-INFINITY);
    for (Eigen::Index i = 0; i < skin.rows(); ++i) {
        const Vec3 p = skin.row(i);
        if (p.y() < low || p.y() > high || std::abs(p.x() - middle) > trunk * height) continue;
        from = from.cwiseMin(p);
        to = to.cwiseMax(p);
    }
    if (from.x() > to.x()) return 0.5 * (skin.colwise().minCoeff() + skin.colwise().maxCoeff());
    return {middle, 0.0, 0.5 * (from.z() + to.z())};
}

/// The move that brings a garment around the skin, at its own height if the skin is there: of many
/// the one that leaves it nearest and least inside.
Vec3 move_onto(const Points& garment, const TriMesh& skin) {
    const SurfaceDistance distance(skin);
    const double height = height_of(skin.vertices), low = skin.vertices.col(1).minCoeff();
    const Eigen::RowVector3d from = garment.colwise().minCoeff(), to = garment.colwise().maxCoeff();
    const double beside = std::min(to.y(), low + height) - std::max(from.y(), low);
    std::vector<double> lifts{0.0};
    if (beside < least_beside * (to.y() - from.y())) {
        lifts.clear();
        const double room = std::max(0.0, height - (to.y() - from.y()));
        for (int k = 0; k <= 40; ++k) lifts.push_back(low + k / 40.0 * room - from.y());
    }
    Vec3 best = Vec3::Zero();
    double least = INFINITY;
    for (const double lift : lifts)
        for (int k = -3; k <= 3; ++k) {
            const Vec3 centre = trunk_between(skin.vertices, from.y() + lift, to.y() + lift) -
                                Vec3(0.5 * (from + to));
            const Vec3 move = rounded({centre.x(), lift, centre.z() + k * 0.012 * height});
            const Fit fit = fit_of(moved(garment, move), distance);
            const double cost = fit.inside + fit.distance / height + (fit.all_round ? 0.0 : 1.0);
            if (cost >= least) continue;
            least = cost;
            best = move;
        }
    return best;
}

/// A move that brings the garment about, and what it is for.
std::string move_text(const Points& garment, const TriMesh& skin) {
    // What was made for one who stands on the origin is hardly below it.
    const bool middle = garment.col(1).minCoeff() < -0.05 * height_of(skin.vertices);
    const Vec3 from_origin = rounded(move_from_origin(skin, middle));
    if (is_in_place(moved(garment, from_origin), skin.vertices))
        return move_option(from_origin) + " brings what was made for a person " +
               (middle ? "with the middle at" : "who stands on") + " the origin about here";
    const Vec3 onto = move_onto(garment, skin);
    if (!is_in_place(moved(garment, onto), skin.vertices)) return "";
    return move_option(onto) + " brings it onto the character about here";
}

/// Where no unit and no axis of the file would do.
std::string remedy_of_move(const ImportOptions& options, const Points& in_file, const TriMesh& mesh,
                           const TriMesh& skin) {
    std::string remedy =
        "give --unit or --scale, --up and --move, or export both files from one scene";
    const std::vector<LengthUnit> sizes = plausible_sizes(in_file, skin.vertices);
    for (const LengthUnit& unit : sizes)
        remedy += std::string("; in ") + unit.plural + " its size would fit";
    const bool fits = std::any_of(sizes.begin(), sizes.end(), [&](const LengthUnit& unit) {
        return unit.metres == options.scale;
    });
    // The move is told for the size that it has to have.
    const double change = fits || sizes.empty() ? 1.0 : sizes.front().metres / options.scale;
    const Points origin = moved(mesh.vertices, -options.move);
    const std::string move = move_text(moved(change * origin, options.move), skin);
    if (!move.empty())
        remedy +=
            (change == 1.0 ? "; " : std::string("; --unit ") + sizes.front().name + " ") + move;
    const TriMesh mended =
        repair_mesh(weld_mesh(mesh, options.import.weld).mesh, options.file).mesh;
    if (lies_on_its_side(mended))
        remedy +=
            ". Its openings look sideways: if it lies on its side, turn it upright in a mesh "
            "editor";
    return remedy;
}

/// The options that a guess asks for, and those that it was made without.
std::string remedy_of_guess(const PlaceGuess& guess, const ImportOptions& options) {
    const bool turn = guess.z_up && !options.z_up;
    std::string give, leave;
    if (!guess.z_up && options.z_up) leave = "--up";
    if (!options.move.isZero()) leave += leave.empty() ? "--move" : " and --move";
    if (guess.unit.metres != options.scale || turn || leave.empty())
        give = std::string("--unit ") + guess.unit.name + (guess.z_up ? " --up z" : "");
    if (!leave.empty()) leave = "leave " + leave + " out";
    return give + (give.empty() || leave.empty() ? "" : " and ") + leave + " if the file is in " +
           guess.unit.plural + (guess.z_up ? " with z up" : "");
}

/// What is said of a garment that is elsewhere.
[[noreturn]] void refuse_place(const ImportOptions& options, const Points& in_file,
                               const TriMesh& mesh, const TriMesh& skin) {
    std::string remedy;
    for (const PlaceGuess& guess : guess_place(in_file, skin.vertices))
        remedy += (remedy.empty() ? "" : ", or ") + remedy_of_guess(guess, options);
    if (remedy.empty()) remedy = remedy_of_move(options, in_file, mesh, skin);
    throw ArgumentError(options.file,
                        "it is not where the character is: " + size_text(mesh.vertices) +
                            " m; the character: " + size_text(skin.vertices) + " m",
                        remedy);
}

}  // namespace

void check_place(const ImportOptions& options, const Points& in_file, const TriMesh& garment,
                 const TriMesh& skin) {
    if (!is_in_place(garment.vertices, skin.vertices))
        refuse_place(options, in_file, garment, skin);
    if (!options.up_is_given) check_axis(options, in_file, garment.vertices, skin);
}

}  // namespace cloth
