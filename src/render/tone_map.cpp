#include "render/tone_map.h"

#include <algorithm>

namespace ibl {
namespace {

constexpr std::array kExponential{
    ToneParameter{"rate", 1, 1e-3, 1e3, "Of exponential: c in 1 - exp(-c x)"}};
constexpr std::array kScurve{
    ToneParameter{"scurve-n", 1.1, 0.01, 20, "Of scurve: its steepness n"},
    ToneParameter{"scurve-sigma", 0.72, 1e-3, 1e6, "Of scurve: sigma, which becomes 0.5"}};
constexpr ToneParameter kWhite{"white", 1e6, 0.1, 1e6,
                               "Of reinhard and filmic: the exposed value that becomes 1 (default "
                               "1e6, none to speak of; filmic 11.2)"};
constexpr std::array kReinhard{kWhite};
constexpr std::array kReinhardLocal{
    ToneParameter{"phi", 8, 0, 16, "Of reinhard-local: sharpness of the edges it keeps apart"},
    ToneParameter{"local-contrast", 0.05, 1e-4, 10,
                  "Of reinhard-local: contrast at which a surround ends"}};
constexpr std::array kRetinex{
    ToneParameter{"retinex-k", 0.5, 0, 1, "Of retinex: share of the surround that is divided out"},
    ToneParameter{"retinex-f", 1, 0, 8, "Of retinex: scale n of N weighs (N - n)^f, narrowest 0"},
    ToneParameter{"retinex-eps", 1e-3, 1e-6, 1, "Of retinex: added ahead of logarithms"},
    ToneParameter{"retinex-scales", 3, 1, 8, "Of retinex: number of surrounds", true},
    ToneParameter{"retinex-narrow", 0.02, 0.001, 1,
                  "Of retinex: narrowest surround's deviation over the picture's height"},
    ToneParameter{"retinex-wide", 0.25, 0.001, 1, "Of retinex: the widest one's"}};
constexpr std::array kFilmic{
    ToneParameter{kWhite.name, 11.2, kWhite.least, kWhite.most, kWhite.summary}};

constexpr std::array<ToneMapInfo, 10> kToneMaps{{
    {ToneMap::none, "none", "", "noTone", "", Per::channel, "linear; PNG clips at 1", {}},
    {ToneMap::clamp, "clamp", "", "clampTone", "", Per::channel, "clipped to 0 and 1", {}},
    {ToneMap::exponential, "exponential", "exponentialCurve", "", "", Per::channel, "1 - exp(-c x)",
     kExponential},
    {ToneMap::scurve, "scurve", "scurveCurve", "", "", Per::channel, "x^n / (x^n + sigma^n)",
     kScurve},
    {ToneMap::reinhard, "reinhard", "reinhardCurve", "", "", Per::luminance,
     "x (1 + x / white^2) / (1 + x)", kReinhard},
    {ToneMap::reinhardLocal, "reinhard-local", "", "reinhardLocalTone", "reinhard_local.glsl",
     Per::luminance, "the same with dodging and burning", kReinhardLocal},
    {ToneMap::retinex, "retinex", "", "retinexTone", "retinex.glsl", Per::channel,
     "multi-scale Retinex", kRetinex},
    {ToneMap::filmic, "filmic", "filmicCurve", "", "", Per::channel, "Hable's curve", kFilmic},
    {ToneMap::aces,
     "aces",
     "",
     "acesTone",
     "",
     Per::channel,
     "a fit of the ACES output transform",
     {}},
    {ToneMap::display,
     "display",
     "",
     "displayTone",
     "ocio_display.glsl",
     Per::channel,
     "a view of an OpenColorIO config",
     {}},
}};

} // namespace

std::span<const ToneMapInfo> toneMapTable() {
    return kToneMaps;
}

const ToneMapInfo& toneMapInfo(ToneMap map) {
    return *std::find_if(kToneMaps.begin(), kToneMaps.end(),
                         [&](const ToneMapInfo& info) { return info.map == map; });
}

std::optional<ToneMap> toneMapFromName(std::string_view name) {
    for (const ToneMapInfo& info : kToneMaps) {
        if (info.name == name) return info.map;
    }
    return std::nullopt;
}

ToneParameters standardParameters(ToneMap map) {
    ToneParameters values{};
    std::size_t i = 0;
    for (const ToneParameter& parameter : toneMapInfo(map).parameters)
        values[i++] = parameter.standard;
    return values;
}

} // namespace ibl
