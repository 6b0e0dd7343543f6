#include "render/material.h"

#include <algorithm>
#include <cctype>
#include <limits>

namespace ibl {
namespace {

constexpr double kNoLimit = std::numeric_limits<float>::max();

constexpr std::array<ParameterInfo, kParameters> kTable{{
    {Parameter::baseColor, "base-color", 3, 1, 0, kNoLimit, "Tint or albedo"},
    {Parameter::reflectivity, "reflectivity", 1, 0.5, 0, 1, "Part of the light that is mirrored"},
    {Parameter::ambient, "ambient", 3, 0, 0, kNoLimit,
     "Radiance from all sides beside the lights, reflected by the base colour"},
    {Parameter::specularColor, "specular-color", 3, 1, 0, 1, "Tint of the lobe"},
    {Parameter::f0, "f0", 3, 0.04, 0, 1, "Reflectance at normal incidence"},
    {Parameter::exponent, "exponent", 1, 50, 1, 1e5, "Of the lobe's cosine"},
    {Parameter::exponentU, "exponent-u", 1, 20, 1, 1e5, "Of the lobe around the vertical axis"},
    {Parameter::exponentV, "exponent-v", 1, 200, 1, 1e5, "Of the lobe along the vertical"},
    {Parameter::sigma, "sigma", 1, 25, 0, 90, "Deviation of the facets' slopes, degrees"},
    {Parameter::slope, "slope", 1, 0.25, 0.02, 2, "Root mean square slope of the facets"},
    {Parameter::alphaU, "alpha-u", 1, 0.4, 0.01, 2, "Width of the lobe around the vertical axis"},
    {Parameter::alphaV, "alpha-v", 1, 0.1, 0.01, 2, "Width of the lobe along the vertical"},
    {Parameter::lobeX, "lobe-x", 1, -1, -1, 1, "The lobe's factor around the vertical axis"},
    {Parameter::lobeY, "lobe-y", 1, -1, -1, 1, "The lobe's factor along the vertical"},
    {Parameter::lobeZ, "lobe-z", 1, 1, 0, 1, "The lobe's factor along the normal"},
    {Parameter::facetRoughness, "facet-roughness", 1, 0.1, 0.001, 1, "Schlick's r"},
    {Parameter::roughness, "roughness", 1, 0.5, 0, 1, "Roughness, alpha its square"},
    {Parameter::metallic, "metallic", 1, 0, 0, 1, "Part that is metal"},
    {Parameter::ior, "ior", 1, 1.5, 1, 4, "Index of refraction"},
    {Parameter::iorRgb, "ior-rgb", 3, 1.5, 1, 4, "Index of refraction of each channel", 0.04},
    {Parameter::fresnel, "fresnel", 3, -1, 0, 100,
     "Reflectance as BIAS,SCALE,POWER, bias + scale (1 - n.v)^power, not from the index"},
}};

constexpr auto kMirrorParameters = {Parameter::baseColor};
constexpr auto kMirrorDiffuseParameters = {Parameter::baseColor, Parameter::reflectivity};
constexpr auto kLambertParameters = {Parameter::baseColor, Parameter::ambient};
constexpr auto kPhongParameters = {Parameter::baseColor, Parameter::specularColor,
                                   Parameter::reflectivity, Parameter::exponent,
                                   Parameter::ambient};
constexpr auto kOrenNayarParameters = {Parameter::baseColor, Parameter::sigma, Parameter::ambient};
constexpr auto kCookTorranceParameters = {Parameter::baseColor, Parameter::f0,
                                          Parameter::reflectivity, Parameter::slope,
                                          Parameter::ambient};
constexpr auto kWardParameters = {Parameter::baseColor,    Parameter::specularColor,
                                  Parameter::reflectivity, Parameter::alphaU,
                                  Parameter::alphaV,       Parameter::ambient};
constexpr auto kAshikhminShirleyParameters = {Parameter::baseColor, Parameter::f0,
                                              Parameter::exponentU, Parameter::exponentV,
                                              Parameter::ambient};
constexpr auto kLafortuneParameters = {
    Parameter::baseColor, Parameter::specularColor, Parameter::reflectivity, Parameter::exponent,
    Parameter::lobeX,     Parameter::lobeY,         Parameter::lobeZ,        Parameter::ambient};
constexpr auto kSchlickParameters = {Parameter::baseColor, Parameter::f0, Parameter::facetRoughness,
                                     Parameter::ambient};

constexpr auto kGlassParameters = {Parameter::baseColor, Parameter::ior, Parameter::fresnel};
constexpr auto kDispersionParameters = {Parameter::baseColor, Parameter::iorRgb,
                                        Parameter::fresnel};
constexpr auto kGgxParameters = {Parameter::baseColor, Parameter::roughness, Parameter::metallic,
                                 Parameter::ior};

constexpr std::array<ShaderInfo, 16> kShaders{{
    {Shader::mirror, "mirror", "mirror.frag",
     "base colour times the radiance along the reflected ray", true, false, kMirrorParameters},
    {Shader::diffuse, "diffuse", "diffuse.frag", "base colour times irradiance / pi", false, true,
     kMirrorParameters},
    {Shader::mirrorDiffuse, "mirror-diffuse", "mirror_diffuse.frag",
     "the two mixed by the reflectivity", true, true, kMirrorDiffuseParameters},
    {Shader::glass, "glass", "glass.frag",
     "clear, refracting where light enters and where it leaves, mirroring by Fresnel", true, false,
     kGlassParameters, false, false, true},
    {Shader::dispersion, "dispersion", "dispersion.frag",
     "glass with an index of refraction for each channel", true, false, kDispersionParameters,
     false, false, true},
    {Shader::coat, "coat", "coat.frag", "diffuse under a clear coat that mirrors by Fresnel", true,
     true, kGlassParameters},
    {Shader::ggx, "ggx", "ggx.frag", "metal or dielectric of some roughness", false, true,
     kGgxParameters, false, true},
    {Shader::lambert, "lambert", "lambert.frag", "under lights: diffuse", false, false,
     kLambertParameters, true},
    {Shader::phong, "phong", "phong.frag", "under lights: a lobe about the mirrored light", false,
     false, kPhongParameters, true},
    {Shader::blinnPhong, "blinn-phong", "blinn_phong.frag",
     "under lights: a lobe about the halfway vector", false, false, kPhongParameters, true},
    {Shader::orenNayar, "oren-nayar", "oren_nayar.frag", "under lights: rough diffuse facets",
     false, false, kOrenNayarParameters, true},
    {Shader::cookTorrance, "cook-torrance", "cook_torrance.frag", "under lights: mirroring facets",
     false, false, kCookTorranceParameters, true},
    {Shader::ward, "ward", "ward.frag", "under lights: brushed", false, false, kWardParameters,
     true},
    {Shader::ashikhminShirley, "ashikhmin-shirley", "ashikhmin_shirley.frag",
     "under lights: brushed, over a diffuse base", false, false, kAshikhminShirleyParameters, true},
    {Shader::lafortune, "lafortune", "lafortune.frag",
     "under lights: a lobe that may lean or shine back", false, false, kLafortuneParameters, true},
    {Shader::schlickFresnel, "schlick-fresnel", "schlick_fresnel.frag",
     "under lights: Schlick's approximations", false, false, kSchlickParameters, true},
}};

} // namespace

std::span<const ParameterInfo, kParameters> parameterTable() {
    return kTable;
}

const ParameterInfo& parameterInfo(Parameter parameter) {
    return *std::ranges::find(kTable, parameter, &ParameterInfo::parameter);
}

std::span<const ShaderInfo> shaderTable() {
    return kShaders;
}

const ShaderInfo& shaderInfo(Shader shader) {
    return *std::ranges::find(kShaders, shader, &ShaderInfo::shader);
}

std::optional<Shader> shaderFromName(std::string_view name) {
    const auto row = std::ranges::find(kShaders, name, &ShaderInfo::name);
    return row == kShaders.end() ? std::nullopt : std::optional(row->shader);
}

bool hasParameter(Shader shader, Parameter parameter) {
    const auto& of_shader = shaderInfo(shader).parameters;
    return std::ranges::find(of_shader, parameter) != of_shader.end();
}

bool mentions(std::string_view text, std::string_view identifier) {
    const auto isPart = [&](std::size_t at) {
        return at < text.size() &&
               (std::isalnum(static_cast<unsigned char>(text[at])) || text[at] == '_');
    };
    for (std::size_t at = text.find(identifier); at != text.npos;
         at = text.find(identifier, at + 1)) {
        if ((at == 0 || !isPart(at - 1)) && !isPart(at + identifier.size())) return true;
    }
    return false;
}

bool hasParameter(const Material& material, Parameter parameter) {
    if (!material.own) return hasParameter(material.shader, parameter);
    const auto named = [&](std::string_view name) { return mentions(material.own->text, name); };
    if (named(uniformName(parameter))) return true;
    if (parameter == Parameter::baseColor) return named("baseColor");
    return parameter == Parameter::fresnel && // whose uniform is that of functions
           (named("surfaceReflectance") || named("throughObject") || named("firstReflectance"));
}

std::string uniformName(Parameter parameter) {
    std::string name(parameterInfo(parameter).name);
    std::ranges::replace(name, '-', '_');
    return name;
}

Material::Material(Shader s) : shader(s) {
    for (const ParameterInfo& info : kTable)
        (*this)[info.parameter] = info.standards();
}

} // namespace ibl
