// Materials of render: a row for each shader, and one for each parameter that a shader may have.
#pragma once

#include <Imath/ImathVec.h>

#include <array>
#include <initializer_list>
#include <optional>
#include <span>
#include <string_view>

namespace ibl {

using Imath::V3d;
using Imath::V3f;

/// How the surface answers the light. L is the probe's radiance, E its irradiance, n the normal, r
/// the reflected ray, c the base colour, k the reflectivity.
enum class Shader {
    mirror,        ///< c L(r)
    diffuse,       ///< c E(n) / pi: c is the albedo
    mirrorDiffuse, ///< (1 - k) c E(n) / pi + k L(r)
    // Under lights, by the BRDFs of their files.
    lambert,
    phong,
    blinnPhong,
    orenNayar,
    cookTorrance,
    ward,
    ashikhminShirley,
    lafortune,
    schlickFresnel,
};

enum class Parameter {
    baseColor,
    reflectivity,
    ambient,
    specularColor,
    f0,
    exponent,
    exponentU,
    exponentV,
    sigma,
    slope,
    alphaU,
    alphaV,
    lobeX,
    lobeY,
    lobeZ,
    facetRoughness,
};
constexpr std::size_t kParameters = 16;

/// A parameter of shaders: the option `--name` and, with underscores, the uniform.
struct ParameterInfo {
    Parameter parameter;
    std::string_view name;
    int components; ///< 1, or 3 of a colour
    double standard;
    double least, most; ///< of each component
    std::string_view help;
};
std::span<const ParameterInfo, kParameters> parameterTable();
const ParameterInfo& parameterInfo(Parameter parameter);

/// A row for each shader: its name to users, what it does, which maps it reads, its parameters.
struct ShaderInfo {
    Shader shader;
    std::string_view name;
    std::string_view file; ///< in the shader folder
    std::string_view summary;
    bool reads_probe;
    bool reads_diffuse;
    std::initializer_list<Parameter> parameters;
    bool lit = false; ///< by the scene's lights; the file defines a BRDF
};
std::span<const ShaderInfo> shaderTable();
const ShaderInfo& shaderInfo(Shader shader);
std::optional<Shader> shaderFromName(std::string_view name);
bool hasParameter(Shader shader, Parameter parameter);

/// A shader and the values of all parameters, those that it does not have included.
struct Material {
    explicit Material(Shader shader = Shader::mirror); ///< with the standard values

    /// Three components; of a scalar, the first counts.
    V3d& operator[](Parameter p) { return values[static_cast<std::size_t>(p)]; }
    const V3d& operator[](Parameter p) const { return values[static_cast<std::size_t>(p)]; }

    Shader shader;
    std::array<V3d, kParameters> values;
};

} // namespace ibl
