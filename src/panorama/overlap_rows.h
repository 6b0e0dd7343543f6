// The overlaps of cubes and lat-longs in the order of the lat-long's rows.
#pragma once

#include "panorama/overlap.h"

#include <array>
#include <vector>

namespace ibl {

/// Part of a pixel, in the cell (a, b) of an octant.
struct RowOverlap {
    int a, b;
    int column;
    double area;        ///< steradians, > 0
    float across, away; ///< as of OctantOverlap
};

/// An octant's overlaps in order of their rows, those of row r from begin[r] to begin[r + 1].
struct OctantRows {
    std::vector<RowOverlap> overlaps;
    std::vector<int> begin;
};

/// What the tables of `overlaps` hold, from the lat-long's side.
struct CubeLatlongRows {
    std::array<OctantRows, 4> side, pole;
};

CubeLatlongRows byRows(const CubeLatlongOverlaps& overlaps);

/// Calls `use(face, i, j, x, area, right, down)` for every texel (i, j) of a face that overlaps a
/// pixel (x, y) of row y, perhaps in several parts, in a fixed order. The areas sum to the pixels'
/// solid angles; `right` and `down` are the moments of OctantOverlap towards higher columns and
/// rows.
template <class Use>
void forEachOverlapInRow(const CubeLatlongOverlaps& overlaps, const CubeLatlongRows& by_rows, int y,
                         Use&& use) {
    for (const OctantPlace& place : octantPlaces(overlaps.rows)) {
        const CubeLatlongOverlaps::Wedge& wedge = overlaps.wedges[place.axis][place.higher];
        const OctantRows& table = (place.pole ? by_rows.pole : by_rows.side)[wedge.table];
        const int row = place.rows_down ? y - place.first_row : place.first_row - y;
        if (row < 0 || row + 1 >= static_cast<int>(table.begin.size())) continue;
        for (int k = table.begin[row]; k < table.begin[row + 1]; ++k) {
            const RowOverlap& part = table.overlaps[k];
            const V2i at = place.texel(overlaps.edge, part.a, part.b);
            use(place.face, at.x, at.y, overlaps.column(wedge, part.column), part.area,
                wedge.step * static_cast<double>(part.across),
                (place.rows_down ? 1 : -1) * static_cast<double>(part.away));
        }
    }
}

} // namespace ibl
