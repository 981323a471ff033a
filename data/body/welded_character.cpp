#include "data/body/welded_character.h"

namespace cloth {

WeldedCharacter::WeldedCharacter(const std::string& path, const CharacterSettings& settings,
                                 double tolerance)
    : MovingSurface(settings.friction),
      m_character(path, settings),
      m_rest(weld_mesh({m_character.rest_vertices(), *m_character.faces()}, tolerance)),
      m_faces(std::make_shared<const Faces>(m_rest.mesh.faces)) {
}

double WeldedCharacter::height() const {
    return rest().vertices.col(1).maxCoeff() - rest().vertices.col(1).minCoeff();
}

Points WeldedCharacter::vertices(double time) const {
    return m_character.vertices(time)(m_rest.kept, Eigen::all);
}

}  // namespace cloth
