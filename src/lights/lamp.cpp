#include "lights/lamp.h"

#include "core/error.h"
#include "lights/pixel_moments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace ibl {
namespace {

constexpr double kLeastContrast = 20;
constexpr double kSurroundings = 60 * kPi / 180; ///< radius
constexpr double kWidestLamp = 20 * kPi / 180;   ///< radius

struct Pixel {
    int x = 0;
    int y = 0;
};

Pixel brightestPixel(const Image& probe) {
    Pixel best;
    double most = -1;
    for (int y = 0; y < probe.height; ++y) {
        for (int x = 0; x < probe.width; ++x) {
            const double luminance = litLuminance(probe.at(x, y));
            if (luminance > most) {
                most = luminance;
                best = {x, y};
            }
        }
    }
    return best;
}

V3d centreOf(const Image& probe, Pixel p) {
    return latlongDirection((p.x + 0.5) / probe.width, (p.y + 0.5) / probe.height);
}

/// Median luminance by solid angle of the pixels near the peak, to an eighth of a stop. 0 where
/// most of them are black.
double surroundings(const Image& probe, Pixel peak) {
    constexpr int kSteps = 8, kOctaves = 300; // all floats, denormals too
    std::vector<double> weights(kSteps * kOctaves, 0.0);
    const V3d towards = centreOf(probe, peak);
    const double least_cosine = std::cos(kSurroundings);
    double total = 0;
    for (int y = 0; y < probe.height; ++y) {
        const double weight = latlongPixelSolidAngle(probe.width, probe.height, y);
        for (int x = 0; x < probe.width; ++x) {
            if (centreOf(probe, {x, y}).dot(towards) < least_cosine) continue;
            const double luminance = litLuminance(probe.at(x, y));
            const int step =
                luminance > 0
                    ? 1 + static_cast<int>(kSteps * (std::log2(luminance) + 0.5 * kOctaves))
                    : 0;
            weights[static_cast<std::size_t>(step)] += weight;
            total += weight;
        }
    }
    double below = 0;
    std::size_t step = 0;
    while (below + weights[step] < 0.5 * total)
        below += weights[step++];
    if (step == 0) return 0;
    return std::exp2((static_cast<double>(step) - 0.5) / kSteps - 0.5 * kOctaves);
}

/// The eight neighbours; beyond a pole lies the same row, half a turn away.
std::array<Pixel, 8> neighbours(const Image& probe, Pixel p) {
    std::array<Pixel, 8> around;
    std::size_t n = 0;
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            if (dx == 0 && dy == 0) continue;
            int x = p.x + dx, y = p.y + dy;
            if (y < 0 || y >= probe.height) {
                y = p.y;
                x += probe.width / 2;
            }
            around[n++] = {(x + 2 * probe.width) % probe.width, y};
        }
    }
    return around;
}

/// What each pixel is; a byte a pixel.
enum Part : std::uint8_t { kOutside, kCore, kRim, kAround };

struct Parts {
    std::vector<std::uint8_t> of;
    std::vector<Pixel> core, rim, around;
};

std::size_t indexOf(const Image& probe, Pixel p) {
    return static_cast<std::size_t>(p.y) * probe.width + p.x;
}

/// The pixels that touch `inner` and are outside; they become `part`.
std::vector<Pixel> ring(const Image& probe, const std::vector<Pixel>& inner, Part part,
                        std::vector<std::uint8_t>& of) {
    std::vector<Pixel> found;
    for (const Pixel p : inner) {
        for (const Pixel q : neighbours(probe, p)) {
            if (of[indexOf(probe, q)] != kOutside) continue;
            of[indexOf(probe, q)] = part;
            found.push_back(q);
        }
    }
    return found;
}

Parts partsAbout(const Image& probe, Pixel peak, double threshold) {
    Parts parts;
    parts.of.assign(static_cast<std::size_t>(probe.width) * probe.height, kOutside);
    parts.of[indexOf(probe, peak)] = kCore;
    parts.core.push_back(peak);
    for (std::size_t i = 0; i < parts.core.size(); ++i) {
        for (const Pixel q : neighbours(probe, parts.core[i])) {
            if (parts.of[indexOf(probe, q)] != kOutside) continue;
            if (litLuminance(probe.at(q.x, q.y)) <= threshold) continue;
            parts.of[indexOf(probe, q)] = kCore;
            parts.core.push_back(q);
        }
    }
    parts.rim = ring(probe, parts.core, kRim, parts.of);
    parts.around = ring(probe, parts.rim, kAround, parts.of);
    return parts;
}

