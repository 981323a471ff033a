#include "data/files/garment_assets.h"

#include "data/core/paths.h"
#include "data/files/mesh_io.h"

namespace cloth {

TriMesh load_garment_mesh(const std::string& name) {
    return load_mesh(asset_path("garments/" + name + ".obj"));
}

Garment load_garment(const std::string& name, const Fabric& fabric) {
    return Garment(name, load_garment_mesh(name), fabric);
}

}  // namespace cloth
