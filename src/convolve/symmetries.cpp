#include "convolve/symmetries.h"

#include "panorama/layouts.h"
#include "panorama/square_maps.h"

#include <algorithm>

namespace ibl {
namespace {

/// Whether the symmetry takes texel (x, y) to (i, j), its shape too, which at borders is a part of
/// it: centres alone may meet by chance.
bool takesTo(const MapExtent& map, const Symmetry& symmetry, int x, int y, int i, int j) {
    constexpr double kSame = 1e-12;
    const auto place = [&](int column, int row, const V2d& off) {
        const auto [low, high] = ownPart(map.layout, map.width, map.height, column, row);
        const V2d p = V2d(column + 0.5, row + 0.5) + (low + high) * 0.5 + (high - low) * off;
        return texelDirection(map.layout, map.width, map.height, p.x, p.y);
    };
    const auto is = [&](const V3d& d, const V2d& off) {
        const auto other = place(i, j, off);
        return other && (*other - d).length() < kSame;
    };
    if (!is(symmetry(*place(x, y, V2d(0))), V2d(0))) return false;
    constexpr double kA = 0.3, kB = 0.1; // of a texel, off its axes and its diagonals
    // A corner texel cut off by a ball map's rim belongs to one of its neighbours (square_maps.h),
    // which are mirrored but not exchanged.
    const bool may_exchange = !isBallMap(map.layout);
    for (const V2d& off : {V2d(kA, kB), V2d(-kB, kA)}) {
        const auto d = place(x, y, off);
        if (!d) return false;
        const V3d moved = symmetry(*d);
        bool found = false;
        for (const double a : {-1.0, 1.0}) {
            for (const double b : {-1.0, 1.0}) {
                found = found || is(moved, V2d(a * off.x, b * off.y)) ||
                        (may_exchange && is(moved, V2d(a * off.y, b * off.x)));
            }
        }
        if (!found) return false;
    }
    return true;
}

bool keeps(Layout layout, const Symmetry& s) {
    const bool no_exchange = s.axis == std::array{0, 1, 2};
    switch (layout) {
    case Layout::exrLatlong:
        return no_exchange && s.sign[2] > 0;
    case Layout::octahedral:
        return s.axis[1] == 1 && s.sign[1] > 0;
    case Layout::angular:
    case Layout::mirrorBall:
        return no_exchange && s.sign[2] > 0;
    default:
        return true;
    }
}

} // namespace

std::vector<Symmetry> symmetriesOf(Layout layout) {
    std::vector<Symmetry> symmetries;
    std::array<int, 3> axis{0, 1, 2};
    do {
        for (int signs = 0; signs < 8; ++signs) {
            const auto sign = [&](int k) { return signs >> k & 1 ? -1.0 : 1.0; };
            const Symmetry symmetry{axis, {sign(0), sign(1), sign(2)}};
            if (keeps(layout, symmetry)) symmetries.push_back(symmetry);
        }
    } while (std::ranges::next_permutation(axis).found);
    return symmetries;
}

Shared sharedOf(const MapExtent& map, const std::vector<Symmetry>& symmetries, int x, int y) {
    Shared shared{y * map.width + x, 0};
    const V3d d = *texelDirection(map.layout, map.width, map.height, x + 0.5, y + 0.5);
    for (std::size_t k = 1; k < symmetries.size(); ++k) {
        const V2d p = texelPoint(map.layout, map.width, map.height, symmetries[k](d));
        const int i = static_cast<int>(p.x), j = static_cast<int>(p.y);
        if (i < 0 || j < 0 || i >= map.width || j >= map.height) continue;
        const int key = j * map.width + i;
        if (key >= shared.key || !takesTo(map, symmetries[k], x, y, i, j)) continue;
        shared.key = key;
        shared.symmetry = static_cast<int>(k);
    }
    return shared;
}

} // namespace ibl
