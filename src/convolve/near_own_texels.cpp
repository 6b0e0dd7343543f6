#include "convolve/near_own_texels.h"

#include "convolve/near_groups.h"
#include "convolve/near_texel.h"
#include "convolve/own_texels.h"
#include "convolve/symmetries.h"
#include "core/parallel.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

/// A tile's weights in a map's texel.
struct Block {
    const Tile* tile;
    std::vector<double> weight; ///< [row][column]
    std::vector<char> near;     ///< which are by edges

    int at(int i, int j) const {
        const bool inside = i >= 0 && j >= 0 && i < tile->size.x && j < tile->size.y;
        return inside ? j * tile->size.x + i : -1;
    }
    bool isNear(int pixel) const { return pixel >= 0 && near[static_cast<std::size_t>(pixel)]; }
    void add(int pixel, double value) {
        if (isNear(pixel)) weight[static_cast<std::size_t>(pixel)] += value;
    }
};

/// The mean of the kernel over a pixel and the points of the map's texel: by 2 x 2 points.
double meanOf(const RadialTable& value, const Texels& texels, int x, int y,
              const std::vector<TexelPoint>& texel) {
    double mean = 0;
    const auto add = [&](const V3d& d, double share) {
        for (const TexelPoint& point : texel)
            mean += share * point.share * value((d - point.at).length2());
    };
    if (texels.kindOf(x, y) == Pixel::cut) {
        for (const TexelPoint& point : pointsOf(texels.map, x, y, {1, 2}))
            add(point.at, point.share);
    } else {
        const FourPoints points = texels.pointsOfPlain(x, y);
        for (std::size_t k = 0; k < 4; ++k)
            add(V3d(points.at[k]), points.share[k]);
    }
    return mean;
}

/// Marks the pixels that are near and sets the others' weights, as near_weights.cpp does.
void addFar(const NearField& field, const Texels& texels, const Texel& texel, Block& block) {
    const Tile& tile = *block.tile;
    const auto square = [](double a) { return a * a; };
    const double reach = field.kernel.reach + texel.radius + tile.extent;
    for (int j = 0; j < tile.size.y; ++j) {
        for (int i = 0; i < tile.size.x; ++i) {
            const int x = tile.first.x + i, y = tile.first.y + j;
            if (texels.kindOf(x, y) == Pixel::none) continue;
            const auto at = static_cast<std::size_t>(block.at(i, j));
            const double far2 = square(field.rules.far) *
                                (square(1.4 * texel.radius) + square(texels.side(x, y, tile)));
            const double distance2 = (texels.middle(x, y) - texel.centre).length2();
            if (distance2 < far2) {
                block.near[at] = 1;
            } else if (distance2 <= square(reach)) {
                block.weight[at] =
                    texels.solidAngle(x, y) * meanOf(field.value, texels, x, y, texel.four);
            }
        }
    }
}

