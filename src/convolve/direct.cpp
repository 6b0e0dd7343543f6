#include "convolve/direct.h"

#include "convolve/peaks.h"
#include "panorama/conventions.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

/// 2 x 2 points are off by (size / scale)^4 / 4320 of a pixel's mass, 4 x 4 by
/// (size / scale)^8 / 1.8e10, where `scale` is the angle over which the lobe changes by its own
/// size: below 1e-9 either way.
constexpr double kCoarse = 0.045, kFine = 0.5;

PixelPointGrid makeGrid(int width, int height, int n) {
    const GaussRule& rule = gaussRule(n);
    PixelPointGrid grid;
    grid.n = n;
    for (int j = 0; j < height; ++j) {
        double total = 0;
        for (int b = 0; b < n; ++b) {
            const double theta = kPi * (j + 0.5 + 0.5 * rule.nodes[b]) / height;
            grid.sine.push_back(std::sin(theta));
            grid.cosine.push_back(std::cos(theta));
            total += rule.weights[b] * std::sin(theta);
        }
        const double area = latlongPixelSolidAngle(width, height, j);
        for (int b = 0; b < n; ++b)
            grid.weight.push_back(area * rule.weights[b] * grid.sine[n * j + b] / total);
    }
    for (int i = 0; i < width; ++i) {
        for (int a = 0; a < n; ++a) {
            const double psi = 2 * kPi * (i + 0.5 + 0.5 * rule.nodes[a]) / width;
            grid.psi_sine.push_back(std::sin(psi));
            grid.psi_cosine.push_back(std::cos(psi));
        }
    }
    for (const double weight : rule.weights)
        grid.psi_weight.push_back(0.5 * weight);
    return grid;
}

/// Where the lobe's disc meets a parallel: half of its range of azimuths, pi when all of it.
double halfWidthAt(const Axis& axis, double theta, double radius) {
    const double s2 = std::sin(theta) * axis.sin_theta;
    const double gap = std::sin(0.5 * (theta - axis.theta)), reach = std::sin(0.5 * radius);
    const double room = reach * reach - gap * gap;
    if (room <= 0) return 0;
    if (room >= s2) return kPi;
    return 2 * std::asin(std::sqrt(room / s2));
}

/// Columns west to west + count - 1 of a row, not wrapped, outside of which it has no pixel within
/// the disc.
struct Columns {
    int west = 0;
    int count = 0;
};

Columns columnsWithin(const DirectSum& direct, const Axis& axis, double top, double bottom) {
    const int width = direct.probe.width;
    double widest = 0;
    for (const double theta : {top, bottom, std::clamp(axis.theta, top, bottom)})
        widest = std::max(widest, halfWidthAt(axis, theta, direct.disc.radius));
    if (widest <= 0) return {};
    const double step = 2 * kPi / width;
    // On a flat disc about a pole the widest parallel may lie between: a column to either side.
    const int west = static_cast<int>(std::floor((axis.psi - widest) / step)) - 1;
    const int east = static_cast<int>(std::floor((axis.psi + widest) / step)) + 1;
    return {west, std::min(width, east - west + 1)};
}

struct Rotated {
    double cosine, sine; ///< of the axis's azimuth
    double cos_theta, sin_theta;

    /// The cosine of the angle between the axis and point (a, b) of a grid.
    double cosineTo(const PixelPointGrid& grid, std::size_t a, std::size_t b) const {
        const double azimuth = grid.psi_cosine[a] * cosine + grid.psi_sine[a] * sine;
        return cos_theta * grid.cosine[b] + sin_theta * grid.sine[b] * azimuth;
    }
};

double massByPoints(const DirectSum& direct, const PixelPointGrid& grid, const Rotated& axis, int i,
                    int j) {
    const auto n = static_cast<std::size_t>(grid.n);
    double mass = 0;
    for (std::size_t b = j * n; b < (j + 1) * n; ++b) {
        double across = 0;
        for (std::size_t a = 0; a < n; ++a) {
            across +=
                grid.psi_weight[a] * lobeValue(direct.lobe, axis.cosineTo(grid, i * n + a, b));
        }
        mass += grid.weight[b] * across;
    }
    return direct.norm * mass;
}

} // namespace

DirectSum makeDirectSum(const Lobe& lobe, const Image& probe, double scale) {
    return {probe,
            scale,
            lobe,
            LobeMassBeyond(lobe),
            lobeWidth(lobe),
            1 / lobeIntegral(lobe),
            {lobeReach(lobe), lobeVariation(lobe)},
            lobeBegin(lobe),
            makeGrid(probe.width, probe.height, 2),
            makeGrid(probe.width, probe.height, 4)};
}

void addDirect(const DirectSum& direct, const Axis& axis, double* sum) {
    const Image& probe = direct.probe;
    const int w = probe.width, h = probe.height;
    const double row_step = kPi / h, column_step = 2 * kPi / w;
    const Rotated rotated{std::cos(axis.psi), std::sin(axis.psi), axis.cos_theta, axis.sin_theta};
    const auto beyond = [&](double height) { return -direct.mass_beyond(height); };
    const double radius = direct.disc.radius;
    const int first = std::max(0, static_cast<int>((axis.theta - radius) / row_step));
    const int last = std::min(h - 1, static_cast<int>((axis.theta + radius) / row_step));
    for (int j = first; j <= last; ++j) {
        const double top = row_step * j, bottom = row_step * (j + 1);
        const double size = std::max(row_step, column_step * std::sin(0.5 * (top + bottom)));
        const Columns columns = columnsWithin(direct, axis, top, bottom);
        for (int k = columns.west; k < columns.west + columns.count; ++k) {
            const int i = ((k % w) + w) % w;
            const double t = std::acos(std::clamp(
                rotated.cosineTo(direct.coarse, 2 * std::size_t(i), 2 * std::size_t(j)), -1., 1.));
            if (t > radius + 2 * size || t + 2 * size < direct.begin) continue;
            const double scale = lobeScaleAt(direct.lobe, direct.width, t);
            double mass = 0;
            if (size > kFine * scale) {
                mass = rectangleMass(beyond, 1, direct.disc, axis,
                                     {top, bottom, i * column_step, (i + 1) * column_step});
            } else {
                mass = massByPoints(direct, size > kCoarse * scale ? direct.fine : direct.coarse,
                                    rotated, i, j);
            }
            for (int c = 0; c < 3; ++c)
                sum[c] += direct.scale * probe.at(i, j)[c] * mass;
        }
    }
}

} // namespace ibl
