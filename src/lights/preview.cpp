#include "lights/preview.h"

#include "image/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ibl {
namespace {

using Colour = std::array<std::uint8_t, 3>;
constexpr Colour kBorder{90, 200, 90};
constexpr Colour kDot{255, 60, 30};
constexpr Colour kOutline{0, 0, 0};

void put(Preview& picture, int x, int y, const Colour& colour) {
    if (y < 0 || y >= picture.height) return;
    x = ((x % picture.width) + picture.width) % picture.width;
    std::copy(colour.begin(), colour.end(),
              picture.bytes.begin() + 3 * (static_cast<std::ptrdiff_t>(y) * picture.width + x));
}

/// Factor to the mean of log luminance 0.18 over the sphere's lit part; 1 for a black probe.
double exposureOf(const Image& probe) {
    double sum = 0, weights = 0;
    for (int y = 0; y < probe.height; ++y) {
        const double weight = latlongPixelSolidAngle(probe.width, probe.height, y);
        for (int x = 0; x < probe.width; ++x) {
            const double luminance = litLuminance(probe.at(x, y));
            if (luminance <= 0) continue;
            sum += weight * std::log(luminance);
            weights += weight;
        }
    }
    return weights > 0 ? 0.18 * std::exp(-sum / weights) : 1.0;
}

/// Means over the probe's pixels that fall into each of the picture's.
Preview develop(const Image& probe, int width, int height) {
    Preview picture{width, height, {}};
    picture.bytes.resize(3 * static_cast<std::size_t>(width) * height);
    const double exposure = exposureOf(probe);
    const auto begins = [](int i, int from, int to) {
        return static_cast<int>(static_cast<long>(i) * from / to);
    };
    for (int y = 0; y < height; ++y) {
        const int y0 = begins(y, probe.height, height);
        const int y1 = std::max(y0 + 1, begins(y + 1, probe.height, height));
        for (int x = 0; x < width; ++x) {
            const int x0 = begins(x, probe.width, width);
            const int x1 = std::max(x0 + 1, begins(x + 1, probe.width, width));
            V3d mean(0);
            for (int j = y0; j < y1; ++j) {
                for (int i = x0; i < x1; ++i) {
                    const float* rgb = probe.at(i, j);
                    mean += V3d(rgb[0], rgb[1], rgb[2]);
                }
            }
            mean *= exposure / (double(x1 - x0) * (y1 - y0));
            const double luminance = std::max(0.0, luminanceOf(mean));
            mean /= 1 + luminance;
            for (std::size_t c = 0; c < 3; ++c) {
                picture.bytes[3 * (static_cast<std::size_t>(y) * width + x) + c] =
                    linearToSrgb8(static_cast<float>(mean[static_cast<int>(c)]));
            }
        }
    }
    return picture;
}

void drawBorder(Preview& picture, const AngularRegion& r) {
    const auto column = [&](double longitude) {
        return static_cast<int>(std::lround((180 - longitude) / 360 * picture.width));
    };
    const auto row = [&](double latitude) {
        return static_cast<int>(std::lround((90 - latitude) / 180 * picture.height));
    };
    const int left = column(r.longitude[1]), right = column(r.longitude[0]);
    const int top = row(r.latitude[1]), bottom = row(r.latitude[0]);
    for (int x = left; x <= right; ++x) {
        put(picture, x, top, kBorder);
        put(picture, x, std::min(bottom, picture.height - 1), kBorder);
    }
    for (int y = top; y <= bottom; ++y) {
        put(picture, left, y, kBorder);
        put(picture, right, y, kBorder);
    }
}

void drawDot(Preview& picture, const V3d& direction) {
    const V2d at = latlongPoint(direction);
    const int x = static_cast<int>(at.x * picture.width),
              y = static_cast<int>(at.y * picture.height);
    for (int dy = -3; dy <= 3; ++dy) {
        for (int dx = -3; dx <= 3; ++dx) {
            const int squared = dx * dx + dy * dy;
            if (squared <= 10) put(picture, x + dx, y + dy, squared <= 4 ? kDot : kOutline);
        }
    }
}

/// The directions at an angle of three radii, at least two degrees, from the lamp.
void drawCircle(Preview& picture, const V3d& axis, double radius) {
    const double angle = std::max(3 * radius, 2 * kPi / 180);
    const V3d aside = std::abs(axis.y) < 0.9 ? V3d(0, 1, 0) : V3d(1, 0, 0);
    const V3d a = axis.cross(aside).normalized(), b = axis.cross(a);
    constexpr int kSteps = 2000;
    for (int i = 0; i < kSteps; ++i) {
        const double turn = 2 * kPi * i / kSteps;
        const V2d at = latlongPoint(axis * std::cos(angle) +
                                    (a * std::cos(turn) + b * std::sin(turn)) * std::sin(angle));
        put(picture, static_cast<int>(at.x * picture.width),
            static_cast<int>(at.y * picture.height), kBorder);
    }
}

} // namespace

Preview drawPreview(const Image& latlong, const std::vector<Light>& lights) {
    constexpr int kWidth = 1024;
    int width = latlong.width, height = latlong.height;
    if (width > kWidth) {
        const int factor = (width + kWidth - 1) / kWidth;
        width = std::max(1, width / factor);
        height = std::max(1, height / factor);
    } else {
        const int factor = kWidth / std::max(width, height);
        width *= std::max(1, factor);
        height *= std::max(1, factor);
    }
    Preview picture = develop(latlong, width, height);
    for (const Light& light : lights) {
        if (light.region) drawBorder(picture, *light.region);
        if (light.angular_radius) drawCircle(picture, light.direction, *light.angular_radius);
    }
    for (const Light& light : lights)
        drawDot(picture, light.direction);
    return picture;
}

} // namespace ibl
