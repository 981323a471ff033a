#include "data/body/outfit.h"

#include <filesystem>
#include <sstream>

#include "data/body/clearance.h"
#include "data/core/errors.h"
#include "data/core/garment_pieces.h"
#include "data/core/surface_distance.h"
#include "data/files/garment_assets.h"

namespace cloth {

namespace {

// A loose garment lies this far below what is worn over it, at most.
constexpr double kReach = 0.06;  // m

/// Puts the outer garment on over all the inner ones.
void wear_over(TriMesh& outer, const std::vector<TriMesh>& inner, const std::string& outfit) {
    std::vector<SurfaceDistance> surfaces;
    for (const TriMesh& mesh : inner) surfaces.emplace_back(mesh);
    constexpr int kWearingRounds = 5;  // what clears one layer may come near to another
    for (int round = 0; round < kWearingRounds; ++round) {
        const Points before = outer.vertices;
        for (const SurfaceDistance& surface : surfaces)
            if (!push_over(outer, surface, Outfit::gap, kReach))
                throw ArgumentError(outfit, "one garment cannot be put on over another",
                                    "name the outermost one first");
        if (outer.vertices == before) return;
    }
}

}  // namespace

Faces Outfit::faces_of_part(int part) const {
    const Faces& all = garment.rest().faces;
    const auto k = static_cast<size_t>(part);
    std::vector<Eigen::Index> rows;
    for (Eigen::Index f = 0; f < all.rows(); ++f)
        if (all(f, 0) >= first_vertex[k] && all(f, 0) < first_vertex[k + 1]) rows.push_back(f);
    Faces faces(static_cast<Eigen::Index>(rows.size()), 3);
    for (size_t row = 0; row < rows.size(); ++row)
        faces.row(static_cast<Eigen::Index>(row)) = all.row(rows[row]);
    return faces;
}

std::vector<std::string> outfit_parts(const std::string& name) {
    if (std::filesystem::exists(name)) return {name};
    std::vector<std::string> parts;
    std::istringstream text(name);
    for (std::string part; std::getline(text, part, '+');) parts.push_back(part);
    if (parts.empty()) parts.push_back(name);
    return parts;
}

Outfit load_outfit(const std::string& name, const Fabric& fabric) {
    const std::vector<std::string> names = outfit_parts(name);
    if (names.size() == 1) {
        Garment garment = load_garment(name, fabric);
        const int count = static_cast<int>(garment.vertex_count());
        return {std::move(garment), load_garment_start(name), {0, count}};
    }
    std::vector<Garment> garments;
    for (const std::string& part : names) garments.push_back(load_garment(part, fabric));
    MergedGarments merged = merge_garments(name, garments);
    ClothState start = ClothState::at_rest(merged.garment);
    std::vector<TriMesh> inner;
    for (size_t k = names.size(); k-- > 0;) {
        TriMesh worn{load_garment_start(names[k]).x, garments[k].rest().faces};
        wear_over(worn, inner, name);
        start.x.middleRows(merged.first_vertex[k], worn.vertices.rows()) = worn.vertices;
        inner.push_back(std::move(worn));
    }
    return {std::move(merged.garment), std::move(start), std::move(merged.first_vertex)};
}

Points wear_outfit(const Outfit& outfit, const TriMesh& skin_from, const Points& skin_to,
                   const GarmentFitSettings& settings) {
    Points x = outfit.start.x;
    std::vector<TriMesh> inner;
    for (int part = outfit.part_count(); part-- > 0;) {
        const int first = outfit.first_vertex[static_cast<size_t>(part)];
        const int count = outfit.first_vertex[static_cast<size_t>(part) + 1] - first;
        TriMesh worn{x.middleRows(first, count), outfit.faces_of_part(part)};
        worn.faces.array() -= first;
        worn.vertices = fit_garment(worn, skin_from, skin_to, settings);
        if (outfit.has_layers()) wear_over(worn, inner, outfit.garment.name());
        x.middleRows(first, count) = worn.vertices;
        inner.push_back(std::move(worn));
    }
    return x;
}

Outfit fit_outfit(const Outfit& outfit, const Body& from, const Body& to) {
    const Garment& garment = outfit.garment;
    ClothState start = outfit.start;
    start.x = wear_outfit(outfit, from.rest_mesh(), to.rest());
    TriMesh rest = garment.rest();
    rest.vertices += start.x - outfit.start.x;
    return {Garment(garment.name(), std::move(rest), garment.fabric(), garment.pins(),
                    garment.rest_angles_from_mesh()),
            std::move(start), outfit.first_vertex};
}

}  // namespace cloth