/// Median of each channel, not below 0.
std::array<float, 3> medianColour(const Image& probe, const std::vector<Pixel>& pixels) {
    std::array<float, 3> colour{};
    std::vector<float> values(pixels.size());
    for (int c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < pixels.size(); ++i)
            values[i] = probe.at(pixels[i].x, pixels[i].y)[c];
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        colour[static_cast<std::size_t>(c)] = std::max(0.f, *middle);
    }
    return colour;
}

double solidAngle(const Image& probe, const std::vector<Pixel>& pixels) {
    double sum = 0;
    for (const Pixel p : pixels)
        sum += latlongPixelSolidAngle(probe.width, probe.height, p.y);
    return sum;
}

/// Solid angle of the core's pixels with at least half its mean luminance, sum y^2 w / sum y w.
double brightSolidAngle(const Image& probe, const std::vector<Pixel>& core) {
    double squares = 0, sum = 0;
    for (const Pixel p : core) {
        const double weight = latlongPixelSolidAngle(probe.width, probe.height, p.y);
        const double luminance = litLuminance(probe.at(p.x, p.y));
        squares += luminance * luminance * weight;
        sum += luminance * weight;
    }
    std::vector<Pixel> bright;
    std::copy_if(core.begin(), core.end(), std::back_inserter(bright),
                 [&](Pixel p) { return 2 * litLuminance(probe.at(p.x, p.y)) >= squares / sum; });
    return solidAngle(probe, bright);
}

/// Replaces the lamp's pixels and adds what they lose to the light.
Lamp takeOut(const Image& probe, const Parts& parts) {
    Lamp lamp{{}, probe};
    const std::array<float, 3> fill = medianColour(probe, parts.around);
    const ColumnMoments columns = columnMoments(probe.width);
    V3d moment(0);
    for (const std::vector<Pixel>* pixels : {&parts.core, &parts.rim}) {
        for (const Pixel p : *pixels) {
            const RowMoments row = rowMoments(probe.width, probe.height, p.y);
            float* rgb = lamp.residual.at(p.x, p.y);
            V3d lost(0);
            for (int c = 0; c < 3; ++c)
                lost[c] = double{rgb[c]} - fill[static_cast<std::size_t>(c)];
            std::copy(fill.begin(), fill.end(), rgb);
            lamp.light.irradiance += lost * row.solid_angle;
            const double luminance = std::max(0.0, luminanceOf(lost));
            const std::size_t x = static_cast<std::size_t>(p.x);
            moment += luminance * V3d(row.horizontal * columns.sine[x], row.vertical,
                                      row.horizontal * columns.cosine[x]);
        }
    }
    lamp.light.direction = moment.normalized();
    lamp.light.solid_angle = brightSolidAngle(probe, parts.core);
    // Of a disc: 2 pi (1 - cos r) = 4 pi sin^2(r / 2).
    lamp.light.angular_radius = 2 * std::asin(std::sqrt(lamp.light.solid_angle / (4 * kPi)));
    return lamp;
}

Error noLamp(std::string_view subject, const char* format, double value, double wanted) {
    char text[160];
    std::snprintf(text, sizeof text, format, value, wanted);
    return inputError(subject, std::string("no sun or lamp: ") + text + "; leave out --sun");
}

} // namespace

Lamp findLamp(const Image& latlong, std::string_view subject) {
    const Pixel peak = brightestPixel(latlong);
    const double most = litLuminance(latlong.at(peak.x, peak.y));
    if (most <= 0)
        throw inputError(subject, "no sun or lamp: no luminance above 0; leave out --sun");
    // The median is found to an eighth of a stop only, and nothing is brighter than the peak.
    const double around = std::min(most, surroundings(latlong, peak));
    if (most < kLeastContrast * around) {
        throw noLamp(subject, "the brightest pixel is %.3g times its surroundings, %g are needed",
                     most / around, kLeastContrast);
    }
    const Parts parts = partsAbout(latlong, peak, std::max(std::sqrt(most * around), most / 1000));
    const double radius =
        2 * std::asin(std::sqrt(std::min(1.0, solidAngle(latlong, parts.core) / (4 * kPi))));
    if (radius > kWidestLamp || parts.around.empty()) {
        throw noLamp(subject, "the brightest region is %.3g degrees in radius, more than %g",
                     radius * 180 / kPi, kWidestLamp * 180 / kPi);
    }
    return takeOut(latlong, parts);
}

} // namespace ibl
