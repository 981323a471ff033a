#include "demos/viewer/gl_objects.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <stdexcept>

namespace cloth {
namespace {

template <typename T>
void load_buffer(GLenum target, GLuint id, const std::vector<T>& values) {
    glBindBuffer(target, id);
    glBufferData(target, static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data(),
                 GL_DYNAMIC_DRAW);
}

void point_to(GLuint attribute, GLsizei stride, size_t offset) {
    glEnableVertexAttribArray(attribute);
    glVertexAttribPointer(attribute, 3, GL_FLOAT, GL_FALSE,
                          stride * static_cast<GLsizei>(sizeof(float)),
                          reinterpret_cast<const void*>(offset * sizeof(float)));
}

}  // namespace

GlProgram::GlProgram(const std::string& name, const std::string& vertex,
                     const std::string& fragment)
    : m_id(glCreateProgram()) {
    attach(name + " vertex shader", GL_VERTEX_SHADER, vertex);
    attach(name + " fragment shader", GL_FRAGMENT_SHADER, fragment);
    glBindAttribLocation(m_id, gl_position, "position");
    glBindAttribLocation(m_id, gl_normal, "normal");
    glBindAttribLocation(m_id, gl_colour, "colour");
    glLinkProgram(m_id);
    GLint linked = 0;
    glGetProgramiv(m_id, GL_LINK_STATUS, &linked);
    if (!linked) throw std::runtime_error("OpenGL, " + name + " shaders: cannot be linked");
}

GlProgram::~GlProgram() {
    glDeleteProgram(m_id);
}

void GlProgram::attach(const std::string& name, unsigned kind, const std::string& source) const {
    const GLuint shader = glCreateShader(kind);
    const char* text = source.c_str();
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint compiled = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    std::array<char, 2000> log{};
    glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()) - 1, nullptr, log.data());
    glAttachShader(m_id, shader);
    glDeleteShader(shader);
    if (!compiled) throw std::runtime_error("OpenGL, " + name + ": " + log.data());
}

int GlProgram::location(const char* name) const {
    return glGetUniformLocation(m_id, name);
}

void GlProgram::use() const {
    glUseProgram(m_id);
}

void GlProgram::set(const char* name, float value) const {
    glUniform1f(location(name), value);
}

void GlProgram::set(const char* name, const Eigen::Vector3f& v) const {
    glUniform3fv(location(name), 1, v.data());
}

void GlProgram::set(const char* name, const Eigen::Matrix4f& m) const {
    glUniformMatrix4fv(location(name), 1, GL_FALSE, m.data());
}

GlMesh::GlMesh() {
    glGenVertexArrays(1, &m_array);
    glGenBuffers(static_cast<GLsizei>(m_buffers.size()), m_buffers.data());
}

GlMesh::~GlMesh() {
    glDeleteBuffers(static_cast<GLsizei>(m_buffers.size()), m_buffers.data());
    glDeleteVertexArrays(1, &m_array);
}

void GlMesh::load(const Drawable& drawable, const std::vector<float>& colours) {
    glBindVertexArray(m_array);
    load_buffer(GL_ARRAY_BUFFER, m_buffers[0], drawable.vertices);
    point_to(gl_position, 6, 0);
    point_to(gl_normal, 6, 3);
    m_has_colours = !colours.empty();
    if (m_has_colours) {
        load_buffer(GL_ARRAY_BUFFER, m_buffers[1], colours);
        point_to(gl_colour, 3, 0);
    } else {
        glDisableVertexAttribArray(gl_colour);
    }
    load_buffer(GL_ELEMENT_ARRAY_BUFFER, m_buffers[2], drawable.indices);
    m_index_count = static_cast<int>(drawable.indices.size());
    glBindVertexArray(0);
}

void GlMesh::draw() const {
    glBindVertexArray(m_array);
    glDrawElements(GL_TRIANGLES, m_index_count, GL_UNSIGNED_INT, nullptr);
    glBindVertexArray(0);
}

GlShadowMap::GlShadowMap(int size) : m_size(size) {
    glGenTextures(1, &m_texture);
    glBindTexture(GL_TEXTURE_2D, m_texture);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, size, size, 0, GL_DEPTH_COMPONENT,
                 GL_FLOAT, nullptr);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    glGenFramebuffers(1, &m_frame);
    glBindFramebuffer(GL_FRAMEBUFFER, m_frame);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, m_texture, 0);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    const bool complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    if (!complete) throw std::runtime_error("OpenGL: depth cannot be drawn into a texture");
}

GlShadowMap::~GlShadowMap() {
    glDeleteFramebuffers(1, &m_frame);
    glDeleteTextures(1, &m_texture);
}

void GlShadowMap::begin() const {
    glBindFramebuffer(GL_FRAMEBUFFER, m_frame);
    glViewport(0, 0, m_size, m_size);
    glClear(GL_DEPTH_BUFFER_BIT);
    glEnable(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(1.5f, 2.0f);
}

void GlShadowMap::end() const {
    glDisable(GL_POLYGON_OFFSET_FILL);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

void GlShadowMap::bind() const {
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, m_texture);
}

GlSmoothFrame::GlSmoothFrame() {
    glGenFramebuffers(1, &m_frame);
    glGenRenderbuffers(static_cast<GLsizei>(m_buffers.size()), m_buffers.data());
}

GlSmoothFrame::~GlSmoothFrame() {
    glDeleteRenderbuffers(static_cast<GLsizei>(m_buffers.size()), m_buffers.data());
    glDeleteFramebuffers(1, &m_frame);
}

void GlSmoothFrame::begin(int width, int height) {
    glBindFramebuffer(GL_FRAMEBUFFER, m_frame);
    if (width == m_width && height == m_height) return;
    m_width = width;
    m_height = height;
    GLint most = 0;
    glGetIntegerv(GL_MAX_SAMPLES, &most);
    const GLint samples = std::min(most, 4);
    const auto attach = [&](GLuint buffer, GLenum format, GLenum place) {
        glBindRenderbuffer(GL_RENDERBUFFER, buffer);
        glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
        glFramebufferRenderbuffer(GL_FRAMEBUFFER, place, GL_RENDERBUFFER, buffer);
    };
    attach(m_buffers[0], GL_RGBA8, GL_COLOR_ATTACHMENT0);
    attach(m_buffers[1], GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw std::runtime_error("OpenGL: there is no room for a picture of " +
                                 std::to_string(width) + " x " + std::to_string(height) +
                                 " pixels");
}

void GlSmoothFrame::end() const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, m_frame);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    glBlitFramebuffer(0, 0, m_width, m_height, 0, 0, m_width, m_height, GL_COLOR_BUFFER_BIT,
                      GL_NEAREST);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

}  // namespace cloth
