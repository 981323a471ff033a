#pragma once

#include <memory>
#include <string>

#include "demos/compare/comparison_scene.h"
#include "gnn/stepper.h"

namespace cloth {

/// Makes the solver called `name` for the scene's garment: bullet, bullet-fine, bullet-K,
/// reference, quasi-newton-K, or a network NAME or NAME+K whose weights lie in the options' folder.
/// @throws UsageError for an unknown name, LoadError for weights that are missing or broken
std::unique_ptr<Stepper> make_solver(const std::string& name, const ComparisonScene& scene,
                                     const CompareOptions& options);

}  // namespace cloth
