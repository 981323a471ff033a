#include "data/authoring/garment_import.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <set>
#include <utility>

#include "data/authoring/mesh_quality.h"
#include "data/authoring/seams.h"
#include "data/authoring/surface_edit.h"
#include "data/authoring/waistband.h"
#include "data/body/clearance.h"
#include "data/body/garment_sides.h"
#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "data/core/mesh_pieces.h"
#include "data/core/mesh_repair.h"
#include "data/core/weld.h"

namespace cloth {

namespace {

constexpr double fine_edge = 0.03;    // longer ones cannot follow a limb (m)
constexpr double wanted_edge = 0.02;  // (m)
constexpr double least_band_ratio = 0.5;
constexpr double sharp_angle = 8.0;    // solvers dislike sharper ones (degrees)
constexpr double strong_strain = 0.3;  // of the fit
constexpr double too_far = 0.3;        // from the skin: nothing is worn there (m)
constexpr double torn = 1.0;           // beyond: it went through a limb
constexpr double overlap = 0.04;       // garments as near as this lie over each other (m)

template <typename... Values>
std::string text(const char* format, Values... values) {
    char line[400];
    std::snprintf(line, sizeof line, format, values...);
    return line;
}

double area_of(const TriMesh& mesh) {
    return face_area_vectors(mesh.vertices, mesh.faces).rowwise().norm().sum();
}

void check_vertices(const std::string& name, const TriMesh& mesh) {
    if (mesh.faces.rows() == 0)
        throw ArgumentError(name, "it has no faces", "give a mesh of triangles or polygons");
    for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i)
        if (!mesh.vertices.row(i).allFinite())
            throw ArgumentError(name, "vertex " + std::to_string(i) + " is not finite",
                                "export the mesh again without NaN or infinite coordinates");
}

/// The work on one mesh, and what is said of it.
class Importer {
 public:
    Importer(const TriMesh& skin, const GarmentImportSettings& settings)
        : m_settings(settings), m_skin(skin), m_clearance(settings.clearance) {}

    GarmentImport run(const TriMesh& mesh) {
        m_import.read = mesh;
        const double open = border_share(m_skin.surface().faces);
        if (open > 0.0)
            warn(
                text("the character is not closed (%.2g %% of its edges are borders): beside its "
                     "holes inside and outside cannot be told apart",
                     1e2 * open));
        TriMesh garment = weld(mesh);
        garment = repair(garment);
        garment = leave_out_inner_side(std::move(garment));
        for (const TriMesh& piece : pieces(garment)) m_import.garments.push_back(fit(piece));
        m_import.clearance = m_clearance;
        return std::move(m_import);
    }

 private:
    void changed(const std::string& what) { m_import.changes.push_back(what); }
    void warn(const std::string& what) { m_import.warnings.push_back(what); }

    TriMesh weld(const TriMesh& mesh) {
        WeldedMesh welded = weld_mesh(mesh, m_settings.weld);
        if (welded.merged > 0)
            changed(text("%d vertices within %.3g mm of others were joined to them", welded.merged,
                         1e3 * m_settings.weld));
        if (welded.dropped_faces > 0)
            changed(
                text("%d faces lost their area by that, and were left out", welded.dropped_faces));
        return std::move(welded.mesh);
    }

