#include "render/gl_objects.h"

#include "core/error.h"

#include <array>
#include <cstdio>
#include <string>

namespace ibl {

Texture makeTexture(GLenum target, GLenum format, int width, int height, int levels) {
    GLuint id = 0;
    glCreateTextures(target, 1, &id);
    Texture texture(id);
    glTextureStorage2D(id, levels, format, width, height);
    glTextureParameteri(id, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(id, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return texture;
}

Buffer makeBuffer(GLsizeiptr bytes, const void* data) {
    GLuint id = 0;
    glCreateBuffers(1, &id);
    Buffer buffer(id);
    glNamedBufferStorage(id, bytes, data, 0);
    return buffer;
}

Renderbuffer makeRenderbuffer(GLenum format, int width, int height) {
    GLuint id = 0;
    glCreateRenderbuffers(1, &id);
    Renderbuffer buffer(id);
    glNamedRenderbufferStorage(id, format, width, height);
    return buffer;
}

Framebuffer makeFramebuffer(const Texture& color, GLuint depth) {
    GLuint id = 0;
    glCreateFramebuffers(1, &id);
    Framebuffer framebuffer(id);
    glNamedFramebufferTexture(id, GL_COLOR_ATTACHMENT0, color.id(), 0);
    if (depth) {
        glNamedFramebufferRenderbuffer(id, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
    }
    checkGl("making a frame buffer");
    if (glCheckNamedFramebufferStatus(id, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        throw Error(ExitCode::missing,
                    "OpenGL: this device cannot draw into float pixels; use the software device");
    }
    return framebuffer;
}

GLint getInteger(GLenum name) {
    std::array<GLint, 4> value{};
    glGetIntegerv(name, value.data());
    return value[0];
}

void checkGl(std::string_view doing) {
    const GLenum error = glGetError();
    if (error == GL_NO_ERROR) return;
    if (error == GL_OUT_OF_MEMORY) {
        throw Error(ExitCode::missing, "OpenGL: out of memory while " + std::string(doing) +
                                           "; ask for a smaller frame, probe or object");
    }
    std::array<char, 16> code{};
    std::snprintf(code.data(), code.size(), "0x%04x", error);
    throw Error(ExitCode::missing, "OpenGL: error " + std::string(code.data()) + " while " +
                                       std::string(doing) + "; use another device");
}

} // namespace ibl
