// Full-screen passes: a fragment shader over a rectangle of a target. Internal to the render layer.
#pragma once

#include "render/camera.h"
#include "render/frame_tiles.h"
#include "render/shader_program.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ibl {

class Passes {
public:
    explicit Passes(std::optional<std::filesystem::path> shader_folder);

    /// The program of these fragment shader files, made when first asked for. `source` as in
    /// ProgramParts.
    const Program& program(const std::vector<std::string_view>& files,
                           const std::vector<std::string>& definitions = {},
                           const std::string& source = {});

    /// A target of at least that size, for what one pass hands to the next.
    const Target& scratch(const V2i& size);

    /// Runs the program on every pixel of `part`.
    void draw(const Program& program, const Framebuffer& to, const PixelRect& part) const;
    /// The same on all of the target.
    void draw(const Program& program, const Target& to) const {
        draw(program, to.framebuffer, {{0, 0}, to.size});
    }
    /// The same, added to what is there.
    void add(const Program& program, const Target& to) const;

private:
    std::optional<std::filesystem::path> folder_;
    VertexArray no_vertices_;
    std::map<std::string, Program> programs_;
    Target scratch_;
};

} // namespace ibl
