// Materials of render: a row for each shader, and one for each parameter that a shader may have.
#pragma once

#include "convolve/split_sum.h"

#include <Imath/ImathVec.h>

#include <array>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
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
    glass,         ///< F L(r) + (1 - F) c L(t): L(t) through both faces
    dispersion,    ///< the same with an index for each channel
    coat,          ///< F L(r) + (1 - F) c E(n) / pi: F of a clear, smooth coat
    ggx,           ///< metallic-roughness: microfacets over a Lambertian base
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
    roughness,
    metallic,
    ior,
    iorRgb,
    fresnel,
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
constexpr std::size_t kParameters = 21;

/// A parameter of shaders: the option `--name` and, with underscores, the uniform.
struct ParameterInfo {
    Parameter parameter;
    std::string_view name;
    int components;     ///< 1, or 3 of a colour
    double standard;    ///< below `least`: none, the shader has another way
    double least, most; ///< of each component
    std::string_view help;
    double step = 0; ///< of three components the standards are standard - step, standard, + step

    V3d standards() const { return {standard - step, standard, standard + step}; }
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
    bool lit = false;            ///< by the scene's lights; the file defines a BRDF
    bool reads_specular = false; ///< GGX chain and split-sum table, or the probe's levels
    bool sees_far_side = false;  ///< depth and normals of the faces that look away from the eye
};
std::span<const ShaderInfo> shaderTable();
const ShaderInfo& shaderInfo(Shader shader);
std::optional<Shader> shaderFromName(std::string_view name);
bool hasParameter(Shader shader, Parameter parameter);

/// How `ggx` is integrated.
struct SpecularMethod {
    /// 0: split sum (Karis 2013). Otherwise the lobe as it is seen from the eye, by so many
    /// samples, each an area of the probe.
    int samples = 0;
    /// Energy that single scattering loses between microfacets is given back, in the lobe's shape
    /// (Turquin 2019).
    bool multiscatter = true;
    Masking masking = Masking::correlated;
};

/// A user's own fragment shader instead of a row of the table. It has the parameters whose uniforms
/// it names, and reads the maps whose functions it names.
struct ShaderText {
    std::string name; ///< for messages
    std::string text;
};

/// A shader and the values of all parameters, those that it does not have included.
struct Material {
    explicit Material(Shader shader = Shader::mirror); ///< with the standard values

    /// Three components; of a scalar, the first counts.
    V3d& operator[](Parameter p) { return values[static_cast<std::size_t>(p)]; }
    const V3d& operator[](Parameter p) const { return values[static_cast<std::size_t>(p)]; }

    Shader shader;
    std::array<V3d, kParameters> values;
    SpecularMethod specular;
    std::optional<ShaderText> own; ///< `shader` does not count then
    /// False where parameters change from frame to frame or from part to part: maps are needed for
    /// all their values, then.
    bool fixed = true;
};
bool hasParameter(const Material& material, Parameter parameter);
/// Whether a GLSL text has that identifier.
bool mentions(std::string_view text, std::string_view identifier);
/// `--name`'s uniform: underscores for hyphens.
std::string uniformName(Parameter parameter);

} // namespace ibl
