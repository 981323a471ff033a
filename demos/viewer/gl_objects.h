#pragma once

#include <array>
#include <string>
#include <vector>

#include "data/core/types.h"
#include "render/drawable.h"

namespace cloth {

/// Attributes of vertices in all of the viewer's shaders.
enum GlAttribute : unsigned { gl_position = 0, gl_normal = 1, gl_colour = 2 };

/// A linked pair of shaders of the current OpenGL context.
class GlProgram {
 public:
    /// @throws std::runtime_error with the compiler's message
    GlProgram(const std::string& name, const std::string& vertex, const std::string& fragment);
    ~GlProgram();
    GlProgram(const GlProgram&) = delete;
    GlProgram& operator=(const GlProgram&) = delete;

    void use() const;
    // Uniforms that a shader does not use are passed over.
    void set(const char* name, float value) const;
    void set(const char* name, double value) const { set(name, static_cast<float>(value)); }
    void set(const char* name, const Eigen::Vector3f& v) const;
    void set(const char* name, const Vec3& v) const { set(name, Eigen::Vector3f(v.cast<float>())); }
    void set(const char* name, const Eigen::Matrix4f& m) const;

 private:
    int location(const char* name) const;
    void attach(const std::string& name, unsigned kind, const std::string& source) const;

    unsigned m_id;
};

/// A mesh in OpenGL's buffers.
class GlMesh {
 public:
    GlMesh();
    ~GlMesh();
    GlMesh(const GlMesh&) = delete;
    GlMesh& operator=(const GlMesh&) = delete;

    /// @param colours  3 per vertex, as shaders calculate with them, or empty
    void load(const Drawable& drawable, const std::vector<float>& colours);
    bool has_colours() const { return m_has_colours; }
    void draw() const;

 private:
    unsigned m_array = 0;
    std::array<unsigned, 3> m_buffers{};  ///< positions and normals, colours, indices
    int m_index_count = 0;
    bool m_has_colours = false;
};

/// A depth texture that the key light's view is drawn into.
class GlShadowMap {
 public:
    /// @throws std::runtime_error if the context cannot draw depth into a texture
    explicit GlShadowMap(int size);
    ~GlShadowMap();
    GlShadowMap(const GlShadowMap&) = delete;
    GlShadowMap& operator=(const GlShadowMap&) = delete;

    int size() const { return m_size; }
    void begin() const;  ///< what is drawn from now on goes into the map
    void end() const;    ///< and again into the window
    void bind() const;   ///< as the texture of what is drawn

 private:
    int m_size;
    unsigned m_texture = 0, m_frame = 0;
};

/// A picture of several samples per pixel, which smooths edges. The window's own would do, but some
/// drivers show one of its samples alone.
class GlSmoothFrame {
 public:
    GlSmoothFrame();
    ~GlSmoothFrame();
    GlSmoothFrame(const GlSmoothFrame&) = delete;
    GlSmoothFrame& operator=(const GlSmoothFrame&) = delete;

    void begin(int width, int height);  ///< what is drawn from now on goes into it
    void end() const;                   ///< into the window it goes, and what is drawn next

 private:
    unsigned m_frame = 0;
    std::array<unsigned, 2> m_buffers{};  ///< colours, depth
    int m_width = 0, m_height = 0;
};

}  // namespace cloth
