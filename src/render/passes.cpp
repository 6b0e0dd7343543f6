#include "render/passes.h"

#include <algorithm>

namespace ibl {

Passes::Passes(std::optional<std::filesystem::path> shader_folder)
    : folder_(std::move(shader_folder)) {
    GLuint array = 0;
    glCreateVertexArrays(1, &array);
    no_vertices_ = VertexArray(array);
}

const Program& Passes::program(const std::vector<std::string_view>& files,
                               const std::vector<std::string>& definitions,
                               const std::string& source) {
    std::string key = source;
    for (const std::string_view file : files)
        key.append("\n").append(file);
    for (const std::string& definition : definitions)
        key.append("\n").append(definition);
    Program& program = programs_[key];
    if (!program) program = makeProgram({{"fullscreen.vert"}, files, definitions, source}, folder_);
    return program;
}

const Target& Passes::scratch(const V2i& size) {
    if (scratch_.size.x < size.x || scratch_.size.y < size.y) {
        scratch_ = makeTarget(
            {std::max(scratch_.size.x, size.x), std::max(scratch_.size.y, size.y)}, GL_RGBA32F);
    }
    return scratch_;
}

void Passes::draw(const Program& program, const Framebuffer& to, const PixelRect& part) const {
    glBindFramebuffer(GL_FRAMEBUFFER, to.id());
    glViewport(part.min.x, part.min.y, part.max.x - part.min.x, part.max.y - part.min.y);
    glUseProgram(program.id());
    glBindVertexArray(no_vertices_.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Passes::add(const Program& program, const Target& to) const {
    glBlendFunc(GL_ONE, GL_ONE);
    glEnable(GL_BLEND);
    draw(program, to);
    glDisable(GL_BLEND);
}

} // namespace ibl
