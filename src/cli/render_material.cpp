#include "cli/render_options.h"

#include "core/error.h"
#include "image/source.h"

#include <filesystem>

namespace ibl {
namespace {

/// The shaders that have a parameter: "mirror, diffuse".
std::string shadersWith(Parameter parameter) {
    std::string names;
    for (const ShaderInfo& row : shaderTable()) {
        if (!hasParameter(row.shader, parameter)) continue;
        names.append(names.empty() ? "" : ", ").append(row.name);
    }
    return names;
}

void bindParameter(CLI::App& app, const ParameterInfo& info, MaterialArguments& arguments,
                   FrameRange& frames) {
    char standard[64] = "";
    const V3d values = info.standards();
    if (info.step != 0) {
        std::snprintf(standard, sizeof standard, " (default %g,%g,%g)", values.x, values.y,
                      values.z);
    } else if (info.standard >= info.least) {
        std::snprintf(standard, sizeof standard, " (default %g)", info.standard);
    }
    std::string help = std::string(info.help) + ", of " + shadersWith(info.parameter) + standard;
    addRamps(
        app, "--" + std::string(info.name), info.components,
        [&arguments, &info](const std::vector<Ramp>& v) {
            auto& value = arguments.values[info.parameter];
            for (std::size_t i = 0; i < 3; ++i)
                value[i] = v[v.size() == 3 ? i : 0];
        },
        help, rampIn(info.least, info.most), frames)
        ->type_name(info.components == 3 ? "R,G,B" : "X")
        ->group("Material");
}

bool isShaderFile(const std::string& name) {
    return std::filesystem::path(name).extension() == ".frag";
}

std::string shaderNames() {
    std::string names;
    for (const ShaderInfo& row : shaderTable())
        names.append(row.name).append(", ");
    return names;
}

/// How the lobe is integrated; a method of its own only where there is a lobe.
SpecularMethod methodOf(const MaterialArguments& arguments, const Material& material) {
    const bool lobe = material.own ? mentions(material.own->text, "ggxIntegrals")
                                   : shaderInfo(material.shader).reads_specular;
    const auto require = [&](bool given, const char* option) {
        if (given && !lobe) {
            throw Error(ExitCode::usage,
                        std::string(option) + " is of the shader ggx; leave it out");
        }
    };
    require(arguments.samples.has_value(), "--samples-specular");
    require(arguments.multiscatter.has_value(), "--multiscatter");
    require(arguments.masking.has_value(), "--masking");
    SpecularMethod method;
    method.samples = arguments.samples.value_or(0);
    method.multiscatter = arguments.multiscatter.value_or(method.samples == 0);
    method.masking = arguments.masking.value_or(Masking::correlated);
    return method;
}

void bindMethod(CLI::App& app, MaterialArguments& arguments) {
    app.add_option("--samples-specular", arguments.samples,
                   "Integrate the lobe of ggx as the eye sees it by so many samples, each an area "
                   "of the probe, instead of by split sum")
        ->check(inRange(1, 65536))
        ->type_name("N")
        ->group("Material");
    app.add_option_function<std::string>(
           "--multiscatter",
           [&arguments](const std::string& text) { arguments.multiscatter = text == "on"; },
           "Give back the light that single scattering loses between microfacets: on (default) or "
           "off (default with --samples-specular)")
        ->check(CLI::IsMember({"on", "off"}))
        ->type_name("on|off")
        ->group("Material");
    app.add_option_function<std::string>(
           "--masking",
           [&arguments](const std::string& text) {
               arguments.masking = text == "separable" ? Masking::separable : Masking::correlated;
           },
           "Smith's masking and shadowing, of ggx: correlated (default) or separable")
        ->check(CLI::IsMember({"correlated", "separable"}))
        ->type_name("NAME")
        ->group("Material");
    app.add_option_function<std::string>(
           "--interpolation",
           [&arguments](const std::string& text) {
               arguments.interpolation = text == "flat"      ? Interpolation::flat
                                         : text == "gouraud" ? Interpolation::gouraud
                                                             : Interpolation::phong;
           },
           "Between a mesh's vertices: phong (default) interpolates normals, gouraud colours, flat "
           "nothing")
        ->check(CLI::IsMember({"phong", "gouraud", "flat"}))
        ->type_name("NAME")
        ->group("Material");
}

} // namespace

void bindMaterial(CLI::App& app, MaterialArguments& arguments, FrameRange& frames) {
    app.add_option("--shader", arguments.shader,
                   "Material of the object: " + shaderNames() +
                       "or a fragment shader FILE.frag (default mirror); from lambert on they "
                       "are lit by --lights, the others by the probe")
        ->check(CLI::Validator(
            [](const std::string& name) {
                if (shaderFromName(name) || isShaderFile(name)) return std::string();
                return "'" + name + "' is none of " + shaderNames() + "nor a FILE.frag";
            },
            ""))
        ->type_name("NAME")
        ->group("Material");
    bindMethod(app, arguments);
    for (const ParameterInfo& info : parameterTable())
        bindParameter(app, info, arguments, frames);
}

std::optional<ShaderText> ownShader(Session& session, const MaterialArguments& arguments) {
    if (!isShaderFile(arguments.shader)) return std::nullopt;
    session.addInput(arguments.shader);
    Source source = openSource(arguments.shader);
    readWhole(source);
    ShaderText own{arguments.shader, std::string(source.bytes.begin(), source.bytes.end())};
    if (!mentions(own.text, "shade")) {
        throw inputError(own.name, "defines no vec3 shade(vec3 normal, vec3 incident); add it");
    }
    return own;
}

Material materialOf(const MaterialArguments& arguments, const std::optional<ShaderText>& own,
                    const FramePlace& place) {
    Material material(shaderFromName(arguments.shader).value_or(Shader::mirror));
    material.own = own;
    for (const auto& [parameter, value] : arguments.values) {
        if (!hasParameter(material, parameter)) {
            throw Error(ExitCode::usage,
                        "--" + std::string(parameterInfo(parameter).name) + ": " +
                            (material.own
                                 ? material.own->name + " has no uniform " + uniformName(parameter)
                                 : "--shader " + arguments.shader + " does not have it, but " +
                                       shadersWith(parameter)) +
                            "; leave it out");
        }
        for (const Ramp& ramp : value)
            material.fixed = material.fixed && !ramp.moves();
        material[parameter] = V3d(value[0].at(place), value[1].at(place), value[2].at(place));
    }
    if (arguments.shader == "coat" && arguments.values.contains(Parameter::fresnel) &&
        arguments.values.contains(Parameter::ior)) {
        throw Error(ExitCode::usage, "--ior: coat refracts nothing, and --fresnel says how much it "
                                     "mirrors; leave one of them out");
    }
    material.specular = methodOf(arguments, material);
    return material;
}

void overrideSurfaces(const MaterialArguments& arguments, Object& object) {
    for (const auto& [parameter, value] : arguments.values) {
        const std::string_view name = parameterInfo(parameter).name;
        for (Part& part : object.parts) {
            if (name == "metallic") part.surface.metallic.reset();
            if (name == "roughness") part.surface.roughness.reset();
        }
    }
}

bool surfacesVary(const Object& object) {
    return std::ranges::any_of(object.parts, [](const Part& part) {
        return part.surface.metallic || part.surface.roughness ||
               part.surface.metallic_roughness_texture;
    });
}

} // namespace ibl
