#include "convolve/near_weights.h"

#include "convolve/edges.h"
#include "convolve/gauss.h"
#include "convolve/lobe.h"
#include "convolve/peaks.h"
#include "panorama/layouts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

constexpr int kWidth = 60, kHeight = 30;

/// The mean over the points of a footprint of the kernel's mass over pixel (i, j), by its values.
double massByPoints(const NearKernel& kernel, const std::vector<V3d>& at, const RowPoints& points,
                    int i, int j) {
    const GaussRule& rule = gaussRule(6);
    double mass = 0, total = 0;
    for (std::size_t b = 0; b < rule.nodes.size(); ++b) {
        const double theta = kPi * (j + 0.5 + 0.5 * rule.nodes[b]) / kHeight;
        for (std::size_t a = 0; a < rule.nodes.size(); ++a) {
            const V3d p = polarDirection(theta, 2 * kPi * (i + 0.5 + 0.5 * rule.nodes[a]) / kWidth);
            double mean = 0;
            for (std::size_t k = 0; k < at.size(); ++k) {
                const double h = 0.25 * (p - at[k]).length2();
                if (h < 0.5) mean += points.share[k] * kernel.value(h);
            }
            const double weight = rule.weights[a] * rule.weights[b] * std::sin(theta);
            mass += weight * mean;
            total += weight;
        }
    }
    return mass / total * latlongPixelSolidAngle(kWidth, kHeight, j);
}

/// Lobes as wide as texels, where all parts of the method meet: outlines, points within, pixels far
/// away and on the other side of the sphere, footprints of all scales.
TEST(NearWeights, OfWideLobesAreTheMeansOfTheirValues) {
    struct Case {
        Layout layout;
        int size, x, y;
        double exponent;
    };
    const Case cases[] = {
        {Layout::faces, 8, 1, 2, 100},       {Layout::faces, 8, 7, 10, 60},
        {Layout::faces, 10, 9, 5, 45},       {Layout::latlong, 12, 5, 0, 45},
        {Layout::latlong, 12, 5, 6, 40},     {Layout::octahedral, 12, 4, 3, 50},
        {Layout::octahedral, 13, 3, 9, 40},  {Layout::exrCube, 9, 0, 4, 60},
        {Layout::exrLatlong, 12, 3, 11, 60}, {Layout::exrLatlong, 12, 23, 5, 60},
        {Layout::mirrorBall, 14, 11, 7, 30}, {Layout::mirrorBall, 14, 5, 6, 30},
        {Layout::angular, 14, 11, 9, 20},
    };
    for (const Case& c : cases) {
        const Lobe lobe{Kernel::phong, c.exponent};
        const NearKernel kernel(lobe, 0, 0);
        const NearField field = makeNearField(kernel, nearRules(0), kWidth, kHeight, 1);
        const V2i extent = layoutExtent(c.layout, c.size);
        const MapExtent map{c.layout, extent.x, extent.y, texelAngle({lobe, c.layout, c.size})};
        const Footprint of_map = footprintOf(lobe, map.texel, kAnyDegree);
        const NearWeights weights = nearWeights(field, map, c.x, c.y, of_map);
        Footprint own = footprintOfTexel(of_map, c.layout, extent.x, c.x, c.y);
        own.samples = own.scale > 0 ? 16 : 1;
        ASSERT_LT(own.scale, 1); // of whole texels part of the mass is the area filter's
        const RowPoints points = texelPoints(map, c.x, c.y, own);
        std::vector<V3d> at;
        for (std::size_t k = 0; k < points.u.size(); ++k)
            at.push_back(polarDirection(kPi * points.v[k], 2 * kPi * points.u[k]));
        double off = 0, sum = weights.area;
        for (int j = 0; j < weights.rows; ++j) {
            for (int i = 0; i < weights.columns; ++i) {
                const double weight =
                    weights.weight[static_cast<std::size_t>(j * weights.columns + i)];
                sum += weight;
                off += std::abs(
                    weight - massByPoints(kernel, at, points, weights.column + i, weights.row + j));
            }
        }
        EXPECT_NEAR(sum, 1, 1e-12);
        EXPECT_LT(off, 1e-6) << layoutName(c.layout) << " " << c.size << " at " << c.x << " " << c.y
                             << ", footprint's scale " << own.scale;
    }
}

