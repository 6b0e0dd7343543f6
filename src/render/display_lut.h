// Look-up tables of a display transform on the device. Internal to the render layer.
#pragma once

#include "image/ocio.h"
#include "render/gl_objects.h"

#include <string>
#include <vector>

namespace ibl {

struct DisplayLut {
    std::string sampler;
    Texture texture;
};

std::vector<DisplayLut> uploadLuts(const DisplayTransform& transform);
/// Binds them to texture units from `first_unit` and tells the program.
void bindLuts(const std::vector<DisplayLut>& luts, const Program& program, GLuint first_unit);

} // namespace ibl
