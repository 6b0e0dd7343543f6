#include "cli/sh_json.h"

#include <nlohmann/json.hpp>

namespace ibl {
namespace {

using Json = nlohmann::ordered_json;

struct Words {
    const char* name;
    const char* units;
    const char* basis;
};

Words wordsOf(ShConvention convention) {
    const char* orthonormal = "real, orthonormal, index l^2 + l + m, Y(1,-1) = +0.4886 y, "
                              "Y(1,0) = 0.4886 z, Y(1,1) = 0.4886 x";
    switch (convention) {
    case ShConvention::radiance:
        return {"radiance", "radiance", orthonormal};
    case ShConvention::irradiance:
        return {"irradiance", "irradiance (pi for a constant probe of 1)", orthonormal};
    case ShConvention::filament:
        break;
    }
    return {"filament", "irradiance / pi (1 for a constant probe of 1)",
            "1, y, z, x, x y, y z, 3 z^2 - 1, x z, x^2 - y^2"};
}

} // namespace

std::string shJson(const ShCoefficients& coefficients, const std::string& source, bool windowed,
                   double lambda) {
    const Words words = wordsOf(coefficients.convention);
    Json root;
    root["axes"] =
        "right-handed, +Y up; a lat-long's centre looks along +Z, +X stands at a quarter "
        "of its width";
    root["units"] = words.units;
    root["basis"] = words.basis;
    root["source"] = source;
    root["convention"] = words.name;
    root["order"] = coefficients.order;
    if (windowed) {
        root["window"] = {{"weights", "1 / (1 + lambda l^2 (l + 1)^2)"}, {"lambda", lambda}};
    } else {
        root["window"] = "none";
    }
    root["coefficients"] = coefficients.values;
    return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace ibl
