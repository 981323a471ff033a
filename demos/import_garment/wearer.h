#pragma once

#include <memory>

#include "data/body/body.h"
#include "data/files/painted_mesh.h"
#include "demos/import_garment/options.h"

namespace cloth {

/// The surface that a garment was modelled on.
struct Wearer {
    std::string name;
    TriMesh skin;                      ///< (m)
    std::shared_ptr<const Body> body;  ///< the project's, if it is that
};

/// @throws LoadError, ArgumentError if the character cannot be had, or is not of a person's height
Wearer load_wearer(const ImportOptions& options);

/// The garment's mesh in metres, y up: scaled, turned and moved as the options say; and what is
/// painted on it. MakeHuman's clothes are put on the wearer's body.
/// @throws LoadError, ArgumentError if it cannot be read, or is not where the wearer is; the
/// message
///         names the unit and the up axis that would fit
PaintedMesh load_clothes(const ImportOptions& options, const Wearer& wearer);

}  // namespace cloth
