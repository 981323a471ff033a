#include "demos/compare/proxy_solver.h"

#include <utility>
#include <vector>

#include "data/core/carry_over.h"
#include "data/files/garment_assets.h"
#include "demos/compare/arguments.h"
#include "demos/compare/body_scene.h"
#include "gnn/model/network_start.h"
#include "gnn/physics/stepper/embedded_stepper.h"

namespace cloth {
namespace {

/// What a solver asks a scene for when it is made, with another garment.
class ProxyScene : public ComparisonScene {
 public:
    ProxyScene(Garment proxy, const ComparisonScene& scene)
        : ComparisonScene(std::move(proxy), scene.rate()),
          m_self_contact(scene.self_contact()),
          m_has_limbs(scene.has_limbs()),
          m_segments(scene.segments()) {}

    /// Solvers are given the outside step by step.
    Boundary boundary(double, double) const override { return {}; }
    SelfContactSettings self_contact() const override { return m_self_contact; }
    bool has_limbs() const override { return m_has_limbs; }
    std::vector<BodySegment> segments() const override { return m_segments; }

 private:
    SelfContactSettings m_self_contact;
    bool m_has_limbs;
    std::vector<BodySegment> m_segments;
};

Garment proxy_named(const std::string& name, const std::string& proxy, const Garment& fine) {
    if (proxy.find_first_not_of("0123456789") == std::string::npos)
        return automatic_proxy(name, fine, whole_number("solver " + name, proxy, 20, 100000));
    check_garment_name(proxy);
    return carry_over(fine, load_garment_mesh(proxy), proxy);
}

}  // namespace

std::unique_ptr<Stepper> make_proxy_solver(
    const std::string& name, const std::string& proxy, const ProxyDetail& detail,
    const ComparisonScene& scene,
    const std::function<std::unique_ptr<Stepper>(const ComparisonScene&)>& make) {
    const auto coarse =
        std::make_shared<const ProxyScene>(proxy_named(name, proxy, scene.garment()), scene);
    auto stepper = make(*coarse);
    EmbeddedStepperSettings settings;
    settings.detail_iterations = detail.iterations;
    std::shared_ptr<StepStart> network;
    if (detail.network) network = std::make_shared<NetworkStart>(scene.garment(), detail.network);
    return std::make_unique<EmbeddedStepper>(
        scene.garment(), std::shared_ptr<const Garment>(coarse, &coarse->garment()),
        std::move(stepper), settings, network);
}

}  // namespace cloth
