#pragma once

#include <memory>
#include <string>
#include <vector>

#include "data/body/body.h"
#include "data/body/body_shapes.h"

namespace cloth {

/// The bodies that have names: "default", "slight", "heavy". All but the first need body shapes,
/// see BodyShapes::load_shared().
const std::vector<std::string>& body_names();

/// @throws UsageError if it is none of them, nor the number of a sampled shape (from 0 on)
BodyShape body_shape_named(const std::string& name);

/// The default body in that shape.
/// @throws UsageError also where body shapes are needed and not at hand, LoadError
std::shared_ptr<const Body> body_named(const std::string& name);

}  // namespace cloth
