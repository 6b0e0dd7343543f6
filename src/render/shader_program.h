// GL programs from the shader files. Internal to the render layer.
#pragma once

#include "render/gl_objects.h"
#include "render/material.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ibl {

/// A file of the shader folder as it was when the program was built.
struct EmbeddedShader {
    std::string_view name;
    std::string_view text;
};
std::span<const EmbeddedShader> embeddedShaders();

/// What a program is made of: vertex and fragment shader as files that follow one another,
/// preprocessor definitions ("NAME value") ahead of all, and source text that is in no file,
/// between definitions and fragment shader. `own` is a file's text that is neither in the folder
/// nor embedded; the lists have it by its name.
struct ProgramParts {
    std::vector<std::string_view> vertex;
    std::vector<std::string_view> fragment;
    std::vector<std::string> definitions;
    std::string source;
    std::optional<ShaderText> own = std::nullopt;
};

/// Compiles and links. A file that stands in `folder` replaces the embedded one of its name.
/// Throws Error (input) naming file and line where the compiler stopped.
Program makeProgram(const ProgramParts& parts, const std::optional<std::filesystem::path>& folder);

} // namespace ibl
