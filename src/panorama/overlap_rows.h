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
    using enum CubeLatlongOverlaps::Axis;
    const int edge = overlaps.edge, rows = overlaps.rows;
    const auto texel = [edge](int cell, bool positive) {
        return positive ? edge / 2 + cell : (edge - 1) / 2 - cell;
    };
    // `place` gives a cell's texel.
    const auto visit = [&](const std::array<OctantRows, 4>& tables, int axis, bool higher, int row,
                           int face, double down, auto place) {
        const CubeLatlongOverlaps::Wedge& wedge = overlaps.wedges[axis][higher];
        const OctantRows& table = tables[wedge.table];
        if (row + 1 >= static_cast<int>(table.begin.size())) return;
        for (int k = table.begin[row]; k < table.begin[row + 1]; ++k) {
            const RowOverlap& part = table.overlaps[k];
            const auto [i, j] = place(part.a, part.b);
            use(face, i, j, overlaps.column(wedge, part.column), part.area,
                wedge.step * static_cast<double>(part.across), down * part.away);
        }
    };
    constexpr std::array<int, 4> kSide{4, 0, 5, 1}; // of the axes
    for (const bool down : {false, true}) {         // as in forEachOverlap
        const int row = down ? y - rows / 2 : (rows - 1) / 2 - y;
        if (row < 0) continue;
        for (int axis = 0; axis < 4; ++axis) {
            for (const bool right : {false, true}) {
                visit(by_rows.side, axis, !right, row, kSide[axis], down ? 1 : -1,
                      [&](int a, int b) {
                          return std::array<int, 2>{texel(a, right), texel(b, down)};
                      });
            }
        }
    }
    for (const int face : {2, 3}) {
        const int row = face == 2 ? y : rows - 1 - y;
        const double away = face == 2 ? 1 : -1; // from the pole is down
        for (const bool plus_x : {false, true}) {
            for (const bool plus_z : {false, true}) {
                const bool down = plus_z == (face == 2);
                visit(by_rows.pole, plus_x ? kPlusX : kMinusX, plus_x == plus_z, row, face, away,
                      [&](int a, int b) {
                          return std::array<int, 2>{texel(a, plus_x), texel(b, down)};
                      });
                visit(by_rows.pole, plus_z ? kPlusZ : kMinusZ, plus_x != plus_z, row, face, away,
                      [&](int a, int b) {
                          return std::array<int, 2>{texel(b, plus_x), texel(a, down)};
                      });
            }
        }
    }
}

} // namespace ibl