/// Adds what all edges of the near pixels carry.
void addNear(const Flow& flow, const Texels& texels, Block& block) {
    const Tile& tile = *block.tile;
    const V2i& first = tile.first;
    const auto isPlain = [&](int pixel) {
        return block.isNear(pixel) && texels.kindOf(first.x + pixel % tile.size.x,
                                                    first.y + pixel / tile.size.x) == Pixel::plain;
    };
    // Of each side of a plain pixel, from its corner `begin` to `end`; `other` lies beyond.
    const auto carry = [&](int pixel, int other, const V2d& begin, const V2d& end) {
        std::vector<Arc> arcs;
        const int x = first.x + pixel % tile.size.x, y = first.y + pixel / tile.size.x;
        addCurve(
            [&](double t) {
                const V2d off = begin + (end - begin) * t;
                return texels.place(x, y, off.x, off.y);
            },
            0, 1, 1, kLongest, arcs);
        double carried = 0;
        for (const Arc& arc : arcs)
            carried += flow.across(arc);
        block.add(pixel, carried);
        if (isPlain(other)) block.add(other, -carried);
    };
    for (int j = 0; j < tile.size.y; ++j) {
        for (int i = 0; i < tile.size.x; ++i) {
            const int pixel = block.at(i, j);
            if (!block.isNear(pixel)) continue;
            if (!isPlain(pixel)) {
                for (const Arc& arc : texelOf(texels.map, first.x + i, first.y + j, 1).outline)
                    block.add(pixel, flow.across(arc));
                continue;
            }
            // Around it, as outlines run; sides that it shares are those of what is to the right
            // and below.
            const int above = block.at(i, j - 1), left = block.at(i - 1, j);
            if (!isPlain(above)) carry(pixel, -1, {-0.5, -0.5}, {0.5, -0.5});
            carry(pixel, block.at(i + 1, j), {0.5, -0.5}, {0.5, 0.5});
            carry(pixel, block.at(i, j + 1), {0.5, 0.5}, {-0.5, 0.5});
            if (!isPlain(left)) carry(pixel, -1, {-0.5, 0.5}, {-0.5, -0.5});
        }
    }
    const double turn = texels.turn[static_cast<std::size_t>(tile.face)];
    for (std::size_t k = 0; k < block.weight.size(); ++k)
        if (block.near[k]) block.weight[k] *= turn;
}

/// A texel is area * (its area-filtered value) + sum of weight * pixel.
struct OwnWeights {
    double area = 0;
    std::vector<Block> blocks;
};

OwnWeights weightsOf(const NearField& field, const Texels& texels, const MapExtent& map, int x,
                     int y, const Footprint& of_map) {
    OwnWeights weights;
    const Footprint footprint = footprintOfTexel(of_map, map.layout, map.width, x, y);
    const Texel texel = texelOf(map, x, y, footprint.scale);
    if (texel.outline.empty()) { // the whole sphere in one texel
        weights.area = field.kernel.mass;
        return weights;
    }
    const bool leaves_area = footprint.scale == 1;
    const Flow flow(field, map, x, y, footprint, texel,
                    leaves_area ? Potential::withoutArea : Potential::withArea);
    double sum = 0;
    for (const Tile& tile : texels.tiles) {
        if ((tile.centre - texel.centre).length() >
            field.kernel.reach + texel.radius + tile.radius + tile.extent)
            continue;
        const auto count = static_cast<std::size_t>(tile.size.x) * tile.size.y;
        weights.blocks.push_back({&tile, std::vector<double>(count), std::vector<char>(count)});
        Block& block = weights.blocks.back();
        addFar(field, texels, texel, block);
        addNear(flow, texels, block);
        for (int j = 0; j < tile.size.y && !leaves_area; ++j)
            for (int i = 0; i < tile.size.x; ++i)
                block.add(block.at(i, j),
                          field.kernel.mass / (4 * kPi) *
                              texels.solidAngle(tile.first.x + i, tile.first.y + j));
        for (const double w : block.weight)
            sum += w;
    }
    // Between what is near and what is far the sums are of two kinds.
    if (leaves_area) {
        weights.area = field.kernel.mass - sum;
    } else {
        for (Block& block : weights.blocks)
            for (double& w : block.weight)
                w *= field.kernel.mass / sum;
    }
    return weights;
}

/// Where a symmetry's inverse takes a face's pixels: pixel (i, j) to origin + i right + j down, in
/// values of the image.
struct Moved {
    std::ptrdiff_t origin, right, down;
};

Moved movedBy(const Texels& texels, const Symmetry& symmetry, int face) {
    const MapExtent& map = texels.map;
    const auto from = [&](int i, int j) {
        const V3d d = *texelDirection(map.layout, map.width, map.height, i + 0.5,
                                      face * texels.rows + j + 0.5);
        const V2d p = texelPoint(map.layout, map.width, map.height, symmetry.back(d));
        return std::ptrdiff_t{3} *
               static_cast<std::ptrdiff_t>(texels.at(static_cast<int>(p.x), static_cast<int>(p.y)));
    };
    // From the middle, where a place has one pixel.
    const int i = (map.width - 1) / 2, j = (texels.rows - 1) / 2;
    const std::ptrdiff_t middle = from(i, j);
    const std::ptrdiff_t right = map.width > 1 ? from(i + 1, j) - middle : 0;
    const std::ptrdiff_t down = texels.rows > 1 ? from(i, j + 1) - middle : 0;
    return {middle - i * right - j * down, right, down};
}

