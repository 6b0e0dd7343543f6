#include "panorama/builtin.h"

#include "panorama/conventions.h"

#include "core/error.h"
#include "core/parallel.h"

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace ibl {
namespace {

constexpr std::string_view kPrefix = "builtin:";

void set(float* pixel, const V3d& value) {
    for (int c = 0; c < 3; ++c)
        pixel[c] = static_cast<float>(value[c]);
}

// The sky: luminance by the CIE standard general sky (CIE S 011/ISO 15469), type 12, "clear, low
// turbidity": proportional to (1 + a exp(b / cos Z)) (1 + c (exp(d chi) - exp(d pi/2)) + e cos^2
// chi), with Z the angle from the zenith and chi that from the sun. The standard knows no colour:
// ours goes from blue overhead to pale at the horizon and about the sun.
constexpr double kA = -1, kB = -0.32, kC = 10, kD = -3, kE = 0.45;
constexpr double kZenithRadiance = 0.15;
constexpr std::array<double, 3> kBlue{0.45, 0.95, 2.0}, kPale{1.05, 1.05, 1.1};
// The sun: its true angular radius, and the radiance above the atmosphere of a midday in these
// units (1e5 times the sky's, as in nature), 40 degrees up and 30 degrees from +Z towards +X.
constexpr double kSunRadius = 0.2666 * kPi / 180;
constexpr std::array<double, 3> kSunRadiance{30000, 27500, 23000};
constexpr double kSunElevation = 40 * kPi / 180, kSunAzimuth = 30 * kPi / 180;
// The ground: about a fifth of the light that falls on it; a chequered floor whose squares are as
// wide as the probe stands high, so that reflections show which way they go. The contrast is lost
// where a pixel sees much of a square.
constexpr std::array<double, 3> kGround{0.13, 0.12, 0.1};
constexpr double kChequer = 0.35;

V3d vector(const std::array<double, 3>& v) {
    return {v[0], v[1], v[2]};
}

V3d sunDirection() {
    return {std::cos(kSunElevation) * std::sin(kSunAzimuth), std::sin(kSunElevation),
            std::cos(kSunElevation) * std::cos(kSunAzimuth)};
}

/// The sky along one parallel, as a function of the angle from the sun.
struct SkyRow {
    double gradation;
    double horizon_haze;

    explicit SkyRow(double cos_zenith)
        : gradation(kZenithRadiance * (1 + kA * std::exp(kB / std::max(cos_zenith, 1e-3))) /
                    (1 + kA * std::exp(kB))),
          horizon_haze(std::pow(1 - cos_zenith, 4)) {}

    V3d radiance(double cos_chi) const {
        const double fading = std::exp(kD * std::acos(std::clamp(cos_chi, -1.0, 1.0)));
        const double scattering =
            1 + kC * (fading - std::exp(kD * kPi / 2)) + kE * cos_chi * cos_chi;
        const double haze = std::max(horizon_haze, fading);
        return (vector(kBlue) * (1 - haze) + vector(kPale) * haze) * (gradation * scattering);
    }
};

/// Adds the disc to the pixels it covers, with the energy of the true disc at any resolution:
/// points of equal share, evenly over its solid angle (a sunflower's spiral, Vogel 1979), some
/// hundred for each pixel that it covers.
void addSun(Image& image) {
    const V3d sun = sunDirection();
    const V3d right = V3d(0, 1, 0).cross(sun).normalized(), up = sun.cross(right);
    const double pixels = 1 + kSunRadius * image.height / kPi;
    const int points = static_cast<int>(1024 * pixels * pixels);
    const double golden_angle = kPi * (3 - std::sqrt(5.0));
    const double solid_angle = 4 * kPi * std::pow(std::sin(0.5 * kSunRadius), 2);
    const V3d share = vector(kSunRadiance) * (solid_angle / points);
    for (int point = 0; point < points; ++point) {
        const double radius = kSunRadius * std::sqrt((point + 0.5) / points);
        const double angle = golden_angle * point;
        const V3d d = sun * std::cos(radius) +
                      (right * std::cos(angle) + up * std::sin(angle)) * std::sin(radius);
        const V2d p = latlongPoint(d);
        const int x = std::min(static_cast<int>(p.x * image.width), image.width - 1);
        const int y = std::min(static_cast<int>(p.y * image.height), image.height - 1);
        const double pixel = latlongPixelSolidAngle(image.width, image.height, y);
        for (int c = 0; c < 3; ++c)
            image.at(x, y)[c] += static_cast<float>(share[c] / pixel);
    }
}

/// Radiance of the floor below a direction with d.y < 0, of which a pixel sees `pitch` radians.
V3d groundRadiance(const V3d& d, double pitch) {
    const double x = d.x / -d.y, z = d.z / -d.y;
    const double blur = kPi * pitch * (1 + x * x + z * z); // of the pattern's phase, radians
    const auto wave = [&](double at) {
        const double s = std::sin(kPi * at);
        return s / std::sqrt(s * s + blur * blur);
    };
    return vector(kGround) * (1 + kChequer * wave(x) * wave(z));
}

/// Rows are as they are at their centres, but for one that the horizon cuts, which is half of each.
void sky(Image& image, int threads) {
    const V3d sun = sunDirection();
    std::vector<double> cos_from_sun(static_cast<std::size_t>(image.width));
    for (int x = 0; x < image.width; ++x) {
        const double phi = 2 * kPi * (0.5 - (x + 0.5) / image.width);
        cos_from_sun[static_cast<std::size_t>(x)] = std::cos(phi - kSunAzimuth);
    }
    parallelFor(static_cast<std::size_t>(image.height), threads, [&](std::size_t row) {
        const int y = static_cast<int>(row);
        const double theta = kPi * (y + 0.5) / image.height;
        const double cos_zenith = std::max(0.0, std::cos(theta));
        const double along = std::cos(kSunElevation) * std::sin(theta), up = sun.y * cos_zenith;
        const bool cut = 2 * y + 1 == image.height, ground = 2 * y + 1 > image.height;
        const SkyRow sky_row(cos_zenith);
        for (int x = 0; x < image.width; ++x) {
            V3d value = vector(kGround);
            if (ground) {
                const V3d below = latlongDirection((x + 0.5) / image.width, theta / kPi);
                value = groundRadiance(below, kPi / image.height);
            } else {
                const double cos_chi = along * cos_from_sun[static_cast<std::size_t>(x)] + up;
                const V3d above = sky_row.radiance(cos_chi);
                value = cut ? (above + value) * 0.5 : above;
            }
            set(image.at(x, y), value);
        }
    });
    addSun(image);
}

// The compass: glyphs of 5 x 7 cells, a row a number, the leftmost cell the highest bit.
using Glyph = std::array<unsigned char, 7>;
constexpr Glyph kPlus{0b00000, 0b00100, 0b00100, 0b11111, 0b00100, 0b00100, 0b00000};
constexpr Glyph kMinus{0b00000, 0b00000, 0b00000, 0b11111, 0b00000, 0b00000, 0b00000};
constexpr std::array<Glyph, 3> kLetters{{
    {0b10001, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001, 0b10001},
    {0b10001, 0b10001, 0b01010, 0b00100, 0b00100, 0b00100, 0b00100},
    {0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b10000, 0b11111},
}};
constexpr double kCell = 0.1; ///< of a glyph, where a face spans 2
/// +X red, +Y green, +Z blue; the negative directions in the colours opposite.
constexpr std::array<std::array<double, 3>, 6> kColours{{{0.9, 0.15, 0.1},
                                                         {0.1, 0.6, 0.65},
                                                         {0.2, 0.75, 0.15},
                                                         {0.65, 0.15, 0.6},
                                                         {0.12, 0.25, 0.95},
                                                         {0.75, 0.65, 0.1}}};
constexpr std::array<double, 3> kInk{4, 4, 4}, kGridLine{0.05, 0.05, 0.05};

/// A face's point as seen from inside: a to the right, b up (+-Y as in the vertical cross, where
/// they hang above and below +Z).
V2d seenFromInside(const CubePoint& p) {
    // All cells of the crosses are OpenGL's faces turned over left to right.
    return {-p.s, -p.t};
}

bool inked(int face, const V2d& at) {
    // The sign and the letter with a cell between them: 11 x 7 cells about the middle.
    const int column = static_cast<int>(std::floor(at.x / kCell + 5.5));
    const int row = static_cast<int>(std::floor(3.5 - at.y / kCell));
    if (row < 0 || row >= 7 || column < 0 || column >= 11 || column == 5) return false;
    const Glyph& sign = face % 2 == 0 ? kPlus : kMinus;
    const Glyph& glyph = column < 5 ? sign : kLetters[static_cast<std::size_t>(face / 2)];
    return (glyph[static_cast<std::size_t>(row)] >> (4 - column % 6)) & 1;
}

V3d compassRadiance(const V3d& direction) {
    const CubePoint p = cubePoint(direction);
    const V2d at = seenFromInside(p);
    if (inked(p.face, at)) return vector(kInk);
    // Lines every quarter of a face's half, thicker along its edges.
    const auto onLine = [](double s) {
        const double off = std::abs(s - 0.25 * std::round(4 * s));
        return off < (std::abs(s) > 0.9 ? 0.015 : 0.006);
    };
    if (onLine(p.s) || onLine(p.t)) return vector(kGridLine);
    return vector(kColours[static_cast<std::size_t>(p.face)]);
}

void compass(Image& image, int threads) {
    constexpr int kSamples = 2; // across a pixel: enough to soften steps
    std::vector<V2d> around(static_cast<std::size_t>(image.width * kSamples));
    for (std::size_t k = 0; k < around.size(); ++k) {
        const double phi =
            2 * kPi * (0.5 - (static_cast<double>(k) + 0.5) / (image.width * kSamples));
        around[k] = V2d(std::sin(phi), std::cos(phi));
    }
    parallelFor(static_cast<std::size_t>(image.height), threads, [&](std::size_t y) {
        std::vector<V3d> sums(static_cast<std::size_t>(image.width), V3d(0));
        for (int k = 0; k < kSamples; ++k) {
            const double theta =
                kPi * (static_cast<double>(y) + (k + 0.5) / kSamples) / image.height;
            const double sine = std::sin(theta), cosine = std::cos(theta);
            for (std::size_t x = 0; x < around.size(); ++x) {
                sums[x / kSamples] +=
                    compassRadiance({sine * around[x].x, cosine, sine * around[x].y});
            }
        }
        for (std::size_t x = 0; x < sums.size(); ++x) {
            set(image.at(static_cast<int>(x), static_cast<int>(y)),
                sums[x] / (kSamples * kSamples));
        }
    });
}

} // namespace

bool isBuiltin(std::string_view name) {
    return name.substr(0, kPrefix.size()) == kPrefix;
}

Panorama builtinProbe(std::string_view name, int height, int threads) {
    const std::string_view kind = isBuiltin(name) ? name.substr(kPrefix.size()) : "";
    Panorama probe{Layout::latlong, Image(2 * height, height)};
    if (kind == "furnace") {
        std::fill(probe.image.pixels.begin(), probe.image.pixels.end(), 1.0f);
    } else if (kind == "sky") {
        sky(probe.image, threads);
    } else if (kind == "compass") {
        compass(probe.image, threads);
    } else {
        throw inputError(name, "no such built-in probe; there are builtin:sky, builtin:compass "
                               "and builtin:furnace");
    }
    return probe;
}

} // namespace ibl
