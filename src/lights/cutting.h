// What the cuts share.
#pragma once

#include "lights/summed_area.h"

#include <cstdint>
#include <utility>

namespace ibl {

/// The region's first `first` columns (or rows) and the rest, on a probe `width` pixels wide.
inline std::pair<PixelRegion, PixelRegion> cutAt(int width, const PixelRegion& r, bool longitude,
                                                 int first) {
    if (longitude) {
        return {{r.x, r.y, first, r.height},
                {(r.x + first) % width, r.y, r.width - first, r.height}};
    }
    return {{r.x, r.y, r.width, first}, {r.x, r.y + first, r.width, r.height - first}};
}

/// The column of least energy: where the circle of longitudes is opened.
template <class Table>
int openingColumn(const Table& table) {
    int best = 0;
    std::int64_t least = table.energy({0, 0, 1, table.height()});
    for (int x = 1; x < table.width(); ++x) {
        const std::int64_t energy = table.energy({x, 0, 1, table.height()});
        if (energy < least) {
            least = energy;
            best = x;
        }
    }
    return best;
}

} // namespace ibl
