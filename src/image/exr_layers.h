// Which channels of an OpenEXR file are meant by a layer's name.
#pragma once

#include <OpenEXR/ImfHeader.h>

#include <string>
#include <vector>

namespace ibl {

enum class ExrColour {
    rgb,
    luminance,       ///< Y alone
    luminanceChroma, ///< Y, and RY and BY at a quarter of the resolution
};

struct ExrChoice {
    int part = 0;
    std::string prefix; ///< before R, G, B, ...: "" or "layer."
    ExrColour colour = ExrColour::rgb;
    bool alpha = false; ///< there is prefix + "A"
};

/// The names that chooseExrLayer takes, in the file's order: "diffuse" for channels diffuse.R ...,
/// a part's name for a part beyond the first that has R, G and B (or Y) themselves.
std::vector<std::string> exrLayers(const std::vector<Imf::Header>& parts);

/// Finds the channels of a layer: "" is the first flat part with R, G, B (or Y) that are in no
/// layer. Throws inputError if there is none, naming those there are; deep parts are refused.
ExrChoice chooseExrLayer(const std::vector<Imf::Header>& parts, const std::string& layer,
                         const std::string& file_name);

} // namespace ibl
