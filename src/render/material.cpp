#include "render/material.h"

#include <algorithm>
#include <limits>

namespace ibl {
namespace {

constexpr double kNoLimit = std::numeric_limits<float>::max();

constexpr std::array<ParameterInfo, kParameters> kTable{{
    {Parameter::baseColor, "base-color", 3, 1, 0, kNoLimit, "Tint or albedo"},
    {Parameter::reflectivity, "reflectivity", 1, 0.5, 0, 1, "Part of the light that is mirrored"},
}};

constexpr auto kMirrorParameters = {Parameter::baseColor};
constexpr auto kMirrorDiffuseParameters = {Parameter::baseColor, Parameter::reflectivity};

constexpr std::array<ShaderInfo, 3> kShaders{{
    {Shader::mirror, "mirror", "mirror.frag",
     "base colour times the radiance along the reflected ray", true, false, kMirrorParameters},
    {Shader::diffuse, "diffuse", "diffuse.frag", "base colour times irradiance / pi", false, true,
     kMirrorParameters},
    {Shader::mirrorDiffuse, "mirror-diffuse", "mirror_diffuse.frag",
     "the two mixed by the reflectivity", true, true, kMirrorDiffuseParameters},
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

Material::Material(Shader s) : shader(s) {
    for (const ParameterInfo& info : kTable)
        (*this)[info.parameter] = V3d(info.standard);
}

} // namespace ibl
