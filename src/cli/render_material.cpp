#include "cli/render_options.h"

#include "core/error.h"

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
    char standard[64];
    std::snprintf(standard, sizeof standard, " (default %g)", info.standard);
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

} // namespace

void bindMaterial(CLI::App& app, MaterialArguments& arguments, FrameRange& frames) {
    std::vector<std::string> shaders;
    for (const ShaderInfo& row : shaderTable())
        shaders.emplace_back(row.name);
    app.add_option_function<std::string>(
           "--shader",
           [&arguments](const std::string& n) { arguments.shader = *shaderFromName(n); },
           "Material of the object (default mirror)")
        ->check(CLI::IsMember(shaders))
        ->type_name("NAME")
        ->group("Material");
    for (const ParameterInfo& info : parameterTable())
        bindParameter(app, info, arguments, frames);
}

Material materialOf(const MaterialArguments& arguments, const FramePlace& place) {
    Material material(arguments.shader);
    for (const auto& [parameter, value] : arguments.values) {
        if (!hasParameter(arguments.shader, parameter)) {
            throw Error(ExitCode::usage, "--" + std::string(parameterInfo(parameter).name) +
                                             " is of the shaders " + shadersWith(parameter) +
                                             "; leave it out");
        }
        material[parameter] = V3d(value[0].at(place), value[1].at(place), value[2].at(place));
    }
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

} // namespace ibl