/// The weighted sum for a texel that a symmetry takes to the one of the weights; `moved` of each
/// face by it.
V3d weightedSum(const Texels& texels, const OwnWeights& weights, const std::vector<Moved>& moved,
                const float* area) {
    V3d sum(weights.area * area[0], weights.area * area[1], weights.area * area[2]);
    for (const Block& block : weights.blocks) {
        const Tile& tile = *block.tile;
        const Moved& by = moved[static_cast<std::size_t>(tile.face)];
        const double* weight = block.weight.data();
        for (int j = 0; j < tile.size.y; ++j) {
            const int row = tile.first.y - tile.face * texels.rows + j;
            const float* pixel = texels.probe.image.pixels.data() + by.origin + row * by.down +
                                 tile.first.x * by.right;
            for (int i = 0; i < tile.size.x; ++i, pixel += by.right, ++weight) {
                for (int c = 0; c < 3; ++c)
                    sum[c] += *weight * pixel[c];
            }
        }
    }
    return sum;
}

} // namespace

bool seesOwnTexels(const Panorama& probe, const Lobe& lobe) {
    constexpr double kWidest = 0.03, kTexels = 8;
    if (probe.layout == Layout::latlong || lobe.kernel == Kernel::charlie) return false;
    // Beside borders fewer would leave no middle.
    constexpr int kLeastWithBorder = 5;
    const bool border = probe.layout == Layout::exrLatlong || probe.layout == Layout::exrCube;
    if (border && std::min(probe.image.width, probe.image.height) < kLeastWithBorder) return false;
    return lobeWidth(lobe) < std::min(kWidest, kTexels * pixelAngle(probe));
}

Image nearMapOfOwnTexels(const Panorama& probe, const NearField& field,
                         const PrefilterRequest& request, const Footprint& footprint, int threads,
                         Progress* progress) {
    const Texels texels = texelsOf(probe, threads);
    const V2i size = layoutExtent(request.layout, request.size);
    const MapExtent map{request.layout, size.x, size.y, texelAngle(request)};
    const Image area =
        resample(probe, request.layout, request.size, threads, Enlarging::hold).image;
    const std::vector<Symmetry> symmetries = symmetriesOf(probe.layout);
    std::vector<std::vector<Moved>> moved; // [symmetry][face]
    for (const Symmetry& symmetry : symmetries) {
        moved.emplace_back();
        for (int face = 0; face < texels.map.height / texels.rows; ++face)
            moved.back().push_back(movedBy(texels, symmetry, face));
    }
    const auto at = [&](int x, int y) { return static_cast<std::size_t>(y) * size.x + x; };
    std::vector<Shared> shared(at(0, size.y));
    parallelFor(static_cast<std::size_t>(size.y), threads, [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < size.x; ++x) {
            if (texelDirection(map.layout, map.width, map.height, x + 0.5, y + 0.5))
                shared[at(x, y)] = sharedOf(map, symmetries, x, y);
        }
    });
    std::vector<KeyedTexel> keyed;
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
            if (shared[at(x, y)].key >= 0) keyed.push_back({shared[at(x, y)].key, x, y});
    return sumByKeys(
        request.layout, size, std::move(keyed), threads, progress,
        [&](int x, int y) { return weightsOf(field, texels, map, x, y, footprint); },
        [&](const OwnWeights& weights, int x, int y) {
            const auto symmetry = static_cast<std::size_t>(shared[at(x, y)].symmetry);
            return weightedSum(texels, weights, moved[symmetry], area.at(x, y));
        });
}

} // namespace ibl
