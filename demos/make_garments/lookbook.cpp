#include "demos/make_garments/lookbook.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "data/body/animated_body.h"
#include "data/body/body_shapes.h"
#include "data/body/garment_fit.h"
#include "data/body/outfit.h"
#include "demos/compare/figure_meshes.h"
#include "gnn/physics/stepper/cloth_stepper.h"
#include "render/montage.h"
#include "render/osmesa_renderer.h"

namespace cloth {
namespace {

constexpr int width = 300, height = 480;  // of a panel (pixels)
constexpr double frame_time = 1.0 / 30.0;

struct Wearer {
    std::string name;
    std::shared_ptr<const Body> body;
};

std::vector<Wearer> wearers() {
    const auto standard = std::make_shared<const Body>(Body::load_default());
    std::vector<Wearer> all = {{"the default body", standard}};
    const auto shapes = BodyShapes::load_shared();
    if (!shapes) return all;
    BodyShape slight, heavy;
    slight.female = 1.0;
    slight.weight = 0.35;
    slight.height = 0.45;
    heavy.female = 0.0;
    heavy.weight = 0.75;
    heavy.waist = 0.3;
    for (const auto& [name, shape] : {std::pair("a slight body", slight), {"a heavy body", heavy}})
        all.push_back(
            {name, std::make_shared<const Body>(standard->with_rest(shapes->skin(shape)))});
    return all;
}

Faces faces_of_part(const Outfit& outfit, size_t part) {
    const Faces& all = outfit.garment.rest().faces;
    const auto is_of_part = [&](Eigen::Index f) {
        return all(f, 0) >= outfit.first_vertex[part] && all(f, 0) < outfit.first_vertex[part + 1];
    };
    Faces faces(all.rows(), 3);
    Eigen::Index count = 0;
    for (Eigen::Index f = 0; f < all.rows(); ++f)
        if (is_of_part(f)) faces.row(count++) = all.row(f);
    faces.conservativeResize(count, 3);
    return faces;
}

class Studio {
 public:
    explicit Studio(const LookbookSettings& settings)
        : m_settings(settings), m_wearers(wearers()), m_renderer(sizes()) {}

    void add_row(size_t index) {
        const std::string& name = m_settings.garments[index];
        const Outfit outfit = load_outfit(name);
        const Garment& original = outfit.garment;
        const ClothState& worn = outfit.start;
        const Body& standard = *m_wearers.front().body;
        const ClothStepperSettings settings = stepper_settings(outfit.has_layers());
        m_panels.push_back(draw(standard.rest(), standard, outfit, worn.x, index));
        m_captions.push_back(name + ", put on");
        for (const Wearer& wearer : m_wearers) {
            ClothState state = worn;
            if (&wearer != &m_wearers.front())
                state.x = fit_garment({worn.x, original.rest().faces}, standard.rest_mesh(),
                                      wearer.body->rest());
            // The rest shape moves as far as the worn one does: it keeps its ease and its band.
            const Garment garment(
                name, {original.rest().vertices + (state.x - worn.x), original.rest().faces},
                original.fabric());
            AnimationSettings animation;
            animation.limbs = true;
            const AnimatedBody body(wearer.body, load_motion_by_name(m_settings.motion), animation);
            const double end = wear(garment, body, settings, state);
            m_panels.push_back(draw(body.vertices(end), *wearer.body, outfit, state.x, index));
            m_captions.push_back(wearer.name);
            std::printf("%s on %s\n", name.c_str(), wearer.name.c_str());
            std::fflush(stdout);
        }
    }

    Image finish() const {
        MontageSettings montage_settings;
        montage_settings.columns = 1 + static_cast<int>(m_wearers.size());
        montage_settings.caption_height = 18;
        return montage(m_panels, m_captions, montage_settings);
    }

 private:
    static OsmesaSettings sizes() {
        OsmesaSettings settings;
        settings.width = width;
        settings.height = height;
        return settings;
    }

    static ClothStepperSettings stepper_settings(bool layers) {
        auto settings = ClothStepperSettings::plain(IterationLimits::exactly(10));
        if (layers) settings.step.potential.self_contact.thickness = Outfit::thickness;
        return settings;
    }

    /// @return the time at the end (s)
    double wear(const Garment& garment, const AnimatedBody& body,
                const ClothStepperSettings& settings, ClothState& state) const {
        ClothStepper stepper(garment, settings);
        const int lead_in = static_cast<int>(std::lround(body.settings().lead_in / frame_time));
        const int last = body.frame_count(frame_time) - 1;
        const int steps = std::min(lead_in + m_settings.frames, last);
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        for (int step = 0; step < steps; ++step) {
            boundary.obstacles = {body.obstacle(step * frame_time, (step + 1) * frame_time)};
            stepper.step(boundary, frame_time, state);
        }
        return steps * frame_time;
    }

    Image draw(const Points& skin, const Body& body, const Outfit& outfit, const Points& x,
               size_t index) {
        Scene scene;
        scene.meshes.push_back(skin_mesh(skin, body.faces()));
        for (size_t part = 0; part + 1 < outfit.first_vertex.size(); ++part)
            scene.meshes.push_back(garment_mesh(
                x, std::make_shared<Faces>(faces_of_part(outfit, part)), index + part));
        scene.ground.centre = skin.colwise().mean().transpose();
        FigureTracker tracker(FramingSettings{}, static_cast<double>(width) / height);
        return m_renderer.render(scene, tracker.follow(skin));
    }

    LookbookSettings m_settings;
    std::vector<Wearer> m_wearers;
    OsmesaRenderer m_renderer;
    std::vector<Image> m_panels;
    std::vector<std::string> m_captions;
};

}  // namespace

Image lookbook(const LookbookSettings& settings) {
    Studio studio(settings);
    for (size_t k = 0; k < settings.garments.size(); ++k) studio.add_row(k);
    return studio.finish();
}

}  // namespace cloth
