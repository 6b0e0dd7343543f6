// Exact overlaps of cube texels with lat-long pixels.
//
// (phi, z = cos theta) is an equal-area chart of the sphere. A lat-long pixel is a rectangle in it;
// a cube texel is bounded by great circles, below which the area has a closed form. Every sum of
// overlaps is local to a texel and a pixel: no global prefix sums, whose differences would lose a
// radiance of 1e-3 beside one of 1e9.
#pragma once

#include "panorama/layouts.h"

#include <array>
#include <vector>

namespace ibl {

/// The rectangles of a lat-long, `columns` equal ones around, and rows between the angles `theta`
/// from +Y (rows + 1 of them, 0 to pi, symmetric about pi/2). Column 0 begins at u = first /
/// columns.
struct LatlongGrid {
    int columns = 0;
    double first = 0; ///< a multiple of 1/4
    std::vector<double> theta;

    int rows() const { return static_cast<int>(theta.size()) - 1; }
};

/// The texels of a cube face: edge + 1 lines from -1 to 1 in s, and the same in t, symmetric about
/// 0.
struct CubeGrid {
    std::vector<double> lines;

    int edge() const { return static_cast<int>(lines.size()) - 1; }
};

/// Grids of the layouts: pixels as areas, or, by OpenEXR's border rule, areas about centres on the
/// edges (a lat-long of W columns then has W - 1 around, the first and last being one).
LatlongGrid latlongGrid(int width, int height, bool border_rule);
CubeGrid cubeGrid(int edge, bool border_rule);

/// Part of a texel that lies in one pixel, seen from its octant: columns are counted away from the
/// octant's axis, rows away from the equator (side faces) or the pole (+-Y).
struct OctantOverlap {
    int column;
    int row;
    double area; ///< steradians, > 0
    /// First moments about the pixel's middle in the chart (phi, z): `area` times the way there
    /// from the part's centroid, in columns, and in parts of the row's height in z. Its outer and
    /// inner sides are taken for straight, which they are to a thousandth of a fine pixel.
    float across;
    float away;
};

/// Overlaps of the cells of one octant. Cell (a, b), both counted from the middle of the face, has
/// `overlaps[a]` from `begin[a][b]` to `begin[a][b + 1]`.
struct OctantTable {
    std::vector<std::vector<OctantOverlap>> overlaps;
    std::vector<std::vector<int>> begin;
};

/// All overlaps between a cube and a lat-long, folded by symmetry. The four axes +Z +X -Z -X, with
/// 45 degrees to either side of each, divide the sphere into eight wedges of one geometry: they
/// differ only in where columns begin, which has at most four values, whole quarters of a column.
struct CubeLatlongOverlaps {
    enum Axis { kPlusZ, kPlusX, kMinusZ, kMinusX };
    struct Wedge {
        int table = 0;        ///< index into side and pole
        int first_column = 0; ///< that of `column` 0
        int step = 1;         ///< +1 or -1: which way columns count away from the axis
    };
    int edge = 0;
    int columns = 0;
    int rows = 0;
    std::array<std::array<Wedge, 2>, 4> wedges{}; ///< [axis][towards higher columns]
    std::array<OctantTable, 4> side;              ///< a along s, b along t
    std::array<OctantTable, 4> pole;              ///< a along the axis, b <= a across it

