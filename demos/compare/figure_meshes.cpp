#include "demos/compare/figure_meshes.h"

#include <iterator>
#include <utility>

namespace cloth {

SceneMesh skin_mesh(const Points& x, std::shared_ptr<const Faces> faces) {
    SceneMesh mesh;
    mesh.vertices = x;
    mesh.faces = std::move(faces);
    mesh.colour = {222, 190, 170};
    return mesh;
}

SceneMesh garment_mesh(const Points& x, std::shared_ptr<const Faces> faces, size_t index) {
    static const Rgb colours[] = {{196, 84, 72},   {86, 132, 196},  {92, 160, 96},
                                  {214, 150, 62},  {140, 102, 176}, {72, 164, 164},
                                  {196, 112, 152}, {120, 120, 128}};
    SceneMesh mesh;
    mesh.vertices = x;
    mesh.faces = std::move(faces);
    mesh.colour = colours[index % std::size(colours)];
    mesh.back_colour = back_of(mesh.colour);
    mesh.two_sided = true;
    mesh.gloss = 0.0;
    return mesh;
}

}  // namespace cloth
