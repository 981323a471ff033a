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
    constexpr int kRounds = 5;  // what clears one layer may come near to another
    for (int round = 0; round < kRounds; ++round) {
        const Points before = outer.vertices;
        for (const SurfaceDistance& surface : surfaces)
            if (!push_over(outer, surface, Outfit::gap, kReach))
                throw ArgumentError(outfit, "one garment cannot be put on over another",
                                    "name the outermost one first");
        if (outer.vertices == before) return;
    }
}

}  // namespace

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

}  // namespace cloth
