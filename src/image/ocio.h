// A display and view of an OpenColorIO config, as a shader. By OpenColorIO, in a module of its own
// that is loaded when first needed (as OpenImageIO, see oiio.h).
#pragma once

#include "core/error.h"

#include <string>
#include <vector>

namespace ibl {

/// Which view; empty names mean the config's own standard.
struct DisplayView {
    std::string config; ///< file; "" is $OCIO or, without it, OpenColorIO's own ACES 1.0 SDR output
                        ///< transform for sRGB displays
    std::string space;  ///< colour space of the picture; "" is the role scene_linear
    std::string display;
    std::string view;
};

/// A table that the shader looks up.
struct ShaderLut {
    std::string sampler;                  ///< name of its sampler uniform
    int width = 0, height = 0, depth = 0; ///< depth 0: a plane; height 1 too: a line
    int channels = 3;                     ///< 1 or 3
    bool linear = true;                   ///< interpolation
    std::vector<float> values;            ///< depth * height * width * channels
};

/// GLSL that defines `vec4 ocioDisplay(vec4 scene_linear)`, from scene-linear straight colour to
/// the display's encoded values.
struct DisplayTransform {
    std::string glsl;
    std::vector<ShaderLut> luts;
    std::vector<std::string> files; ///< that were read: the config's, and what its view uses
};

/// Throws Error: usage when the config has no such space, display or view (naming those it has), or
/// there is no config to look them up in; input when it cannot be read or used; missing when the
/// module cannot be loaded.
DisplayTransform loadDisplayTransform(const DisplayView& view);

/// The module's boundary, as OiioModule: `done`, or the code and the text of an error.
using OcioLoad = ExitCode (*)(const DisplayView& view, DisplayTransform& transform,
                              std::string& error) noexcept;
constexpr const char* kOcioLoadName = "ibltoolOcioLoad";

} // namespace ibl
