#include "image/map_label.h"

#include <cstdio>

namespace ibl {

std::string describe(const MapLabel& label) {
    if (label.kernel.empty()) return "unlabelled";
    std::string text = label.kernel;
    const auto add = [&text](const char* name, float value) {
        char number[48];
        std::snprintf(number, sizeof number, ", %s %.6g", name, static_cast<double>(value));
        text += number;
    };
    if (label.roughness) add("roughness", *label.roughness);
    if (label.exponent) add("exponent", *label.exponent);
    if (label.levels > 0) {
        text += ", level " + std::to_string(label.level) + " of 0 to " +
                std::to_string(label.levels - 1);
    }
    return text;
}

} // namespace ibl
