#include "demos/make_garments/lookbook.h"

#include <cmath>
#include <cstdio>
#include <memory>

#include "data/body/animated_body.h"
#include "data/body/body_shapes.h"
#include "data/body/garment_fit.h"
#include "data/files/garment_assets.h"
#include "gnn/physics/stepper/cloth_stepper.h"
#include "render/montage.h"
#include "render/osmesa_renderer.h"

namespace cloth {
namespace {

constexpr int width = 300, height = 480;  // of a panel (pixels)
constexpr double frame_time = 1.0 / 30.0;
const Rgb colours[] = {{196, 84, 72},   {86, 132, 196}, {92, 160, 96},   {214, 150, 62},
                       {140, 102, 176}, {72, 164, 164}, {196, 112, 152}, {120, 120, 128}};

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

class Studio {
 public:
    explicit Studio(const LookbookSettings& settings)
        : m_settings(settings), m_wearers(wearers()), m_renderer(sizes()) {}

    void add_row(size_t index) {
        const std::string& name = m_settings.garments[index];
        const Garment original = load_garment(name);
        const ClothState worn = load_garment_start(name);
        const Body& standard = *m_wearers.front().body;
        m_panels.push_back(draw(standard.rest(), standard, original, worn.x, index));
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
            const AnimatedBody body(wearer.body, load_motion_by_name(m_settings.motion));
            const double end = wear(garment, body, state);
            m_panels.push_back(draw(body.vertices(end), *wearer.body, garment, state.x, index));
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

    /// @return the time at the end (s)
    double wear(const Garment& garment, const AnimatedBody& body, ClothState& state) const {
        ClothStepper stepper(garment, ClothStepperSettings::plain(IterationLimits::exactly(10)));
        const int lead_in = static_cast<int>(std::lround(body.settings().lead_in / frame_time));
        const int steps = lead_in + m_settings.frames;
        Boundary boundary;
        boundary.pin_targets.resize(0, 3);
        for (int step = 0; step < steps; ++step) {
            boundary.obstacles = {body.obstacle(step * frame_time, (step + 1) * frame_time)};
            stepper.step(boundary, frame_time, state);
        }
        return steps * frame_time;
    }

    Image draw(const Points& skin, const Body& body, const Garment& garment, const Points& x,
               size_t index) {
        Scene scene;
        SceneMesh person;
        person.vertices = skin;
        person.faces = body.faces();
        person.colour = {222, 190, 170};
        scene.meshes.push_back(person);
        SceneMesh cloth;
        cloth.vertices = x;
        cloth.faces = std::make_shared<Faces>(garment.rest().faces);
        cloth.colour = colours[index % std::size(colours)];
        cloth.back_colour = back_of(cloth.colour);
        cloth.two_sided = true;
        cloth.gloss = 0.0;
        scene.meshes.push_back(cloth);
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
