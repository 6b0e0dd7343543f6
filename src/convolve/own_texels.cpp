#include "convolve/own_texels.h"

#include "convolve/peaks.h"
#include "core/parallel.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"

#include <cstdlib>
#include <numbers>
#include <utility>

namespace ibl {
namespace {

/// Whether the rim is nowhere near pixel (x, y) of an n x n ball map: neither it nor one of its
/// neighbours is cut.
bool isWithinDisc(int n, int x, int y) {
    return std::hypot(std::abs(2 * x + 1 - n) + 3, std::abs(2 * y + 1 - n) + 3) < n;
}

/// Whether no edge of the octahedron crosses pixel (x, y).
bool isWithinFace(int n, int x, int y) {
    const int left = 2 * x - n, right = left + 2, top = 2 * y - n, bottom = top + 2;
    const int outer = std::max(-left, right) + std::max(-top, bottom);
    const int inner =
        std::min(std::abs(left), std::abs(right)) + std::min(std::abs(top), std::abs(bottom));
    return left * right >= 0 && top * bottom >= 0 && (outer <= n || inner >= n);
}

Pixel kindOf(const MapExtent& map, int rows, int x, int y) {
    if (!texelDirection(map.layout, map.width, map.height, x + 0.5, y + 0.5)) return Pixel::none;
    const bool in_rows = y % rows > 0 && y % rows < rows - 1;
    switch (map.layout) {
    case Layout::angular:
    case Layout::mirrorBall:
        return isWithinDisc(map.width, x, y) ? Pixel::plain : Pixel::cut;
    case Layout::octahedral:
        return isWithinFace(map.width, x, y) ? Pixel::plain : Pixel::cut;
    case Layout::exrLatlong:
        if (x == map.width - 1) return Pixel::none; // the first once more
        return in_rows ? Pixel::plain : Pixel::cut;
    case Layout::exrCube:
        return in_rows && x > 0 && x < map.width - 1 ? Pixel::plain : Pixel::cut;
    default:
        return Pixel::plain;
    }
}

constexpr int kTile = 16;
/// Pixels whose points are kept: 64 MiB.
constexpr std::size_t kMostKept = 1 << 20;

/// Sets a tile's bounds, if it has pixels.
bool measure(const Texels& texels, Tile& tile) {
    const auto isAtBorder = [&](int i, int j) {
        return i == 0 || j == 0 || i == tile.size.x - 1 || j == tile.size.y - 1;
    };
    std::vector<V3d> corners;
    V3d sum(0);
    tile.extent = 0;
    for (int j = 0; j < tile.size.y; ++j) {
        for (int i = 0; i < tile.size.x; ++i) {
            const int x = tile.first.x + i, y = tile.first.y + j;
            const Pixel kind = texels.kindOf(x, y);
            if (kind == Pixel::none) continue;
            if (kind == Pixel::plain && !isAtBorder(i, j)) {
                // A tile may be more than half the sphere, and its largest pixels within.
                tile.extent = std::max(tile.extent, texels.pointsOfPlain(x, y).side());
                corners.push_back(texels.middle(x, y));
                continue;
            }
            const auto [low, high] =
                ownPart(texels.map.layout, texels.map.width, texels.map.height, x, y);
            const std::array<V3d, 4> of_pixel{
                texels.place(x, y, low.x, low.y), texels.place(x, y, high.x, low.y),
                texels.place(x, y, high.x, high.y), texels.place(x, y, low.x, high.y)};
            for (std::size_t k = 0; k < 4; ++k) {
                tile.extent = std::max(tile.extent, (of_pixel[k] - of_pixel[(k + 1) % 4]).length());
                corners.push_back(of_pixel[k]);
            }
        }
    }
    if (corners.empty()) return false;
    for (const V3d& corner : corners)
        sum += corner;
    tile.centre = sum.length() > 1e-3 ? sum.normalized() : corners[0];
    tile.radius = 0;
    for (const V3d& corner : corners)
        tile.radius = std::max(tile.radius, (corner - tile.centre).length());
    return true;
}

} // namespace

FourPoints Texels::makePoints(int x, int y) const {
    constexpr double kOff = 0.5 / std::numbers::sqrt3;
    std::array<double, 4> share;
    FourPoints points;
    double total = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        const V3d d = place(x, y, k & 1 ? kOff : -kOff, k & 2 ? kOff : -kOff);
        points.at[k] = Imath::V3f(d);
        share[k] = solidAngleDensity(map.layout, unpolar(d));
        total += share[k];
    }
    for (std::size_t k = 0; k < 4; ++k)
        points.share[k] = static_cast<float>(share[k] / total);
    return points;
}

Texels texelsOf(const Panorama& probe, int threads) {
    Texels texels;
    if (isCubeFamily(probe.layout)) {
        const int edge = layoutSize(probe.layout, probe.image.width, probe.image.height).value();
        texels.probe = resample(probe, Layout::faces, edge, threads, Enlarging::hold);
    } else {
        texels.probe = probe;
        mergeBorder(texels.probe);
    }
    const int width = texels.probe.image.width, height = texels.probe.image.height;
    texels.map = {texels.probe.layout, width, height, 0};
    const bool faces = texels.map.layout == Layout::faces || texels.map.layout == Layout::exrCube;
    texels.rows = faces ? width : height;
    const auto inRows = [&](int rows, const auto& body) {
        parallelFor(static_cast<std::size_t>(rows), threads,
                    [&](std::size_t row) { body(static_cast<int>(row)); });
    };
    texels.kind.resize(texels.at(0, height));
    inRows(height, [&](int y) {
        for (int x = 0; x < width; ++x)
            texels.kind[texels.at(x, y)] = kindOf(texels.map, texels.rows, x, y);
    });
    std::vector<FourPoints> points(texels.kind.size() <= kMostKept ? texels.kind.size() : 0);
    inRows(points.empty() ? 0 : height, [&](int y) {
        for (int x = 0; x < width; ++x)
            if (texels.kindOf(x, y) == Pixel::plain)
                points[texels.at(x, y)] = texels.makePoints(x, y);
    });
    texels.kept = std::move(points);
    texels.quarter.resize(texels.at(0, (texels.rows + 1) / 2));
    inRows((texels.rows + 1) / 2, [&](int y) {
        for (int x = 0; 2 * x < width; ++x)
            texels.quarter[texels.at(x, y)] =
                partSolidAngle(texels.map.layout, width, height, x, y);
    });
    std::vector<Tile> tiles;
    for (int face = 0; face < height / texels.rows; ++face) {
        const int i = (width - 1) / 2, j = face * texels.rows + (texels.rows - 1) / 2;
        const V3d middle = texels.place(i, j, 0, 0);
        const V3d right = texels.place(i, j, 0.25, 0) - middle;
        const V3d down = texels.place(i, j, 0, 0.25) - middle;
        texels.turn.push_back(right.cross(down).dot(middle) < 0 ? -1 : 1);
        for (int y = 0; y < texels.rows; y += kTile)
            for (int x = 0; x < width; x += kTile)
                tiles.push_back({face,
                                 {x, face * texels.rows + y},
                                 {std::min(kTile, width - x), std::min(kTile, texels.rows - y)},
                                 V3d(0),
                                 0,
                                 0});
    }
    std::vector<char> has_pixels(tiles.size());
    parallelFor(tiles.size(), threads,
                [&](std::size_t i) { has_pixels[i] = measure(texels, tiles[i]); });
    for (std::size_t i = 0; i < tiles.size(); ++i)
        if (has_pixels[i]) texels.tiles.push_back(tiles[i]);
    return texels;
}

} // namespace ibl