    TriMesh repair(const TriMesh& mesh) {
        RepairedMesh repaired = repair_mesh(mesh, m_settings.garment_name);
        if (repaired.faces_without_area > 0)
            changed(text("%d faces without area were left out", repaired.faces_without_area));
        if (repaired.duplicate_faces > 0)
            changed(text("%d faces that were there twice were left out", repaired.duplicate_faces));
        if (repaired.turned_faces > 0)
            changed(text("%d faces were turned, so that neighbours agree on what is outside",
                         repaired.turned_faces));
        if (repaired.one_sided_pieces > 0)
            throw ArgumentError(m_settings.garment_name,
                                "a part of it has one side only, as a Moebius strip has",
                                "cut it there in a mesh editor");
        if (repaired.cut_edges > 0)
            warn(
                text("%d edges had more than two faces. What joins the surface there (a pocket, a "
                     "collar, an inner side) was cut off, and hangs loose. Remedy: model one layer",
                     repaired.cut_edges));
        if (repaired.split_vertices > 0)
            changed(text("%d vertices were doubled, where parts met in a point alone or were cut",
                         repaired.split_vertices));
        const int turned = turn_outwards(repaired.mesh, m_skin);
        if (turned > 0)
            changed(text("it was inside out: %d of %d pieces were turned", turned,
                         piece_count(face_pieces(repaired.mesh.faces))));
        const OpenSeams seams = find_open_seams(repaired.mesh);
        if (seams.vertices > 0)
            warn(
                text("borders lie along each other without being joined, and will come apart. "
                     "Remedy: --weld %g joins %d vertices",
                     seams.tolerance, seams.vertices));
        return std::move(repaired.mesh);
    }

    TriMesh leave_out_inner_side(TriMesh garment) {
        if (const auto side = find_inner_side(garment, m_skin)) {
            std::vector<char> keep;
            for (const char inner : side->is_inner) keep.push_back(!inner);
            changed(
                text("it is a shell, %.1f mm thick: its inner side, %.0f %% of the area, was "
                     "left out",
                     1e3 * side->thickness, 1e2 * side->share));
            garment = repair_mesh(keep_faces(garment, keep), m_settings.garment_name).mesh;
        }
        const std::vector<int> numbers = face_pieces(garment.faces);
        const std::vector<Lining> linings = find_linings(garment, numbers, m_skin);
        if (linings.empty()) return garment;
        std::vector<char> keep(numbers.size(), 1);
        for (const Lining& lining : linings) {
            changed(text("a lining, %.1f mm below another piece, was left out", 1e3 * lining.gap));
            for (size_t f = 0; f < numbers.size(); ++f)
                if (numbers[f] == lining.piece) keep[f] = 0;
        }
        return keep_faces(garment, keep);
    }

    /// Each that is large enough, largest first.
    std::vector<TriMesh> pieces(const TriMesh& garment) {
        const std::vector<int> numbers = face_pieces(garment.faces);
        std::vector<TriMesh> found;
        for (int k = 0; k < piece_count(numbers); ++k)
            found.push_back(piece_of(garment, numbers, k));
        const double least = m_settings.smallest_piece * area_of(garment);
        const auto small = std::stable_partition(
            found.begin(), found.end(), [&](const TriMesh& p) { return area_of(p) >= least; });
        if (small == found.begin())
            throw ArgumentError(
                m_settings.garment_name,
                text("it falls into %d pieces, none of which has %.3g %% of its area",
                     static_cast<int>(found.size()), 1e2 * m_settings.smallest_piece),
                "give a larger --weld, or a smaller --smallest-piece");
        if (small != found.end()) {
            changed(text("%d small pieces, such as buttons, were left out",
                         static_cast<int>(found.end() - small)));
            found.erase(small, found.end());
        }
        if (m_settings.together && found.size() > 1) return {joined(found)};
        std::stable_sort(found.begin(), found.end(), [](const TriMesh& a, const TriMesh& b) {
            return area_of(a) > area_of(b);
        });
        return found;
    }

    static TriMesh joined(const std::vector<TriMesh>& pieces) {
        TriMesh all;
        for (const TriMesh& piece : pieces) {
            const Eigen::Index vertices = all.vertices.rows(), faces = all.faces.rows();
            all.vertices.conservativeResize(vertices + piece.vertices.rows(), 3);
            all.faces.conservativeResize(faces + piece.faces.rows(), 3);
            all.vertices.bottomRows(piece.vertices.rows()) = piece.vertices;
            all.faces.bottomRows(piece.faces.rows()) =
                piece.faces.array() + static_cast<int>(vertices);
        }
        return all;
    }

