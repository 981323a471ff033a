#pragma once

#include <vector>

#include "collision/proximity/surface_samples.h"
#include "collision/response/plane_push.h"

namespace cloth {

/// Which side cloth takes that hangs through a slab of the obstacles: through a limb that is
/// thinner than a face, or between two parts of a body that overlap, where the skins face each
/// other,
///
///        a ----.            a, b: vertices outside of the upper and of the lower skin
///     ==========\\=======
///        (slab)  \\          the midpoint of a-b is inside and whichever way it is pushed, a or b
///     ============\\=====    goes inside
///                  `-- b
///
/// All samples of one patch go to the side on which most of its vertices are. Vertices of the other
/// side are drawn through the slab, and count for their new side until the frame is resolved.
class PinchSides {
 public:
    explicit PinchSides(Eigen::Index vertex_count);

    /// Forgets the decisions of the last frame.
    void begin_frame();

    /// Whether some vertex of a deep sample stands on a skin that faces away from the sample's.
    static bool is_pinched(const SurfaceSamples& samples, int sample, const Points& x,
                           const SurfaceContacts& contacts);

    /// Adds the plane of a pinched sample whose skins part at a ridge, such as a finger under it:
    /// it goes along the ridge, between the skins. Returns false where they face away from each
    /// other.
    static bool add_ridge_plane(const SurfaceSamples& samples, int sample, const Points& x,
                                const SurfaceContacts& contacts, double allowed_depth,
                                PlanePush& push);

    /// Decides for the deep samples that are pinched and adds the planes that draw them to their
    /// side. Vertices that change sides are marked in `drawn` (|V|).
    /// @param distance       of drawn vertices from the skin (m)
    /// @param allowed_depth  of samples (m)
    void add_planes(const SurfaceSamples& samples, const std::vector<int>& pinched, const Points& x,
                    const SurfaceContacts& contacts, double distance, double allowed_depth,
                    PlanePush& push, std::vector<char>& drawn);

 private:
    int root(int vertex);
    void connect(const SurfaceSamples& samples, const std::vector<int>& pinched);
    void count_sides(const SurfaceSamples& samples, const std::vector<int>& pinched,
                     const Points& x, const SurfaceContacts& contacts);

    std::vector<int> m_parent;    ///< |V|: patches as trees
    std::vector<char> m_drawn;    ///< |V|: was drawn to its side in this frame
    std::vector<char> m_counted;  ///< |V|
    Points m_reference;  ///< |V| x 3: of roots: a normal of the patch, zero before it has one
    VectorX m_balance;   ///< |V|: of roots: vertices on the reference's side - on the other
};

}  // namespace cloth
