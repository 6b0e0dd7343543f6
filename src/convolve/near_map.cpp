#include "convolve/near_map.h"

#include "convolve/near_groups.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"
#include "panorama/square_maps.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ibl {
namespace {

/// What takes the texel whose weights are reckoned to the one that they are for: first the
/// reflection of psi, then the turn, then the reflection of theta.
struct Move {
    int x, y; ///< the texel whose weights are reckoned
    bool reflect_psi = false;
    int turn = 0; ///< columns of the probe
    bool reflect_theta = false;
};

/// On the cube faces: to the quarter of +Z with x, y > 0, or of +Y with x, z > 0, as far as
/// quarters and halves of a turn are whole columns.
Move moveOnFaces(const MapExtent& map, int x, int y, int probe_width) {
    Move move;
    V3d d = *texelDirection(map.layout, map.width, map.height, x + 0.5, y + 0.5);
    if (d.y < 0) {
        move.reflect_theta = true;
        d.y = -d.y;
    }
    const int quarters = probe_width % 4 == 0 ? 4 : probe_width % 2 == 0 ? 2 : 1;
    const auto quarter = [&] { // u + 1/4
        d = V3d(-d.z, d.y, d.x);
        move.turn -= probe_width / 4;
    };
    const auto half = [&] {
        d = V3d(-d.x, d.y, -d.z);
        move.turn -= probe_width / 2;
    };
    const double side = std::max(std::abs(d.x), std::abs(d.z));
    if (quarters >= 2 && (side < d.y ? d.z < 0 : d.z == -side || d.x == -side)) half();
    if (quarters == 4 && side > d.y && d.x == side) quarter();
    if (d.x < 0) {
        move.reflect_psi = true;
        d.x = -d.x;
    }
    const V2d p = texelPoint(map.layout, map.width, map.height, d);
    move.x = static_cast<int>(p.x);
    move.y = static_cast<int>(p.y);
    return move;
}

/// On square maps: to the quarter of the first columns and rows. Their columns mirror x, the rows
/// of ball maps y and those of the octahedral map z, which takes half a turn.
Move moveOnSquare(const MapExtent& map, int x, int y, int probe_width) {
    const bool mirror_x = 2 * x + 1 > map.width;
    Move move{mirror_x ? map.width - 1 - x : x, y, mirror_x};
    const bool mirror_row = 2 * y + 1 > map.height;
    const bool octahedral = map.layout == Layout::octahedral;
    if (!mirror_row || (octahedral && probe_width % 2 != 0)) return move;
    move.y = map.height - 1 - y;
    if (octahedral) {
        move.reflect_psi = !mirror_x;
        move.turn = probe_width / 2;
    } else {
        move.reflect_theta = true;
    }
    return move;
}

/// On lat-longs: to the northern half of the columns that lie alike between the probe's, of which
/// every second one mirrors another. By the border rule the last column is the first again.
Move moveOnLatlong(const MapExtent& map, int x, int y, int probe_width) {
    const int border = map.layout == Layout::exrLatlong ? 1 : 0;
    const int around = std::max(1, map.width - border), turns = std::gcd(around, probe_width);
    const int alike = around / turns, turn = probe_width / turns;
    Move move{x % alike, y};
    move.turn = x / alike * turn;
    const int mirror = alike - 1 + border - move.x;
    if (mirror < move.x) {
        move.x = mirror;
        move.reflect_psi = true;
        move.turn += turn;
    }
    move.reflect_theta = 2 * y >= map.height + 1;
    if (move.reflect_theta) move.y = map.height - 1 - y;
    return move;
}

Move moveOf(const MapExtent& map, int x, int y, int probe_width) {
    if (map.layout == Layout::faces) return moveOnFaces(map, x, y, probe_width);
    if (isSquareMap(map.layout)) return moveOnSquare(map, x, y, probe_width);
    if (map.layout == Layout::exrCube) return {x, y};
    return moveOnLatlong(map, x, y, probe_width);
}

/// The weighted sum of pixels for a texel.
V3d weightedSum(const Image& probe, const NearWeights& weights, const Move& move,
                const float* area) {
    double sum[3] = {weights.area * area[0], weights.area * area[1], weights.area * area[2]};
    const int width = probe.width;
    const double* weight = weights.weight.data();
    for (int j = 0; j < weights.rows; ++j) {
        const int row = weights.row + j;
        const float* pixels = probe.row(move.reflect_theta ? probe.height - 1 - row : row);
        int column = weights.column % width;
        if (move.reflect_psi) column = width - 1 - column;
        column = ((column + move.turn) % width + width) % width;
        for (int i = 0; i < weights.columns; ++i, ++weight) {
            const float* pixel = pixels + std::size_t{3} * column;
            for (int c = 0; c < 3; ++c)
                sum[c] += *weight * pixel[c];
            if (move.reflect_psi)
                column = column == 0 ? width - 1 : column - 1;
            else
                column = column == width - 1 ? 0 : column + 1;
        }
    }
    return {sum[0], sum[1], sum[2]};
}

} // namespace

Image nearMap(const Panorama& probe, const Panorama& areas, const NearField& field,
              const PrefilterRequest& request, const Footprint& footprint, int threads,
              Progress* progress) {
    const V2i size = layoutExtent(request.layout, request.size);
    const MapExtent map{request.layout, size.x, size.y, texelAngle(request)};
    const Image area =
        resample(areas, request.layout, request.size, threads, Enlarging::hold).image;
    std::vector<KeyedTexel> texels;
    for (int y = 0; y < map.height; ++y) {
        for (int x = 0; x < map.width; ++x) {
            if (!texelDirection(map.layout, map.width, map.height, x + 0.5, y + 0.5)) continue;
            const Move move = moveOf(map, x, y, field.width);
            texels.push_back({move.y * map.width + move.x, x, y});
        }
    }
    return sumByKeys(
        request.layout, size, std::move(texels), threads, progress,
        [&](int x, int y) { return nearWeights(field, map, x, y, footprint); },
        [&](const NearWeights& weights, int x, int y) {
            return weightedSum(probe.image, weights, moveOf(map, x, y, field.width), area.at(x, y));
        });
}

} // namespace ibl