    /// The lat-long's column of a wedge's. Within one turn of the first; a remainder would cost
    /// more than all else.
    int column(const Wedge& wedge, int in_wedge) const {
        const int x = wedge.first_column + wedge.step * in_wedge;
        return x < 0 ? x + columns : x >= columns ? x - columns : x;
    }
};

/// Time and memory are linear in texels + pixels. `threads` 0: the machine's.
CubeLatlongOverlaps cubeLatlongOverlaps(const CubeGrid& cube, const LatlongGrid& latlong,
                                        int threads);

/// A half of the texels i of an edge: those on one side of the middle, counted away from it.
struct FromMiddle {
    int cell;
    bool positive;
};

/// Where texel i lies from the middle; the middle texel of an odd edge lies on both sides.
inline int fromMiddle(int edge, int i, std::array<FromMiddle, 2>& halves) {
    if (2 * i + 1 >= edge) halves[0] = {i - edge / 2, true};
    if (2 * i + 1 < edge) halves[0] = {(edge - 1) / 2 - i, false};
    if (2 * i + 1 != edge) return 1;
    halves[1] = {0, false};
    return 2;
}

/// A part of the sphere that a table stands for: half of a wedge's side face above or below the
/// equator, or a wedge's part of +Y or -Y.
struct OctantPlace {
    bool pole; ///< a table of `pole`, else of `side`
    int axis;  ///< the wedge
    bool higher;
    int face;
    bool right, down; ///< of the face's middle
    bool a_along_i;   ///< cells' a counts columns of texels and b rows, else the reverse
    int first_row;    ///< the lat-long's that the table's row 0 is
    bool rows_down;   ///< and whether its rows run down from there

    /// Texel of cell (a, b).
    V2i texel(int edge, int a, int b) const {
        const int i = a_along_i ? a : b, j = a_along_i ? b : a;
        return {right ? edge / 2 + i : (edge - 1) / 2 - i,
                down ? edge / 2 + j : (edge - 1) / 2 - j};
    }
};

/// All of them, for a lat-long of that many rows.
std::array<OctantPlace, 32> octantPlaces(int rows);

/// Calls `use(x, y, area)` for every pixel that texel (i, j) of a face overlaps, perhaps in several
/// parts, in a fixed order. The areas sum to the texel's solid angle.
template <class Use>
void forEachOverlap(const CubeLatlongOverlaps& overlaps, int face, int i, int j, Use&& use) {
    using enum CubeLatlongOverlaps::Axis;
    const auto visit = [&](const std::array<OctantTable, 4>& tables, int axis, bool higher, int a,
                           int b, auto row_of) {
        const CubeLatlongOverlaps::Wedge& wedge = overlaps.wedges[axis][higher];
        const OctantTable& table = tables[wedge.table];
        const OctantOverlap* part = table.overlaps[a].data();
        const OctantOverlap* end = part + table.begin[a][b + 1];
        for (part += table.begin[a][b]; part != end; ++part) {
            use(overlaps.column(wedge, part->column), row_of(part->row), part->area);
        }
    };
    std::array<FromMiddle, 2> across, down;
    const int n_across = fromMiddle(overlaps.edge, i, across);
    const int n_down = fromMiddle(overlaps.edge, j, down);
    const int rows = overlaps.rows;
    for (int h = 0; h < n_across; ++h) {
        for (int v = 0; v < n_down; ++v) {
            const FromMiddle s = across[h], t = down[v];
            if (face / 2 != 1) {
                constexpr std::array<int, 6> kAxis{kPlusX, kMinusX, 0, 0, kPlusZ, kMinusZ};
                // s grows towards lower columns on every side face, t downwards.
                visit(overlaps.side, kAxis[face], !s.positive, s.cell, t.cell,
                      [&](int row) { return t.positive ? rows / 2 + row : (rows - 1) / 2 - row; });
                continue;
            }
            // On +Y (s, t) is (x, z), on -Y (x, -z). Columns grow from +Z to -X, -Z, +X, +Z.
            const bool plus_x = s.positive, plus_z = t.positive == (face == 2);
            const auto row_of = [&](int row) { return face == 2 ? row : rows - 1 - row; };
            if (s.cell >= t.cell) {
                visit(overlaps.pole, plus_x ? kPlusX : kMinusX, plus_x == plus_z, s.cell, t.cell,
                      row_of);
            }
            if (t.cell >= s.cell) {
                visit(overlaps.pole, plus_z ? kPlusZ : kMinusZ, plus_x != plus_z, t.cell, s.cell,
                      row_of);
            }
        }
    }
}

} // namespace ibl
