#include "cli/render_options.h"

#include "core/error.h"

#include <filesystem>

namespace ibl {

void bindObject(CLI::App& app, ObjectArguments& arguments) {
    std::string objects;
    for (const std::string_view name : builtinObjectNames())
        objects += std::string(name) + ", ";
    app.add_option("--object", arguments.name, objects + "or an OBJ file")
        ->type_name("OBJECT")
        ->capture_default_str()
        ->group("Object");
}

Object objectOf(Session& session, const ObjectArguments& arguments) {
    const std::string& name = arguments.name;
    if (std::optional<Object> builtin = builtinObject(name)) return std::move(*builtin);
    std::error_code ignored;
    if (!std::filesystem::path(name).has_extension() && !std::filesystem::exists(name, ignored)) {
        std::string names;
        for (const std::string_view known : builtinObjectNames())
            names.append(" ").append(known);
        throw Error(ExitCode::usage, "--object " + name + ": no such object; there are" + names +
                                         ", or an OBJ file");
    }
    session.addInput(name);
    return {session.stage("mesh", [&] { return loadObj(name); })};
}

} // namespace ibl
