#include "render/shader_program.h"

#include "core/error.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>

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
            return {path.string(), std::move(text)};
        }
    }
    const auto shaders = embeddedShaders();
    const auto found = std::find_if(shaders.begin(), shaders.end(),
                                    [&](const EmbeddedShader& s) { return s.name == name; });
    if (found == shaders.end()) throw inputError(name, "no such shader; check the shader folder");
    return {std::string(name), std::string(found->text)};
}

// Compilers report SOURCE:LINE(COLUMN) (Mesa) or SOURCE(LINE) (NVIDIA), with the number that #line
// gave the source. The first line that begins so, or else the first of all, is put as FILE:LINE.
Error compileError(const std::vector<SourceFile>& files, std::string_view log) {
    std::string_view first = log.substr(0, log.find('\n'));
    const auto digits = [](std::string_view text, std::size_t from) {
        std::size_t end = from;
        while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end])))
            ++end;
        return text.substr(from, end - from);
    };
    const std::string_view source = digits(first, 0);
    if (!source.empty() && source.size() < 4 && source.size() < first.size()) {
        const std::size_t index = std::stoul(std::string(source));
        const std::string_view line = digits(first, source.size() + 1);
        if (index < files.size() && !line.empty()) {
            const std::size_t colon = first.find(": ", source.size());
            const auto what = colon == first.npos ? first : first.substr(colon + 2);
            return inputError(files[index].name + ":" + std::string(line),
                              std::string(what) + "; correct the shader");
        }
    }
    return inputError(files.back().name, std::string(first) + "; correct the shader");
}

ShaderStage compile(GLenum stage, const std::vector<SourceFile>& files,
                    const std::vector<std::string>& definitions) {
    std::string text = "#version 450 core\n";
    for (const std::string& definition : definitions)
        text += "#define " + definition + "\n";
    for (std::size_t i = 0; i < files.size(); ++i) {
        text += "#line 1 " + std::to_string(i) + "\n" + files[i].text + "\n";
    }
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
        throw compileError(files, log);
    }
    return shader;
}

} // namespace

Program makeProgram(const ProgramParts& parts, const std::optional<std::filesystem::path>& folder) {
    std::vector<SourceFile> fragment_files;
    for (const std::string_view name : parts.fragment) {
        fragment_files.push_back(readShader(name, folder));
    }
    const ShaderStage vertex =
        compile(GL_VERTEX_SHADER, {readShader(parts.vertex, folder)}, parts.definitions);
    const ShaderStage fragment = compile(GL_FRAGMENT_SHADER, fragment_files, parts.definitions);

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
