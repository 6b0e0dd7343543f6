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

CLI::Validator inRange(const ParameterInfo& info) {
    return CLI::Validator(
        [&info](const std::string& text) {
            double value = 0;
            if (CLI::detail::lexical_cast(text, value) && value >= info.least && value <= info.most)
                return std::string();
            char range[64];
            std::snprintf(range, sizeof range, "%g to %g", info.least, info.most);
            return "'" + text + "' is not a number from " + range;
        },
        "");
}

void bindParameter(CLI::App& app, const ParameterInfo& info, MaterialArguments& arguments) {
    char standard[64];
    std::snprintf(standard, sizeof standard, " (default %g)", info.standard);
    std::string help = std::string(info.help) + ", of " + shadersWith(info.parameter) + standard;
    app.add_option_function<std::vector<double>>(
           "--" + std::string(info.name),
           [&arguments, &info](const std::vector<double>& v) {
               arguments.values[info.parameter] = v.size() == 3 ? V3d(v[0], v[1], v[2]) : V3d(v[0]);
           },
           help)
        ->delimiter(',')
        ->expected(info.components)
        ->check(inRange(info))
        ->type_name(info.components == 3 ? "R,G,B" : "X")
        ->group("Material");
}

} // namespace

void bindMaterial(CLI::App& app, MaterialArguments& arguments) {
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
        bindParameter(app, info, arguments);
}

Material materialOf(const MaterialArguments& arguments) {
    Material material(arguments.shader);
    for (const auto& [parameter, value] : arguments.values) {
        if (!hasParameter(arguments.shader, parameter)) {
            throw Error(ExitCode::usage, "--" + std::string(parameterInfo(parameter).name) +
                                             " is of the shaders " + shadersWith(parameter) +
                                             "; leave it out");
        }
        material[parameter] = value;
    }
    return material;
}

} // namespace ibl
