#include "render/surface_program.h"

#include "render/uniforms.h"

#include <algorithm>
#include <array>

namespace ibl {
namespace {

/// Set whoever declares them.
constexpr std::array<std::string_view, 5> kAlwaysSet{"eye", "clip_from_world", "clip_from_object",
                                                     "world_from_object", "object_extent"};
/// Bound if the program has the functions that read them.
constexpr std::array<std::string_view, 4> kMaps{"specular_levels", "split_sum", "probe_levels",
                                                "far_side"};

/// Whether a declaration of uniforms in the text has the name.
bool declaresUniform(std::string_view text, std::string_view name) {
    constexpr std::string_view keyword = "uniform";
    for (std::size_t at = text.find(keyword); at != text.npos; at = text.find(keyword, at + 1)) {
        const std::string_view declaration = text.substr(at, text.find(';', at) - at);
        if (mentions(declaration, keyword) && mentions(declaration, name)) return true;
    }
    return false;
}

bool ownMentions(const Material& material, std::string_view identifier) {
    return material.own && mentions(material.own->text, identifier);
}

std::vector<std::string> kindDefinitions(const SurfaceKind& kind) {
    std::vector<std::string> definitions;
    if (!kind.is_mesh) definitions.emplace_back("OBJECT_IS_SPHERE");
    if (kind.interpolation == Interpolation::flat) definitions.emplace_back("FLAT_NORMALS");
    return definitions;
}

/// The files up to that which defines shade().
std::vector<std::string_view> shadingFiles(const Material& material, Interpolation interpolation) {
    const MapNeeds needs = mapNeeds(material);
    std::vector<std::string_view> files{"lookup.glsl", "maps.glsl", "surface.glsl"};
    if (hasParameter(material, Parameter::fresnel)) files.push_back("fresnel.glsl");
    if (needs.far_side) files.push_back("refraction.glsl");
    if (needs.specular || needs.split_sum) files.push_back("specular.glsl");
    if (needs.probe_levels) {
        files.push_back("ggx_sampled.glsl");
    } else if (needs.specular && needs.split_sum) {
        files.push_back("ggx_split_sum.glsl");
    }
    if (material.own) {
        files.push_back(material.own->name);
    } else {
        const ShaderInfo& info = shaderInfo(material.shader);
        if (info.lit && interpolation == Interpolation::gouraud) {
            const auto lit = litFiles(material.shader);
            files.insert(files.end(), lit.begin(), lit.end());
            files.push_back("lit_vertices.glsl");
        } else {
            files.push_back(info.lit ? "lit_points.glsl" : info.file);
        }
    }
    return files;
}

/// The stages around them.
ProgramParts around(std::vector<std::string_view> shading, const SurfaceKind& kind,
                    std::vector<std::string> definitions, std::optional<ShaderText> own) {
    for (std::string& d : kindDefinitions(kind))
        definitions.push_back(std::move(d));
    ProgramParts parts{{}, {}, std::move(definitions), {}, std::move(own)};
    if (kind.interpolation == Interpolation::gouraud) {
        // A normal's texture has no slope at a vertex.
        std::erase_if(parts.definitions,
                      [](const std::string& d) { return d.starts_with("NORMAL_TEXTURE"); });
        parts.vertex = std::move(shading);
        parts.vertex.push_back("gouraud.vert");
        parts.fragment = {"coverage.glsl", "gouraud.frag"};
        return parts;
    }
    parts.vertex = {kind.is_mesh ? "mesh.vert" : "fullscreen.vert"};
    parts.fragment = std::move(shading);
    parts.fragment.insert(parts.fragment.begin(), {"view.glsl", "coverage.glsl"});
    if (kind.is_mesh) {
        parts.fragment.insert(parts.fragment.end(), {"mesh_normal.glsl", "mesh_surface.frag"});
    } else {
        parts.fragment.push_back("sphere_surface.frag");
    }
    return parts;
}

} // namespace

std::vector<std::string_view> litFiles(Shader shader) {
    return {"light_blocks.glsl", "lights.glsl", "tangent.glsl", shaderInfo(shader).file,
            "lit_radiance.glsl"};
}

MapNeeds mapNeeds(const Material& material) {
    MapNeeds needs;
    bool lobe = false;
    if (material.own) {
        lobe = ownMentions(material, "ggxIntegrals");
        needs.probe = ownMentions(material, "probeRadiance");
        needs.diffuse = ownMentions(material, "diffuseRadiance");
        needs.specular = ownMentions(material, "specularRadiance");
        needs.split_sum = ownMentions(material, "splitSum");
        needs.far_side = ownMentions(material, "throughObject");
    } else {
        const ShaderInfo& info = shaderInfo(material.shader);
        const bool covered =
            material.fixed &&
            ((info.shader == Shader::ggx && material[Parameter::metallic].x == 1) ||
             (info.shader == Shader::mirrorDiffuse && material[Parameter::reflectivity].x == 1));
        lobe = info.reads_specular;
        needs.probe = info.reads_probe;
        needs.diffuse = info.reads_diffuse && !covered;
        needs.far_side = info.sees_far_side;
    }
    if (lobe && material.specular.samples > 0) {
        needs.probe_levels = true;
    } else if (lobe) {
        needs.specular = needs.split_sum = true;
    }
    return needs;
}

ProgramParts surfaceParts(const Material& material, const SurfaceKind& kind,
                          std::vector<std::string> definitions) {
    const SpecularMethod& method = material.specular;
    const auto truth = [](bool value) { return value ? "true" : "false"; };
    definitions.push_back("SPECULAR_SAMPLES " + std::to_string(method.samples));
    definitions.push_back(std::string("MULTISCATTER ") + truth(method.multiscatter));
    definitions.push_back(std::string("SEPARABLE_MASKING ") +
                          truth(method.masking == Masking::separable));
    return around(shadingFiles(material, kind.interpolation), kind, std::move(definitions),
                  material.own);
}

ProgramParts aovParts(const SurfaceKind& kind, std::vector<std::string> definitions) {
    const Interpolation normals =
        kind.interpolation == Interpolation::flat ? Interpolation::flat : Interpolation::phong;
    return around({"lookup.glsl", "maps.glsl", "surface.glsl", "aov.frag"}, {kind.is_mesh, normals},
                  std::move(definitions), std::nullopt);
}

ProgramParts farSideParts(const SurfaceKind& kind, std::vector<std::string> definitions) {
    for (std::string& d : kindDefinitions(kind))
        definitions.push_back(std::move(d));
    return {{"mesh.vert"},
            {"view.glsl", "coverage.glsl", "surface.glsl", "mesh_normal.glsl", "far_side.frag"},
            std::move(definitions),
            {}};
}

void setMaterial(const Program& program, const Material& material) {
    for (const ParameterInfo& info : parameterTable()) {
        const std::string uniform = uniformName(info.parameter);
        const V3d& value = material[info.parameter];
        if (info.components == 3) {
            setUniform(program, uniform.c_str(), value);
        } else {
            setUniform(program, uniform.c_str(), value.x);
        }
    }
}

std::vector<std::string> unsetUniforms(const Program& program, const ShaderText& own) {
    const auto isSet = [](std::string_view name) {
        return std::ranges::count(kAlwaysSet, name) + std::ranges::count(kMaps, name) > 0 ||
               std::ranges::any_of(parameterTable(), [&](const ParameterInfo& info) {
                   return uniformName(info.parameter) == name;
               });
    };
    std::vector<std::string> unset;
    GLint count = 0;
    glGetProgramiv(program.id(), GL_ACTIVE_UNIFORMS, &count);
    for (GLint i = 0; i < count; ++i) {
        std::array<char, 256> text{};
        GLint size = 0;
        GLenum type = 0;
        glGetActiveUniform(program.id(), static_cast<GLuint>(i), text.size(), nullptr, &size, &type,
                           text.data());
        std::string name(text.data());
        name.resize(std::min(name.find_first_of("[."), name.size())); // of an array, a structure
        const bool known = std::ranges::count(unset, name) > 0;
        if (!known && !isSet(name) && declaresUniform(own.text, name)) unset.push_back(name);
    }
    std::ranges::sort(unset);
    return unset;
}

} // namespace ibl
