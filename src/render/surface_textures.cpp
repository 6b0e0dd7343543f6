#include "render/surface_textures.h"

#include "core/error.h"
#include "render/uniforms.h"

#include <algorithm>
#include <bit>

namespace ibl {
namespace {

// Texture units of surface.glsl.
constexpr GLuint kBaseUnit = 12, kMetallicRoughnessUnit = 13, kNormalUnit = 14, kEmissiveUnit = 15,
                 kAlphaUnit = 20;

GLint wrapOf(Wrap wrap) {
    return wrap == Wrap::clamp    ? GL_CLAMP_TO_EDGE
           : wrap == Wrap::mirror ? GL_MIRRORED_REPEAT
                                  : GL_REPEAT;
}

Texture uploadTexture(const SurfaceTexture& source) {
    const Image& image = source.image;
    const int side = std::max(image.width, image.height);
    if (side > getInteger(GL_MAX_TEXTURE_SIZE)) {
        throw inputError("texture", "a side of " + std::to_string(side) +
                                        " pixels is more than this graphics device takes; shrink "
                                        "it");
    }
    GLuint id = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &id);
    Texture texture(id);
    const int levels = std::bit_width(static_cast<unsigned>(side));
    glTextureStorage2D(id, levels, GL_RGBA32F, image.width, image.height);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage2D(id, 0, 0, 0, image.width, image.height,
                        image.channels == 4 ? GL_RGBA : GL_RGB, GL_FLOAT, image.pixels.data());
    glGenerateTextureMipmap(id);
    glTextureParameteri(id, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(id, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTextureParameteri(id, GL_TEXTURE_WRAP_S, wrapOf(source.across));
    glTextureParameteri(id, GL_TEXTURE_WRAP_T, wrapOf(source.down));
    checkGl("uploading a texture");
    return texture;
}

Texture oneTexel(float r, float g, float b) {
    SurfaceTexture texel{Image(1, 1, 4), Wrap::repeat, Wrap::repeat};
    const float values[] = {r, g, b, 1};
    std::copy_n(values, 4, texel.image.at(0, 0));
    return uploadTexture(texel);
}

// The part's own value of a parameter of the shader, otherwise the material's.
void setParameter(const Program& program, const Material& material, std::string_view name,
                  const std::optional<double>& own) {
    for (const ParameterInfo& info : parameterTable()) {
        if (info.name != name || !hasParameter(material, info.parameter)) continue;
        setUniform(program, std::string(name).c_str(), own.value_or(material[info.parameter].x));
    }
}

} // namespace

SurfaceTextures uploadSurfaces(const Object& object) {
    SurfaceTextures result;
    for (const SurfaceTexture& texture : object.textures)
        result.textures.push_back({uploadTexture(texture), texture.premultiplied});
    result.white = oneTexel(1, 1, 1);
    result.flat = oneTexel(0.5F, 0.5F, 1);
    const auto define = [&](std::optional<std::size_t> Surface::*texture, const char* name) {
        const bool used = std::ranges::any_of(
            object.parts, [&](const Part& part) { return (part.surface.*texture).has_value(); });
        if (used) result.definitions.emplace_back(std::string(name) + " 1");
    };
    define(&Surface::base_texture, "BASE_TEXTURE");
    define(&Surface::metallic_roughness_texture, "METALLIC_ROUGHNESS_TEXTURE");
    define(&Surface::normal_texture, "NORMAL_TEXTURE");
    define(&Surface::emissive_texture, "EMISSIVE_TEXTURE");
    define(&Surface::alpha_texture, "ALPHA_TEXTURE");
    const bool cut_outs = std::ranges::any_of(
        object.parts, [](const Part& part) { return part.surface.alpha_cutoff != 0; });
    result.definitions.emplace_back(cut_outs ? "CUT_OUTS 1" : "CUT_OUTS 0");
    return result;
}

void bindSurface(const SurfaceTextures& textures, const Program& program, const Material& material,
                 const Surface& surface) {
    const auto bind = [&](GLuint unit, const std::optional<std::size_t>& index,
                          const Texture& otherwise) {
        glBindTextureUnit(unit, index ? textures.textures[*index].texture.id() : otherwise.id());
    };
    bind(kBaseUnit, surface.base_texture, textures.white);
    bind(kMetallicRoughnessUnit, surface.metallic_roughness_texture, textures.white);
    bind(kNormalUnit, surface.normal_texture, textures.flat);
    bind(kEmissiveUnit, surface.emissive_texture, textures.white);
    bind(kAlphaUnit, surface.alpha_texture, textures.white);
    const bool premultiplied =
        surface.base_texture && textures.textures[*surface.base_texture].premultiplied;
    setUniform(program, "base_premultiplied", premultiplied ? 1.0 : 0.0);
    setUniform(program, "part_color", surface.base_color);
    setUniform(program, "part_emission", surface.emissive);
    setUniform(program, "part_alpha", surface.alpha);
    setUniform(program, "alpha_cutoff", surface.alpha_cutoff);
    setUniform(program, "normal_scale", surface.normal_scale);
    setParameter(program, material, "metallic", surface.metallic);
    setParameter(program, material, "roughness", surface.roughness);
}

} // namespace ibl
