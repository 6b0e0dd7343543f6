// The programs that shade an object, put together from its material. Internal to the render layer.
#pragma once

#include "render/scene.h"
#include "render/shader_program.h"

namespace ibl {

/// What a surface program is made for.
struct SurfaceKind {
    bool is_mesh; ///< otherwise the sphere
    Interpolation interpolation;
};

/// What draws the object; `definitions` are those of its maps and textures.
ProgramParts surfaceParts(const Material& material, const SurfaceKind& kind,
                          std::vector<std::string> definitions);
/// The files that define litRadiance() of a lit shader.
std::vector<std::string_view> litFiles(Shader shader);
/// What draws normals, depth and parts.
ProgramParts aovParts(const SurfaceKind& kind, std::vector<std::string> definitions);
/// What draws the far side of a mesh for refraction.
ProgramParts farSideParts(const SurfaceKind& kind, std::vector<std::string> definitions);

/// The uniforms of all parameters that the program has.
void setMaterial(const Program& program, const Material& material);

/// The uniforms that a user's own text declares, that the program has and that nothing sets, in
/// alphabetical order.
std::vector<std::string> unsetUniforms(const Program& program, const ShaderText& own);

} // namespace ibl
