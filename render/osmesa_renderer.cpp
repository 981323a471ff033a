#include "render/osmesa_renderer.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/gl.h>
#include <GL/glext.h>
#include <GL/osmesa.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "data/core/check_range.h"
#include "data/core/errors.h"
#include "render/drawable.h"
#include "render/scene_uniforms.h"
#include "render/shaders.h"
#include "render/text.h"

namespace cloth {

namespace {

using Vec3f = Eigen::Vector3f;

constexpr GLuint kPosition = 0;
constexpr GLuint kNormal = 1;

LoadError osmesa_error(const std::string& place, const std::string& problem) {
    return LoadError("OSMesa", place, problem,
                     "install Debian's libosmesa6 of version 20 or newer");
}

/// A linked pair of shaders.
class Program {
 public:
    Program(const std::string& name, const std::string& vertex, const std::string& fragment)
        : m_id(glCreateProgram()) {
        attach(name + " vertex shader", GL_VERTEX_SHADER, vertex);
        attach(name + " fragment shader", GL_FRAGMENT_SHADER, fragment);
        glBindAttribLocation(m_id, kPosition, "position");
        glBindAttribLocation(m_id, kNormal, "normal");
        glLinkProgram(m_id);
        GLint linked = 0;
        glGetProgramiv(m_id, GL_LINK_STATUS, &linked);
        if (!linked) throw osmesa_error(name + " shaders", "cannot be linked");
    }

    void use() const { glUseProgram(m_id); }
    void set(const char* name, float value) const { glUniform1f(location(name), value); }
    void set(const char* name, double value) const { set(name, static_cast<float>(value)); }
    void set(const char* name, const Vec3f& v) const { glUniform3fv(location(name), 1, v.data()); }
    void set(const char* name, const Vec3& v) const { set(name, Vec3f(v.cast<float>())); }
    void set(const char* name, const Eigen::Matrix4f& m) const {
        glUniformMatrix4fv(location(name), 1, GL_FALSE, m.data());
    }

 private:
    // Uniforms that a shader does not use have no location; GL ignores what is set there.
    GLint location(const char* name) const { return glGetUniformLocation(m_id, name); }

    void attach(const std::string& name, GLenum kind, const std::string& source) const {
        const GLuint shader = glCreateShader(kind);
        const char* text = source.c_str();
        glShaderSource(shader, 1, &text, nullptr);
        glCompileShader(shader);
        GLint compiled = 0;
        glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
        std::array<char, 2000> log{};
        glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()) - 1, nullptr, log.data());
        if (!compiled) throw osmesa_error(name, std::string("cannot be compiled: ") + log.data());
        glAttachShader(m_id, shader);
        glDeleteShader(shader);
    }

    GLuint m_id;
};

/// One mesh in OpenGL's buffers, freed at the end of the picture.
class Buffers {
 public:
    explicit Buffers(const Drawable& drawable)
        : m_index_count(static_cast<GLsizei>(drawable.indices.size())) {
        glGenBuffers(2, m_ids.data());
        glBindBuffer(GL_ARRAY_BUFFER, m_ids[0]);
        glBufferData(GL_ARRAY_BUFFER, bytes(drawable.vertices), drawable.vertices.data(),
                     GL_STREAM_DRAW);
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, m_ids[1]);
        glBufferData(GL_ELEMENT_ARRAY_BUFFER, bytes(drawable.indices), drawable.indices.data(),
                     GL_STREAM_DRAW);
    }
    ~Buffers() { glDeleteBuffers(2, m_ids.data()); }
    Buffers(const Buffers&) = delete;
    Buffers& operator=(const Buffers&) = delete;

    void draw() const {
        constexpr GLsizei kStride = 6 * sizeof(float);
        glBindBuffer(GL_ARRAY_BUFFER, m_ids[0]);
        glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, m_ids[1]);
        glEnableVertexAttribArray(kPosition);
        glEnableVertexAttribArray(kNormal);
        glVertexAttribPointer(kPosition, 3, GL_FLOAT, GL_FALSE, kStride, nullptr);
        glVertexAttribPointer(kNormal, 3, GL_FLOAT, GL_FALSE, kStride,
                              reinterpret_cast<const void*>(3 * sizeof(float)));
        glDrawElements(GL_TRIANGLES, m_index_count, GL_UNSIGNED_INT, nullptr);
    }

 private:
    template <typename T>
    static GLsizeiptr bytes(const std::vector<T>& values) {
        return static_cast<GLsizeiptr>(values.size() * sizeof(T));
    }

    std::array<GLuint, 2> m_ids{};
    GLsizei m_index_count;
};