    ImportedGarment fit(const TriMesh& piece) {
        ImportedGarment result;
        result.vertices_before = static_cast<int>(piece.vertices.rows());
        result.angle_before = smallest_angle(piece);
        measure_inside(piece, result.inside_before, result.deepest_before);
        check_distance(piece);
        if (result.inside_before > m_settings.most_inside)
            throw ArgumentError(
                m_settings.garment_name,
                text("%.0f %% of a piece of %d vertices is inside the skin, up to %.1f mm deep",
                     1e2 * result.inside_before, result.vertices_before,
                     1e3 * result.deepest_before),
                "export garment and character from one scene in one pose; check unit, origin and "
                "axes; --most-inside 1 takes it all the same");
        result.worn = piece;
        lead_out(result.worn);
        note_strain(piece, result);
        if (m_settings.vertices > 0) {
            const TriMesh remeshed = remesh(result.worn, m_settings.vertices, {}, Folds::keep);
            result.worn = remeshed;
            lead_out(result.worn);
            note_strain(remeshed, result);
        }
        hold(result);
        note_result(result);
        return result;
    }

    /// What holds each connected piece: one that hangs from the shoulders holds no other.
    void hold(ImportedGarment& result) {
        using Kind = GarmentSupport::Kind;
        const std::vector<int> numbers = face_pieces(result.worn.faces);
        result.rest = result.worn.vertices;
        for (int k = 0; k < piece_count(numbers); ++k) {
            const std::vector<int> vertices = vertices_of(result.worn.faces, numbers, k);
            const TriMesh piece = piece_of(result.worn, numbers, k);
            GarmentSupport support = find_support(piece, m_skin);
            if (m_settings.band_ratio == 1.0 && support.kind == Kind::waistband) {
                support.kind = Kind::pins;
                support.upper_edge.clear();
            }
            if (support.kind == Kind::waistband)
                result.rest(vertices, Eigen::all) =
                    without_stretch(piece.vertices, support.upper_edge, m_settings.band_width,
                                    m_settings.band_ratio);
            for (int& i : support.upper_edge) i = vertices[static_cast<size_t>(i)];
            support.pinned_share = share_between(result.worn.vertices, support);
            result.piece_support.push_back(std::move(support));
        }
        result.support = support_of_all(result.piece_support);
    }

    /// In the order of the mesh, as piece_of() has them.
    static std::vector<int> vertices_of(const Faces& faces, const std::vector<int>& numbers,
                                        int piece) {
        std::set<int> found;
        for (size_t f = 0; f < numbers.size(); ++f)
            if (numbers[f] == piece)
                for (int c = 0; c < 3; ++c) found.insert(faces(static_cast<Eigen::Index>(f), c));
        return {found.begin(), found.end()};
    }

    void check_distance(const TriMesh& piece) const {
        const double away = smallest_clearance(piece, m_skin);
        if (away > too_far)
            throw ArgumentError(m_settings.garment_name,
                                text("a piece of %d vertices is %.2f m from the skin",
                                     static_cast<int>(piece.vertices.rows()), away),
                                "check unit, origin and axes, or give --move; or leave such pieces "
                                "out with --mesh or --smallest-piece");
    }

    void measure_inside(const TriMesh& mesh, double& share, double& deepest) const {
        int count = 0;
        for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i) {
            const double distance = m_skin.nearest(mesh.vertices.row(i)).distance;
            count += distance < 0.0;
            deepest = std::max(deepest, -distance);
        }
        share = count / static_cast<double>(mesh.vertices.rows());
    }

