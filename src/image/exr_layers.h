// Which channels of an OpenEXR file are meant by a layer's name.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <string>
#include <vector>

namespace ibl {

enum class ExrColour {
    rgb,
    vector,          ///< X, Y, Z: no colour, read as if it were
    luminance,       ///< Y alone
    luminanceChroma, ///< Y, and RY and BY at a quarter of the resolution
    grey,            ///< one channel of any other name
};

struct ExrChoice {
    int part = 0;
    std::string prefix; ///< before the channels' own names: "" or "layer."
    ExrColour colour = ExrColour::rgb;
    std::vector<std::string> channels; ///< full names: three, or one; with chroma, luminance's
    bool alpha = false;                ///< there is prefix + "A" beside R, G, B or Y
};

/// What a layer may be named, in the file's order: "diffuse" for channels diffuse.R .G .B (or .Y),
/// "normal" for normal.X .Y .Z (or .x .y .z), "depth" for depth.Z, if that is its only channel; a
/// part's name for what has no layer in it; and the full names of channels in none of these. (So
/// Blender and Nuke name them; R, G, B, Y and Z are OpenEXR's.)
std::vector<std::string> exrLayers(const std::vector<Imf::Header>& parts);

/// Finds the channels of a layer: "" is the first flat part with R, G, B (or Y) that are in no
/// layer. Beyond exrLayers, any channel's full name is taken, as grey, with its part's name and a
/// dot before it if need be. Throws inputError if there is none, naming those there are; deep parts
/// are refused.
ExrChoice chooseExrLayer(const std::vector<Imf::Header>& parts, const std::string& layer,
                         const std::string& file_name);

} // namespace ibl