/// @param blur  radius of the shadow's soft border (texels)
std::string fragment_source(int taps, int blur, const char* body) {
    return std::string(shaders::kFragment120) + "#define SHADOW_TAPS " + std::to_string(taps) +
           "\n#define SHADOW_BLUR float(" + std::to_string(blur) + ")\n" +
           shaders::kShadowFunction + body;
}

}  // namespace

class OsmesaRenderer::Implementation {
 public:
    explicit Implementation(const OsmesaSettings& settings);
    ~Implementation() { OSMesaDestroyContext(m_context); }
    Implementation(const Implementation&) = delete;
    Implementation& operator=(const Implementation&) = delete;

    Image render(const Scene& scene, const Camera& camera);

 private:
    using BufferList = std::vector<std::unique_ptr<Buffers>>;

    void make_current();
    void make_shadow_map();
    void draw_shadow_map(const BufferList& buffers, const ShadowView& shadow);
    void draw_scene(const Scene& scene, const Camera& camera, const BufferList& buffers,
                    const ShadowView& shadow);
    void set_common(const Program& program, const Scene& scene, const Camera& camera,
                    const ShadowView& shadow) const;
    Image picture() const;

    OsmesaSettings m_settings;
    int m_scale;  ///< drawn pixels per pixel of the picture, along one side
    OSMesaContext m_context;
    std::vector<std::uint8_t> m_buffer;  ///< RGBA, first row on top
    std::unique_ptr<Program> m_mesh_program, m_ground_program, m_shadow_program;
    GLuint m_shadow_frame = 0;
    Font m_font;
};

OsmesaRenderer::Implementation::Implementation(const OsmesaSettings& settings)
    : m_settings(settings), m_scale(settings.anti_aliasing ? 2 : 1), m_context(nullptr) {
    check_range("OsmesaSettings.width", settings.width, 16, 4096);
    check_range("OsmesaSettings.height", settings.height, 16, 4096);
    check_range("OsmesaSettings.shadow_size", settings.shadow_size, 64, 4096);
    m_buffer.resize(std::size_t(4) * settings.width * settings.height * m_scale * m_scale);
    m_context = OSMesaCreateContextExt(OSMESA_RGBA, 24, 0, 0, nullptr);
    if (!m_context) throw osmesa_error("", "no off-screen context can be made");
    try {
        make_current();
        const std::string vertex = std::string(shaders::kVertex120) + shaders::kMeshVertex;
        m_mesh_program = std::make_unique<Program>("mesh", vertex,
                                                   fragment_source(8, 3, shaders::kMeshFragment));
        m_ground_program = std::make_unique<Program>(
            "ground", vertex, fragment_source(6, 4, shaders::kGroundFragment));
        m_shadow_program = std::make_unique<Program>(
            "shadow", vertex, std::string(shaders::kFragment120) + shaders::kEmptyFragment);
        make_shadow_map();
    } catch (...) {
        OSMesaDestroyContext(m_context);
        throw;
    }
}

void OsmesaRenderer::Implementation::make_current() {
    if (!OSMesaMakeCurrent(m_context, m_buffer.data(), GL_UNSIGNED_BYTE, m_scale * m_settings.width,
                           m_scale * m_settings.height))
        throw osmesa_error("", "the off-screen context cannot be used");
    OSMesaPixelStore(OSMESA_Y_UP, 0);
}