    /// As far as the clearance asks for, or less where the skin leaves no room for it.
    void lead_out(TriMesh& mesh) {
        const TriMesh before = mesh;
        for (const double clearance : {m_clearance, 3e-3, 2e-3, 1e-3}) {
            if (clearance > m_clearance) continue;
            mesh = before;
            if (push_out(mesh, m_skin, clearance) < clearance) continue;
            if (clearance < m_clearance)
                warn(
                    text("the skin leaves no room for a clearance of %.1f mm; %.0f mm was taken, "
                         "and bake needs --clearance %g",
                         1e3 * m_clearance, 1e3 * clearance, clearance));
            m_clearance = clearance;
            return;
        }
        Eigen::Index deepest = 0;
        double depth = m_clearance;
        int count = 0;
        for (Eigen::Index i = 0; i < mesh.vertices.rows(); ++i) {
            const double distance = m_skin.nearest(mesh.vertices.row(i)).distance;
            count += distance < m_clearance;
            if (distance < depth) deepest = i, depth = distance;
        }
        const Vec3 at = mesh.vertices.row(deepest);
        throw ArgumentError(
            m_settings.garment_name,
            text("it cannot be led out of the skin: %d vertices stay nearer than %.1f mm, the "
                 "deepest at %.1f mm, (%.3f, %.3f, %.3f)",
                 count, 1e3 * m_clearance, 1e3 * depth, at.x(), at.y(), at.z()),
            "the character overlaps itself there, or has no room for cloth: open its pose, leave "
            "out inner parts with --skin, or give a smaller --clearance");
    }

    void note_strain(const TriMesh& before, ImportedGarment& result) {
        std::vector<double> strains;
        for (const auto& [a, b] : undirected_edges(before.faces))
            strains.push_back((result.worn.vertices.row(a) - result.worn.vertices.row(b)).norm() /
                                  (before.vertices.row(a) - before.vertices.row(b)).norm() -
                              1.0);
        std::sort(strains.begin(), strains.end());
        result.strain_low = std::min(result.strain_low, strains[strains.size() / 100]);
        result.strain_high = std::max(result.strain_high, strains[strains.size() * 99 / 100]);
        if (result.strain_high > torn)
            throw ArgumentError(
                m_settings.garment_name,
                text("leading it out of the skin would stretch it by %.0f %%: it goes through the "
                     "body",
                     1e2 * result.strain_high),
                "export garment and character from one scene in one pose; check unit, origin and "
                "axes, or give --move");
    }

    void note_result(ImportedGarment& result) {
        double deepest = 0.0;
        measure_inside(result.worn, result.inside, deepest);
        result.clearance = smallest_clearance(result.worn, m_skin);
        const TriMesh rest{result.rest, result.worn.faces};
        for (const TriMesh& mesh : {rest, result.worn})
            if (!(face_area_vectors(mesh.vertices, mesh.faces).rowwise().norm().minCoeff() > 1e-14))
                throw ArgumentError(m_settings.garment_name,
                                    "fitting it squeezed a face to nothing",
                                    "remesh it with --vertices, or with another number of them");
        result.angle = smallest_angle(rest);
        const auto edges = undirected_edges(result.worn.faces);
        for (const auto& [a, b] : edges) {
            const double length =
                (result.worn.vertices.row(a) - result.worn.vertices.row(b)).norm();
            const double at_rest = (result.rest.row(a) - result.rest.row(b)).norm();
            result.edge_length += length / static_cast<double>(edges.size());
            result.rest_strain = std::min(result.rest_strain, at_rest / length - 1.0);
        }
        warn_of(result);
    }

    void warn_of(const ImportedGarment& result) {
        const char* sort = result.support.sort.c_str();
        if (result.edge_length > fine_edge || result.angle < sharp_angle)
            warn(
                text("%s: edges of %.0f mm, smallest angle %.1f degrees; cloth wants 10 to 30 mm "
                     "and %.0f degrees. Remedy: --vertices %d",
                     sort, 1e3 * result.edge_length, result.angle, sharp_angle,
                     wanted_vertices(result.worn)));
        if (result.strain_high > strong_strain || result.strain_low < -strong_strain)
            warn(
                text("%s: leading it out of the skin changed lengths by %+.0f to %+.0f %%: it was "
                     "modelled for another figure or pose",
                     sort, 1e2 * result.strain_low, 1e2 * result.strain_high));
        for (const GarmentSupport& support : result.piece_support) warn_of_support(support);
    }

