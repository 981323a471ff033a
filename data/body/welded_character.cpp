#include "data/body/welded_character.h"

namespace cloth {

static SkinWeights rows_of(const SkinWeights& all, const std::vector<int>& rows) {
    SkinWeights some;
    some.begin.push_back(0);
    for (const int i : rows) {
        const auto row = static_cast<size_t>(i);
        for (int k = all.begin[row]; k < all.begin[row + 1]; ++k) {
            some.joints.push_back(all.joints[static_cast<size_t>(k)]);
            some.values.push_back(all.values[static_cast<size_t>(k)]);
        }
        some.begin.push_back(static_cast<int>(some.joints.size()));
    }
    return some;
}

WeldedCharacter::WeldedCharacter(const std::string& path, const CharacterSettings& settings,
                                 double tolerance)
    : MovingSurface(settings.friction),
      m_character(path, settings),
      m_rest(weld_mesh({m_character.rest_vertices(), *m_character.faces()}, tolerance)),
      m_weights(rows_of(m_character.rig().weights, m_rest.kept)),
      m_faces(std::make_shared<const Faces>(m_rest.mesh.faces)) {
}

double WeldedCharacter::height() const {
    return rest().vertices.col(1).maxCoeff() - rest().vertices.col(1).minCoeff();
}

Points WeldedCharacter::vertices(double time) const {
    return m_character.vertices(time)(m_rest.kept, Eigen::all);
}

}  // namespace cloth
