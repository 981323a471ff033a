#pragma once

#include <functional>
#include <memory>
#include <string>

#include "demos/compare/comparison_scene.h"
#include "gnn/model/predictor.h"
#include "gnn/stepper.h"

namespace cloth {

/// What the fine garment's own step has, see EmbeddedStepper.
struct ProxyDetail {
    std::shared_ptr<Predictor> network;  ///< null: none
    int iterations = 0;
};

/// A solver of the scene's garment that simulates a coarser one in its place, see EmbeddedStepper.
///
/// @param name   the solver's, for messages
/// @param proxy  a number of vertices: make_proxy() makes it; else a garment as load_garment_mesh()
///               takes it, which is worn in the same place
/// @param make   makes the solver of the coarse garment's scene
/// @throws UsageError if there is no such garment or this program is built without make_proxy(),
///         ArgumentError as make_proxy(), carry_over() and EmbeddedStepper do
std::unique_ptr<Stepper> make_proxy_solver(
    const std::string& name, const std::string& proxy, const ProxyDetail& detail,
    const ComparisonScene& scene,
    const std::function<std::unique_ptr<Stepper>(const ComparisonScene&)>& make);

/// make_proxy() with so many vertices.
/// @throws UsageError if this program is built without CGAL
Garment automatic_proxy(const std::string& name, const Garment& fine, int vertices);

}  // namespace cloth