    /// A number that makes the edges as long as cloth wants them, and is not the one that was
    /// tried.
    int wanted_vertices(const TriMesh& worn) const {
        const double count = 2.0 / std::sqrt(3.0) * area_of(worn) / (wanted_edge * wanted_edge);
        int wanted = 100 * static_cast<int>(std::lround(std::clamp(count, 500.0, 6e4) / 100.0));
        if (std::abs(wanted - m_settings.vertices) <= wanted / 20) wanted += wanted / 500 * 100;
        return std::min(wanted, 60000);
    }

    void warn_of_support(const GarmentSupport& support) {
        const char* sort = support.sort.c_str();
        if (support.sort == "hat")
            warn(
                "a hat is stiff, and this is cloth: it will sag. Remedy: leave it to the "
                "character's own skinning");
        else if (support.sort == "shoes")
            warn(
                "shoes are stiff, and this is cloth: they will sag. Remedy: leave them to the "
                "character's own skinning");
        else if (support.kind == GarmentSupport::Kind::waistband)
            warn_of_waistband(support);
        else if (support.kind == GarmentSupport::Kind::pins && support.can_be_pinned())
            warn(text("%s: nothing holds it. Remedy: --pin %.3f %.3f of bake and hello_character",
                      sort, support.pin_low, support.pin_high));
        else if (support.kind == GarmentSupport::Kind::pins)
            warn(
                text("%s: nothing holds it, and --pin %.3f %.3f would fix %.0f %% of its vertices. "
                     "Remedy: paint goals on what is to be held, see data/README.md",
                     sort, support.pin_low, support.pin_high, 1e2 * support.pinned_share));
    }

    void warn_of_waistband(const GarmentSupport& support) {
        const double at_rest = m_settings.band_ratio * support.edge_length;
        if (support.waist_girth == 0.0 || at_rest <= support.waist_girth) return;
        const double ratio = std::floor(90.0 * support.waist_girth / support.edge_length) / 100.0;
        warn(text(
            "%s: it slides down. Its waistband is %.2f m long at rest, and the waist is %.2f "
            "m round there. Remedy: %s, or model its upper edge, %.2f m, nearer to the waist",
            support.sort.c_str(), at_rest, support.waist_girth,
            ratio >= least_band_ratio ? text("--band-ratio %g", ratio).c_str() : "--pin of bake",
            support.edge_length));
    }

    GarmentImportSettings m_settings;
    SurfaceDistance m_skin;
    double m_clearance;  // that the skin leaves room for (m)
    GarmentImport m_import;
};

}  // namespace

void GarmentImportSettings::check() const {
    check_range("GarmentImportSettings.weld", weld, 0.0, 0.01);
    check_range("GarmentImportSettings.clearance", clearance, 1e-3, 0.05);
    check_range("GarmentImportSettings.most_inside", most_inside, 0.0, 1.0);
    check_range("GarmentImportSettings.smallest_piece", smallest_piece, 0.0, 1.0);
    if (vertices != 0) check_range("GarmentImportSettings.vertices", vertices, 500, 60000);
    check_range("GarmentImportSettings.band_width", band_width, 0.02, 0.1);
    check_range("GarmentImportSettings.band_ratio", band_ratio, least_band_ratio, 1.0);
}

GarmentImport import_garment(const TriMesh& mesh, const TriMesh& skin,
                             const GarmentImportSettings& settings) {
    settings.check();
    check_vertices(settings.garment_name, mesh);
    validate_skin(settings.skin_name, skin);
    return Importer(skin, settings).run(mesh);
}

double height_over(const TriMesh& a, const TriMesh& b, const SurfaceDistance& skin) {
    const SurfaceDistance other(b);
    double sum = 0.0;
    int count = 0;
    for (Eigen::Index i = 0; i < a.vertices.rows(); ++i) {
        const auto near = other.nearest_within(overlap, a.vertices.row(i));
        if (!near) continue;
        sum += skin.nearest(a.vertices.row(i)).distance - skin.nearest(near->point).distance;
        ++count;
    }
    return count == 0 ? 0.0 : sum / count;
}

}  // namespace cloth
