// Uniforms of GL programs, by name. Internal to the render layer; needs a current context.
#pragma once

#include "render/gl_objects.h"

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <span>

namespace ibl {

inline void setUniform(const Program& p, const char* name, const Imath::V3d& v) {
    const Imath::V3f f(v);
    glProgramUniform3f(p.id(), glGetUniformLocation(p.id(), name), f.x, f.y, f.z);
}
inline void setUniform(const Program& p, const char* name, const Imath::V2d& v) {
    glProgramUniform2f(p.id(), glGetUniformLocation(p.id(), name), static_cast<float>(v.x),
                       static_cast<float>(v.y));
}
inline void setUniform(const Program& p, const char* name, const Imath::V2i& v) {
    glProgramUniform2i(p.id(), glGetUniformLocation(p.id(), name), v.x, v.y);
}
inline void setUniform(const Program& p, const char* name, int v) {
    glProgramUniform1i(p.id(), glGetUniformLocation(p.id(), name), v);
}
inline void setUniform(const Program& p, const char* name, double v) {
    glProgramUniform1f(p.id(), glGetUniformLocation(p.id(), name), static_cast<float>(v));
}
/// Matrices multiply row vectors, as Imath has them, and column vectors in the shader.
inline void setUniform(const Program& p, const char* name, const Imath::M44d& m) {
    const Imath::M44f f(m);
    glProgramUniformMatrix4fv(p.id(), glGetUniformLocation(p.id(), name), 1, GL_FALSE, f[0]);
}
inline void setUniform(const Program& p, const char* name, const Imath::M33d& m) {
    const Imath::M33f f(m);
    glProgramUniformMatrix3fv(p.id(), glGetUniformLocation(p.id(), name), 1, GL_FALSE, f[0]);
}
inline void setUniform(const Program& p, const char* name, std::span<const float> v) {
    glProgramUniform1fv(p.id(), glGetUniformLocation(p.id(), name), static_cast<GLsizei>(v.size()),
                        v.data());
}

} // namespace ibl
