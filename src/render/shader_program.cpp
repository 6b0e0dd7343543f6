#include "render/shader_program.h"

#include "core/error.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

namespace ibl {
namespace {

struct SourceFile {
    std::string name; // as shown in messages
    std::string text;
};

SourceFile readShader(std::string_view name, const std::optional<std::filesystem::path>& folder) {
    if (folder) {
        const std::filesystem::path path = *folder / name;
        if (std::filesystem::exists(path)) {
            std::ifstream file(path);
            std::string text{std::istreambuf_iterator<char>(file), {}};
            if (!file) throw inputError(path.string(), "cannot be read; check its permissions");
            return {path.string(), std::move(text) + "\n"};
        }
    }
    const auto shaders = embeddedShaders();
    const auto found = std::find_if(shaders.begin(), shaders.end(),
                                    [&](const EmbeddedShader& s) { return s.name == name; });
    if (found == shaders.end()) throw inputError(name, "no such shader; check the shader folder");
    return {std::string(name), std::string(found->text)};
}

std::size_t lineCount(std::string_view text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

// Compilers report 0:LINE(COLUMN) (Mesa) or 0(LINE) (NVIDIA), the line in all that they were given,
// which begins with `prelude` lines and goes on with the files. (#line with a source number would
// say it directly, but Mesa drops the number.) What a user's own file leaves open is found in a
// file after it.
Error compileError(const std::vector<SourceFile>& files, const std::string& own,
                   std::size_t prelude, std::string_view log) {
    const std::string_view first = log.substr(0, log.find('\n'));
    std::size_t line = 0;
    char separator = 0;
    std::istringstream place{std::string(first)};
    if (int source = 0; place >> source >> separator >> line && line > prelude) {
        line -= prelude;
        const std::size_t colon = first.find(": ");
        const std::string what(colon == first.npos ? first : first.substr(colon + 2));
        std::size_t own_lines = 0;
        for (const SourceFile& file : files) {
            const std::size_t count = lineCount(file.text);
            if (line <= count) {
                if (own_lines > 0) {
                    return inputError(own + ":" + std::to_string(own_lines),
                                      what + ", in what follows it; close what it leaves open");
                }
                return inputError(file.name + ":" + std::to_string(line),
                                  what + "; correct the shader");
            }
            if (file.name == own) own_lines = count - 1; // one was added
            line -= count;
        }
    }
    return inputError(files.back().name, std::string(first) + "; correct the shader");
}

ShaderStage compile(GLenum stage, const std::vector<SourceFile>& files, const std::string& own,
                    const std::vector<std::string>& definitions) {
    std::string text = "#version 450 core\n";
    for (const std::string& definition : definitions)
        text += "#define " + definition + "\n";
    const std::size_t prelude = lineCount(text);
    for (const SourceFile& file : files)
        text += file.text;
    ShaderStage shader(glCreateShader(stage));
    const char* pointer = text.c_str();
    glShaderSource(shader.id(), 1, &pointer, nullptr);
    glCompileShader(shader.id());
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader.id(), GL_COMPILE_STATUS, &compiled);
    if (!compiled) {
        std::string log(4096, '\0');
        GLsizei length = 0;
        glGetShaderInfoLog(shader.id(), static_cast<GLsizei>(log.size()), &length, log.data());
        log.resize(static_cast<std::size_t>(length));
        throw compileError(files, own, prelude, log);
    }
    return shader;
}

} // namespace

Program makeProgram(const ProgramParts& parts, const std::optional<std::filesystem::path>& folder) {
    const auto read = [&](std::string_view name) -> SourceFile {
        if (parts.own && parts.own->name == name) return {parts.own->name, parts.own->text + "\n"};
        return readShader(name, folder);
    };
    std::vector<SourceFile> vertex_files, fragment_files;
    for (const std::string_view name : parts.vertex)
        vertex_files.push_back(read(name));
    if (!parts.source.empty()) fragment_files.push_back({"generated source", parts.source});
    for (const std::string_view name : parts.fragment)
        fragment_files.push_back(read(name));
    const std::string own = parts.own ? parts.own->name : "";
    const ShaderStage vertex = compile(GL_VERTEX_SHADER, vertex_files, own, parts.definitions);
    const ShaderStage fragment =
        compile(GL_FRAGMENT_SHADER, fragment_files, own, parts.definitions);

    Program program(glCreateProgram());
    glAttachShader(program.id(), vertex.id());
    glAttachShader(program.id(), fragment.id());
    glLinkProgram(program.id());
    GLint linked = GL_FALSE;
    glGetProgramiv(program.id(), GL_LINK_STATUS, &linked);
    if (!linked) {
        std::string log(4096, '\0');
        GLsizei length = 0;
        glGetProgramInfoLog(program.id(), static_cast<GLsizei>(log.size()), &length, log.data());
        log.resize(static_cast<std::size_t>(length));
        throw inputError(fragment_files.back().name,
                         log.substr(0, log.find('\n')) + "; correct the shader");
    }
    return program;
}

} // namespace ibl