void OsmesaRenderer::Implementation::make_shadow_map() {
    GLuint map = 0;
    glGenTextures(1, &map);
    glBindTexture(GL_TEXTURE_2D, map);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, m_settings.shadow_size,
                 m_settings.shadow_size, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
    for (GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    for (GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);

    glGenFramebuffers(1, &m_shadow_frame);
    glBindFramebuffer(GL_FRAMEBUFFER, m_shadow_frame);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, map, 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    const bool complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    if (!complete) throw osmesa_error("shadow map", "depth cannot be drawn into a texture");
}

Image OsmesaRenderer::Implementation::render(const Scene& scene, const Camera& camera) {
    check_ground_and_lights(scene);
    make_current();
    std::vector<Drawable> drawables;
    for (std::size_t i = 0; i < scene.meshes.size(); ++i)
        drawables.push_back(
            drawable_of("Scene::meshes[" + std::to_string(i) + "]", scene.meshes[i]));
    BufferList buffers;
    for (const Drawable& drawable : drawables)
        buffers.push_back(std::make_unique<Buffers>(drawable));
    const ShadowView shadow = shadow_view(drawables, scene.lights.key, m_settings.shadow_size);
    glEnable(GL_DEPTH_TEST);
    if (scene.lights.shadows) draw_shadow_map(buffers, shadow);
    draw_scene(scene, camera, buffers, shadow);
    glFinish();
    if (glGetError() != GL_NO_ERROR) throw osmesa_error("", "the picture could not be drawn");

    Image image = picture();
    for (const Label& label : scene.labels) draw_label(m_font, label, image);
    return image;
}

void OsmesaRenderer::Implementation::draw_shadow_map(const BufferList& buffers,
                                                     const ShadowView& shadow) {
    glBindFramebuffer(GL_FRAMEBUFFER, m_shadow_frame);
    glViewport(0, 0, m_settings.shadow_size, m_settings.shadow_size);
    glClear(GL_DEPTH_BUFFER_BIT);
    glDisable(GL_CULL_FACE);
    m_shadow_program->use();
    m_shadow_program->set("view", shadow.view);
    m_shadow_program->set("projection", shadow.projection);
    m_shadow_program->set("depth_offset", 0.0f);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1.5f, 2.0f);
    for (const auto& mesh : buffers) mesh->draw();
    glDisable(GL_POLYGON_OFFSET_FILL);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void OsmesaRenderer::Implementation::set_common(const Program& program, const Scene& scene,
                                                const Camera& camera,
                                                const ShadowView& shadow) const {
    const double aspect = static_cast<double>(m_settings.width) / m_settings.height;
    program.use();
    set_scene_uniforms(program, camera, aspect, scene.lights, shadow, m_settings.shadow_size);
}

void OsmesaRenderer::Implementation::draw_scene(const Scene& scene, const Camera& camera,
                                                const BufferList& buffers,
                                                const ShadowView& shadow) {
    glViewport(0, 0, m_scale * m_settings.width, m_scale * m_settings.height);
    const Rgb clear = scene.background;
    glClearColor(clear.r / 255.0f, clear.g / 255.0f, clear.b / 255.0f, 1.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);

    set_common(*m_mesh_program, scene, camera, shadow);
    for (std::size_t i = 0; i < buffers.size(); ++i) {
        const SceneMesh& mesh = scene.meshes[i];
        m_mesh_program->set("front_colour", linear(mesh.colour));
        m_mesh_program->set("back_colour", linear(mesh.back_colour));
        m_mesh_program->set("gloss", mesh.gloss);
        m_mesh_program->set("depth_offset", mesh.depth_offset);
        (mesh.two_sided ? glDisable : glEnable)(GL_CULL_FACE);
        buffers[i]->draw();
    }
    if (!scene.ground.visible) return;

    // Last: what stands on the floor has hidden most of it by now.
    set_common(*m_ground_program, scene, camera, shadow);
    m_ground_program->set("depth_offset", 0.0f);
    m_ground_program->set("centre", scene.ground.centre);
    m_ground_program->set("radius", scene.ground.radius);
    m_ground_program->set("grid", scene.ground.grid);
    m_ground_program->set("front_colour", linear(scene.ground.colour));
    m_ground_program->set("line_colour", linear(scene.ground.line));
    m_ground_program->set("background", linear(scene.background));
    glDisable(GL_CULL_FACE);
    Buffers(ground_quad(scene.ground)).draw();
}

/// The drawn buffer, each pixel the mean of its samples.
Image OsmesaRenderer::Implementation::picture() const {
    Image image(m_settings.width, m_settings.height);
    const int samples = m_scale * m_scale;
    const std::size_t row = std::size_t(4) * m_scale * m_settings.width;
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            std::array<int, 3> sum{};
            for (int k = 0; k < samples; ++k) {
                const std::uint8_t* sample =
                    &m_buffer[row * (m_scale * y + k / m_scale) + 4 * (m_scale * x + k % m_scale)];
                for (int c = 0; c < 3; ++c) sum[c] += sample[c];
            }
            const auto mean = [&](int c) {
                return static_cast<std::uint8_t>((sum[c] + samples / 2) / samples);
            };
            image.at(x, y) = {mean(0), mean(1), mean(2)};
        }
    }
    return image;
}

OsmesaRenderer::OsmesaRenderer(const OsmesaSettings& settings)
    : m_implementation(std::make_unique<Implementation>(settings)) {
}

OsmesaRenderer::~OsmesaRenderer() = default;

Image OsmesaRenderer::render(const Scene& scene, const Camera& camera) {
    return m_implementation->render(scene, camera);
}

Rgb back_of(Rgb front) {
    const auto darker = [&](std::uint8_t c) {
        const double grey = (front.r + front.g + front.b) / 3.0;
        return static_cast<std::uint8_t>(0.8 * (0.6 * c + 0.4 * grey));
    };
    return {darker(front.r), darker(front.g), darker(front.b)};
}

}  // namespace cloth
