// What a convolved map says of itself in its file.
#pragma once

#include <optional>
#include <string>

namespace ibl {

/// In OpenEXR files the attributes ibl.kernel (string), ibl.roughness, ibl.exponent (float),
/// ibl.level and ibl.levels (int) of the header; other formats hold none of it. What reads maps can
/// so tell a level of a chain from one that an earlier, longer chain has left beside it.
struct MapLabel {
    std::string kernel;             ///< "lambert", "ggx", ...; "" where the file does not say
    std::optional<float> roughness; ///< perceptual
    std::optional<float> exponent;
    int level = 0;
    int levels = 0; ///< of the chain; 0: the map is of none

    bool operator==(const MapLabel&) const = default;
};

/// In words: "ggx, roughness 0.25, level 2 of 0 to 8"; "unlabelled" without a kernel.
std::string describe(const MapLabel& label);

} // namespace ibl
