// The tone maps by name: one table, from which the command line, its help and the tests are made.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

namespace ibl {

/// Curves from exposed radiance x >= 0 to display light; negative values count as 0, except that
/// `none` keeps them. p.NAME are the parameters of the table.
enum class ToneMap {
    none,          ///< x
    clamp,         ///< min(x, 1)
    exponential,   ///< 1 - exp(-p.rate x) (Hin Jang)
    scurve,        ///< x^n / (x^n + sigma^n) (Naka and Rushton 1966)
    reinhard,      ///< x (1 + x / white^2) / (1 + x) (Reinhard et al. 2002, eq. 4)
    reinhardLocal, ///< x / (1 + V), V the largest surround without contrast (the same, eq. 5 to 9)
    retinex,       ///< multi-scale Retinex (Rahman, Jobson and Woodell 1996)
    filmic,        ///< Hable's curve (2010): f(2 x) / f(white)
    aces,          ///< Hill's fit of the ACES reference and sRGB output transforms
    display,       ///< a view of an OpenColorIO config; display-encoded
};

/// What a curve is applied to: each channel, or the luminance, by which the colour is scaled.
enum class Per { channel, luminance };

struct ToneParameter {
    std::string_view name; ///< of the option, without dashes
    double standard;
    double least, most;
    std::string_view summary;
    bool whole = false; ///< a whole number
};
constexpr std::size_t kToneParameters = 6;
using ToneParameters = std::array<double, kToneParameters>;

struct ToneMapInfo {
    ToneMap map;
    std::string_view name;
    std::string_view curve;    ///< GLSL function of one value; "" where `function` is the whole map
    std::string_view function; ///< GLSL function of a colour
    std::string_view file;     ///< of the shader folder, beside tone_maps.glsl; "" none
    Per per;                   ///< unless asked otherwise, which only curves can be
    std::string_view summary;
    std::span<const ToneParameter> parameters;
};

std::span<const ToneMapInfo> toneMapTable();
const ToneMapInfo& toneMapInfo(ToneMap map);
std::optional<ToneMap> toneMapFromName(std::string_view name);
/// The table's standard values, in its order; the rest 0.
ToneParameters standardParameters(ToneMap map);

} // namespace ibl
