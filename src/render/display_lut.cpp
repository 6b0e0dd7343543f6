#include "render/display_lut.h"

namespace ibl {

std::vector<DisplayLut> uploadLuts(const DisplayTransform& transform) {
    std::vector<DisplayLut> luts;
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    for (const ShaderLut& lut : transform.luts) {
        const GLenum target = lut.depth > 0    ? GL_TEXTURE_3D
                              : lut.height > 1 ? GL_TEXTURE_2D
                                               : GL_TEXTURE_1D;
        const GLenum format = lut.channels == 1 ? GL_R32F : GL_RGB32F;
        const GLenum pixels = lut.channels == 1 ? GL_RED : GL_RGB;
        GLuint id = 0;
        glCreateTextures(target, 1, &id);
        luts.push_back({lut.sampler, Texture(id)});
        if (lut.depth > 0) {
            glTextureStorage3D(id, 1, format, lut.width, lut.height, lut.depth);
            glTextureSubImage3D(id, 0, 0, 0, 0, lut.width, lut.height, lut.depth, pixels, GL_FLOAT,
                                lut.values.data());
        } else if (lut.height == 1) {
            glTextureStorage1D(id, 1, format, lut.width);
            glTextureSubImage1D(id, 0, 0, lut.width, pixels, GL_FLOAT, lut.values.data());
        } else {
            glTextureStorage2D(id, 1, format, lut.width, lut.height);
            glTextureSubImage2D(id, 0, 0, 0, lut.width, lut.height, pixels, GL_FLOAT,
                                lut.values.data());
        }
        const GLint filter = lut.linear ? GL_LINEAR : GL_NEAREST;
        glTextureParameteri(id, GL_TEXTURE_MIN_FILTER, filter);
        glTextureParameteri(id, GL_TEXTURE_MAG_FILTER, filter);
        for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
            glTextureParameteri(id, wrap, GL_CLAMP_TO_EDGE);
    }
    checkGl("uploading the display transform");
    return luts;
}

void bindLuts(const std::vector<DisplayLut>& luts, const Program& program, GLuint first_unit) {
    GLuint unit = first_unit;
    for (const DisplayLut& lut : luts) {
        glBindTextureUnit(unit, lut.texture.id());
        glProgramUniform1i(program.id(), glGetUniformLocation(program.id(), lut.sampler.c_str()),
                           static_cast<GLint>(unit));
        ++unit;
    }
}

} // namespace ibl
