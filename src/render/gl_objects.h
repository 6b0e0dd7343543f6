// GL objects that delete themselves. Needs a current context; internal to the render layer.
#pragma once

#include <epoxy/gl.h>

#include <string_view>
#include <utility>

namespace ibl {

/// Owner of one GL name, deleted by `Delete`.
template <void (*Delete)(GLuint)>
class GlObject {
public:
    GlObject() = default;
    explicit GlObject(GLuint id) : id_(id) {}
    ~GlObject() {
        if (id_) Delete(id_);
    }
    GlObject(GlObject&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(id_, other.id_);
        return *this;
    }
    GLuint id() const { return id_; }
    explicit operator bool() const { return id_ != 0; }

private:
    GLuint id_ = 0;
};

inline void deleteTexture(GLuint id) {
    glDeleteTextures(1, &id);
}
inline void deleteBuffer(GLuint id) {
    glDeleteBuffers(1, &id);
}
inline void deleteVertexArray(GLuint id) {
    glDeleteVertexArrays(1, &id);
}
inline void deleteFramebuffer(GLuint id) {
    glDeleteFramebuffers(1, &id);
}
inline void deleteRenderbuffer(GLuint id) {
    glDeleteRenderbuffers(1, &id);
}
inline void deleteShader(GLuint id) {
    glDeleteShader(id);
}
inline void deleteProgram(GLuint id) {
    glDeleteProgram(id);
}

using Texture = GlObject<deleteTexture>;
using Buffer = GlObject<deleteBuffer>;
using VertexArray = GlObject<deleteVertexArray>;
using Framebuffer = GlObject<deleteFramebuffer>;
using Renderbuffer = GlObject<deleteRenderbuffer>;
using ShaderStage = GlObject<deleteShader>;
using Program = GlObject<deleteProgram>;

/// A texture, unfiltered until told otherwise.
Texture makeTexture(GLenum target, GLenum format, int width, int height, int levels = 1);
Buffer makeBuffer(GLsizeiptr bytes, const void* data);
Renderbuffer makeRenderbuffer(GLenum format, int width, int height);

/// A framebuffer of one colour texture and, unless 0, a depth buffer.
Framebuffer makeFramebuffer(const Texture& color, GLuint depth = 0);

GLint getInteger(GLenum name);

/// Throws Error (missing) when GL has reported an error since last asked; `doing` says at what.
void checkGl(std::string_view doing);

} // namespace ibl
