#pragma once

#include <nlohmann/json.hpp>

#include "demos/compare/references.h"
#include "demos/lookbook/options.h"

namespace cloth {

/// Makes the files that the options ask for, one body after the other; the film of a body is there
/// when its frames are.
/// @return  the measured rows, see Look::measured()
/// @throws UsageError, LoadError, ArgumentError
nlohmann::ordered_json make_lookbook(const LookbookOptions& options,
                                     const ProgressFunction& progress);

}  // namespace cloth