/// A texel as large as the lobe, whose horizon or ring crosses it. On lat-longs the truth is the
/// lobe's mass over the footprint, by its edges (edges.h), seen from points of the pixel.
TEST(NearWeights, PeaksInTexelsThatAHorizonCrosses) {
    const Lobe lobes[] = {{Kernel::lambert, 0}, {Kernel::ggx, 1},       {Kernel::ggx, 0.4},
                          {Kernel::phong, 3},   {Kernel::charlie, 0.3}, {Kernel::charlie, 0.1}};
    std::vector<Peak> peaks;
    for (int j = 0; j < kHeight; j += 2)
        for (int i = j % 7; i < kWidth; i += 7)
            peaks.push_back({i, j, {1, 1, 1}});
    for (const Lobe& lobe : lobes) {
        const bool thin = lobe.kernel == Kernel::charlie && lobe.parameter < 0.2;
        const GaussRule& rule = gaussRule(thin ? 30 : 8);
        const NearField field =
            makeNearField(NearKernel(lobe, 0, 0), nearRules(1e-5), kWidth, kHeight, 1);
        const LobeMassBeyond beyond(lobe);
        const auto q = [&](double h) { return -beyond(h); };
        const Disc disc{lobeReach(lobe), lobeVariation(lobe)};
        for (const int size : {1, 2}) {
            const MapExtent map{Layout::latlong, 2 * size, size,
                                texelAngle({lobe, Layout::latlong, size})};
            const Footprint footprint = footprintOf(lobe, map.texel, kAnyDegree);
            if (footprint.scale == 0) continue;
            const double s = 0.5 * footprint.scale, step = kPi / size;
            const Rectangle texel{step * (0.5 - s), step * (0.5 + s), step * (0.5 - s),
                                  step * (0.5 + s)};
            const double texel_area =
                (std::cos(texel.top) - std::cos(texel.bottom)) * (texel.east - texel.west);
            const std::vector<double> masses = peakMasses(field, map, 0, 0, footprint, peaks);
            double off = 0, all = 0;
            for (std::size_t p = 0; p < peaks.size(); ++p) {
                double mass = 0, total = 0;
                for (std::size_t b = 0; b < rule.nodes.size(); ++b) {
                    const double v = (peaks[p].row + 0.5 + 0.5 * rule.nodes[b]) / kHeight;
                    for (std::size_t a = 0; a < rule.nodes.size(); ++a) {
                        const double u = (peaks[p].column + 0.5 + 0.5 * rule.nodes[a]) / kWidth;
                        const double weight = rule.weights[a] * rule.weights[b] * std::sin(kPi * v);
                        mass += weight * rectangleMass(q, 1, disc, makeAxis(u, v), texel);
                        total += weight;
                    }
                }
                mass *= latlongPixelSolidAngle(kWidth, kHeight, peaks[p].row) / total / texel_area;
                off += std::abs(masses[p] - mass);
                all += mass;
            }
            EXPECT_LT(off, 1e-6 * all)
                << "kernel " << int(lobe.kernel) << " " << lobe.parameter << ", map of " << size;
        }
    }
}

/// Far from a texel pixels are taken at points, everywhere by their edges.
TEST(NearWeights, FarPixelsAreAsByTheirEdges) {
    const Lobe lobe{Kernel::ggx, 0.9};
    const int width = 256, height = 128;
    const NearField field = makeNearField(NearKernel(lobe, 0, 0), nearRules(0), width, height, 1);
    const MapExtent map{Layout::faces, 2, 12, texelAngle({lobe, Layout::faces, 2})};
    const Footprint footprint = footprintOf(lobe, map.texel, kAnyDegree);
    ASSERT_GT(footprint.scale, 0.05);
    std::vector<Peak> peaks;
    for (int j = 0; j < height; j += 3)
        for (int i = j % 5; i < width; i += 5)
            peaks.push_back({i, j, {1, 1, 1}});
    const NearWeights weights = nearWeights(field, map, 0, 0, footprint);
    ASSERT_EQ(weights.columns, width);
    const std::vector<double> masses = peakMasses(field, map, 0, 0, footprint, peaks);
    double off = 0, all = 0;
    for (std::size_t p = 0; p < peaks.size(); ++p) {
        const int row = peaks[p].row - weights.row;
        const int column = ((peaks[p].column - weights.column) % width + width) % width;
        const bool seen = row >= 0 && row < weights.rows;
        const double weight =
            seen ? weights.weight[static_cast<std::size_t>(row * width + column)] : 0;
        off += std::abs(weight - masses[p]);
        all += masses[p];
    }
    EXPECT_LT(off, 3e-5 * all);
}

} // namespace
} // namespace ibl
