#include "demos/viewer/drawer.h"

#include <epoxy/gl.h>

#include <string>

#include "demos/viewer/gl_objects.h"
#include "render/scene_uniforms.h"
#include "render/shaders.h"

namespace cloth {
namespace {

using Mat4f = Eigen::Matrix4f;

constexpr int shadow_size = 1024;

constexpr char line_fragment[] = R"(
void main() { COLOUR = vec4(0.05, 0.06, 0.08, 0.55); }
)";

std::string vertex_source(bool coloured) {
    return std::string(shaders::kVertex330) + (coloured ? "#define VERTEX_COLOURS\n" : "") +
           shaders::kMeshVertex;
}

std::string lit_fragment_source(bool coloured, const char* body) {
    return std::string(shaders::kFragment330) + (coloured ? "#define VERTEX_COLOURS\n" : "") +
           "#define SHADOW_TAPS 8\n#define SHADOW_BLUR 3.0\n" + shaders::kShadowFunction + body;
}

std::string plain_fragment_source(const char* body) {
    return std::string(shaders::kFragment330) + body;
}

/// Row after row, as the shaders calculate with them.
std::vector<float> linear_colours(const Points& colours) {
    std::vector<float> values(static_cast<size_t>(colours.size()));
    for (size_t k = 0; k < values.size(); ++k) {
        const double shown = colours.data()[k];
        values[k] = static_cast<float>(shown * shown);
    }
    return values;
}

}  // namespace

struct Drawer::Implementation {
    GlProgram mesh_program{"mesh", vertex_source(true),
                           lit_fragment_source(true, shaders::kMeshFragment)};
    GlProgram ground_program{"ground", vertex_source(false),
                             lit_fragment_source(false, shaders::kGroundFragment)};
    GlProgram shadow_program{"shadow", vertex_source(false),
                             plain_fragment_source(shaders::kEmptyFragment)};
    GlProgram line_program{"line", vertex_source(false), plain_fragment_source(line_fragment)};
    GlShadowMap shadow_map{shadow_size};
    GlSmoothFrame frame;
    Scene scene;
    std::vector<std::unique_ptr<GlMesh>> meshes;
    GlMesh ground;
    ShadowView shadow;

    void load(const Scene& new_scene, const std::vector<Points>& colours);
    void draw_shadow_map() const;
    void draw_meshes(const Camera& camera, double aspect) const;
    void draw_lines(const Camera& camera, double aspect) const;
    void draw_ground(const Camera& camera, double aspect) const;
    void set_common(const GlProgram& program, const Camera& camera, double aspect) const;
};

void Drawer::Implementation::load(const Scene& new_scene, const std::vector<Points>& colours) {
    check_ground_and_lights(new_scene);
    scene = new_scene;
    while (meshes.size() < scene.meshes.size()) meshes.push_back(std::make_unique<GlMesh>());
    std::vector<Drawable> drawables;
    for (size_t k = 0; k < scene.meshes.size(); ++k) {
        drawables.push_back(
            drawable_of("Scene::meshes[" + std::to_string(k) + "]", scene.meshes[k]));
        meshes[k]->load(drawables.back(),
                        k < colours.size() ? linear_colours(colours[k]) : std::vector<float>());
    }
    ground.load(ground_quad(scene.ground), {});
    shadow = shadow_view(drawables, scene.lights.key, shadow_map.size());
    draw_shadow_map();
}

void Drawer::Implementation::draw_shadow_map() const {
    glEnable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    shadow_map.begin();
    shadow_program.use();
    shadow_program.set("view", shadow.view);
    shadow_program.set("projection", shadow.projection);
    shadow_program.set("depth_offset", 0.0f);
    for (size_t k = 0; k < scene.meshes.size(); ++k) meshes[k]->draw();
    shadow_map.end();
}

void Drawer::Implementation::set_common(const GlProgram& program, const Camera& camera,
                                        double aspect) const {
    program.use();
    set_scene_uniforms(program, camera, aspect, scene.lights, shadow, shadow_map.size());
    program.set("depth_offset", 0.0f);
}

void Drawer::Implementation::draw_meshes(const Camera& camera, double aspect) const {
    set_common(mesh_program, camera, aspect);
    for (size_t k = 0; k < scene.meshes.size(); ++k) {
        const SceneMesh& mesh = scene.meshes[k];
        mesh_program.set("front_colour", linear(mesh.colour));
        mesh_program.set("back_colour", linear(mesh.back_colour));
        mesh_program.set("gloss", mesh.gloss);
        mesh_program.set("depth_offset", mesh.depth_offset);
        mesh_program.set("coloured", meshes[k]->has_colours() ? 1.0f : 0.0f);
        (mesh.two_sided ? glDisable : glEnable)(GL_CULL_FACE);
        meshes[k]->draw();
    }
    glDisable(GL_CULL_FACE);
}

void Drawer::Implementation::draw_lines(const Camera& camera, double aspect) const {
    set_common(line_program, camera, aspect);
    line_program.set("depth_offset", -5e-4f);  // before the faces that they border
    glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    for (size_t k = 0; k < scene.meshes.size(); ++k)
        if (scene.meshes[k].two_sided) meshes[k]->draw();
    glDisable(GL_BLEND);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

void Drawer::Implementation::draw_ground(const Camera& camera, double aspect) const {
    set_common(ground_program, camera, aspect);
    ground_program.set("centre", scene.ground.centre);
    ground_program.set("radius", scene.ground.radius);
    ground_program.set("grid", scene.ground.grid);
    ground_program.set("front_colour", linear(scene.ground.colour));
    ground_program.set("line_colour", linear(scene.ground.line));
    ground_program.set("background", linear(scene.background));
    ground.draw();
}

Drawer::Drawer() : m_implementation(std::make_unique<Implementation>()) {
}

Drawer::~Drawer() = default;

void Drawer::load(const Scene& scene, const std::vector<Points>& colours) {
    m_implementation->load(scene, colours);
}

void Drawer::draw(const Camera& camera, int width, int height, bool wireframe) {
    Implementation& parts = *m_implementation;
    const double aspect = static_cast<double>(width) / height;
    parts.shadow_map.bind();  // again: who draws the panel binds textures of its own
    parts.frame.begin(width, height);
    glViewport(0, 0, width, height);
    const Rgb clear = parts.scene.background;
    glClearColor(clear.r / 255.0f, clear.g / 255.0f, clear.b / 255.0f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_MULTISAMPLE);
    parts.draw_meshes(camera, aspect);
    if (wireframe) parts.draw_lines(camera, aspect);
    if (parts.scene.ground.visible) parts.draw_ground(camera, aspect);
    parts.frame.end();
}

Image drawn_picture(int width, int height) {
    Image picture(width, height), flipped(width, height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, flipped.bytes());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) picture.at(x, y) = flipped.at(x, height - 1 - y);
    return picture;
}

}  // namespace cloth
