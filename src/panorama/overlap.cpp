#include "panorama/overlap.h"

#include "panorama/octant.h"

#include "core/parallel.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

/// Overlaps below this part of a pixel are rounding of overlaps that are nothing.
constexpr double kNoOverlap = 1e-12;

/// Overlaps of one row of cells as they are found, by cell.
struct Found {
    struct Part {
        int cell;
        OctantOverlap overlap;
    };
    std::vector<Part> parts;

    void between(const Octant& octant, int cell, int column, const Longitude& from,
                 const Longitude& to, const Coverage& inner, const Coverage& outer) {
        const double middle = octant.middleOf(column);
        for (int row = inner.first; row <= outer.last; ++row) {
            const auto k = static_cast<std::size_t>(row);
            const Mass full = octant.full(k, from.x, to.x, middle);
            const Mass mass = outer.of(row, full) - inner.of(row, full);
            if (mass.area > kNoOverlap * octant.bands.height(k) / octant.columns_per_radian) {
                parts.push_back({cell,
                                 {column, row, mass.area, static_cast<float>(mass.across),
                                  static_cast<float>(mass.away)}});
            }
        }
    }

    /// Sorts by cell, otherwise in the order found.
    void store(int cells, std::vector<OctantOverlap>& overlaps, std::vector<int>& begin) const {
        begin.assign(static_cast<std::size_t>(cells) + 1, 0);
        for (const Part& part : parts)
            ++begin[static_cast<std::size_t>(part.cell) + 1];
        for (std::size_t c = 1; c < begin.size(); ++c)
            begin[c] += begin[c - 1];
        std::vector<int> next(begin.begin(), begin.end() - 1);
        overlaps.resize(parts.size());
        for (const Part& part : parts) {
            overlaps[static_cast<std::size_t>(next[static_cast<std::size_t>(part.cell)]++)] =
                part.overlap;
        }
    }
};

/// Calls `use(column, from, to)` for the parts of a range of longitude in each column.
template <class Use>
void forEachColumn(const Octant& octant, const Longitude& from, const Longitude& to, Use&& use) {
    int column = std::max(0, static_cast<int>(std::ceil(from.x + kSameColumn - octant.phase)));
    Longitude a = from;
    while (to.x - a.x > kSameColumn) {
        const auto n = static_cast<std::size_t>(column);
        const bool last = n >= octant.boundary.size() || octant.boundary[n].x > to.x - kSameColumn;
        const Longitude b = last ? to : octant.boundary[n];
        if (b.x - a.x > kSameColumn) use(column, a, b);
        if (last) break;
        a = b;
        ++column;
    }
}

/// Cells of a side face at distance a from the middle, all the way up: between two meridians, so
/// that neighbours share their curves.
void sideCells(const Octant& octant, const std::vector<double>& lines, int a, Found& found) {
    const int cells = static_cast<int>(lines.size()) - 1;
    const auto k = static_cast<std::size_t>(a);
    Coverage inner, outer;
    forEachColumn(
        octant, octant.longitude(lines[k], 1), octant.longitude(lines[k + 1], 1),
        [&](int column, const Longitude& from, const Longitude& to) {
            inner.first = 0;
            inner.last = -1;
            for (int b = 0; b < cells; ++b) {
                const double g = lines[static_cast<std::size_t>(b) + 1];
                cover(octant, {CurveKind::sideRow, g}, from, to, octant.middleOf(column), outer);
                found.between(octant, b, column, from, to, inner, outer);
                std::swap(inner, outer);
            }
        });
}

/// Cell [p0, p1] x [l0, l1] of +-Y, with l1 <= p0, or the half of it with l <= p on the diagonal. A
/// ray from the pole enters through l = l0 or p = p0 (at longitudes before or after that of their
/// corner) and leaves through p = p1 or l = l1.
void poleCell(const Octant& octant, const std::vector<double>& lines, int a, int b, Found& found) {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    const double p0 = lines[i], p1 = lines[i + 1], l0 = lines[j], l1 = lines[j + 1];
    const bool diagonal = a == b;
    const Longitude diagonal_end = octant.longitude(1, 1);
    const Longitude entry = diagonal ? diagonal_end : octant.longitude(l0, p0);
    const Longitude exit = octant.longitude(l1, p1);
    const Longitude end = diagonal ? diagonal_end : octant.longitude(l1, p0);

    Coverage inner, outer;
    const auto part = [&](const Longitude& from, const Longitude& to, const Curve& in,
                          const Curve& out) {
        forEachColumn(octant, from, to, [&](int column, const Longitude& c0, const Longitude& c1) {
            const double middle = octant.middleOf(column);
            cover(octant, in, c0, c1, middle, inner);
            cover(octant, out, c0, c1, middle, outer);
            found.between(octant, b, column, c0, c1, inner, outer);
        });
    };
    const Curve enters_across{CurveKind::poleAcross, l0}, enters_along{CurveKind::poleAlong, p0};
    const Curve leaves_along{CurveKind::poleAlong, p1}, leaves_across{CurveKind::poleAcross, l1};
    const Longitude begin = octant.longitude(l0, p1);
    if (entry.x <= exit.x) {
        part(begin, entry, enters_across, leaves_along);
        part(entry, exit, enters_along, leaves_along);
        part(exit, end, enters_along, leaves_across);
    } else {
        part(begin, exit, enters_across, leaves_along);
        part(exit, entry, enters_across, leaves_across);
        part(entry, end, enters_along, leaves_across);
    }
}

} // namespace

LatlongGrid latlongGrid(int width, int height, bool border_rule) {
    LatlongGrid grid{width, 0, {}};
    if (border_rule && width > 1) grid = {width - 1, -0.5, {}};
    // theta and pi - theta from one formula, so that hemispheres mirror each other to the bit.
    const bool border = border_rule && height > 1;
    grid.theta.resize(static_cast<std::size_t>(height) + 1);
    for (int row = 0; row <= height; ++row) {
        const int k = std::min(row, height - row);
        const double theta =
            border ? std::max(0.0, kPi * (k - 0.5) / (height - 1)) : kPi * k / height;
        grid.theta[static_cast<std::size_t>(row)] = row == k ? theta : kPi - theta;
    }
    return grid;
}

CubeGrid cubeGrid(int edge, bool border_rule) {
    CubeGrid grid;
    grid.lines.resize(static_cast<std::size_t>(edge) + 1);
    for (int i = 0; i <= edge; ++i) {
        // Exactly symmetric: numerators are integers.
        const double line = border_rule && edge > 1
                                ? std::clamp((2.0 * i - edge) / (edge - 1), -1.0, 1.0)
                                : (2.0 * i - edge) / edge;
        grid.lines[static_cast<std::size_t>(i)] = line;
    }
    return grid;
}

std::array<OctantPlace, 32> octantPlaces(int rows) {
    using enum CubeLatlongOverlaps::Axis;
    constexpr std::array<int, 4> kSide{4, 0, 5, 1}; // of the axes
    std::array<OctantPlace, 32> places;
    auto next = places.begin();
    for (const bool down : {false, true}) { // as in forEachOverlap
        for (const bool right : {false, true}) {
            const int from_equator = down ? rows / 2 : (rows - 1) / 2;
            for (int axis = 0; axis < 4; ++axis) {
                const int face = kSide[static_cast<std::size_t>(axis)];
                *next++ = {false, axis, !right, face, right, down, true, from_equator, down};
            }
            for (const int face : {2, 3}) {
                const bool north = face == 2, plus_z = down == north;
                const int from_pole = north ? 0 : rows - 1;
                *next++ = {true,
                           right ? kPlusX : kMinusX,
                           right == plus_z,
                           face,
                           right,
                           down,
                           true,
                           from_pole,
                           north};
                *next++ = {true,
                           plus_z ? kPlusZ : kMinusZ,
                           right != plus_z,
                           face,
                           right,
                           down,
                           false,
                           from_pole,
                           north};
            }
        }
    }
    return places;
}

CubeLatlongOverlaps cubeLatlongOverlaps(const CubeGrid& cube, const LatlongGrid& latlong,
                                        int threads) {
    CubeLatlongOverlaps result;
    result.edge = cube.edge();
    result.columns = latlong.columns;
    result.rows = latlong.rows();

    // Lines from the middle of a face outwards; the middle texel of an odd edge is cut in two.
    std::vector<double> lines{0};
    for (double line : cube.lines) {
        if (line > 0) lines.push_back(line);
    }
    const std::size_t cells = lines.size() - 1;

    std::array<bool, 4> used{};
    for (int axis = 0; axis < 4; ++axis) {
        // +Z stands at u = 1/2, +X at 1/4, -Z at 0, -X at 3/4.
        const double at = ((6 - axis) % 4) * 0.25 * latlong.columns - latlong.first;
        const double below = std::ceil(at) - 1, above = std::floor(at);
        const auto table = [&](double phase) {
            const int index = static_cast<int>(4 * phase) - 1;
            used[static_cast<std::size_t>(index)] = true;
            return index;
        };
        auto& wedge = result.wedges[static_cast<std::size_t>(axis)];
        wedge[0] = {table(at - below), static_cast<int>(below), -1};
        wedge[1] = {table(above + 1 - at), static_cast<int>(above), 1};
    }
    const Bands side_bands = sideBands(latlong), pole_bands = poleBands(latlong);
    for (std::size_t table = 0; table < 4; ++table) {
        if (!used[table]) continue;
        Octant side{side_bands,
                    latlong.columns / (2 * kPi),
                    0.25 * (static_cast<double>(table) + 1),
                    latlong.columns / 8.0,
                    {}};
        for (double x = side.phase; x < side.end - kSameColumn; ++x) {
            const double psi = x / side.columns_per_radian;
            side.boundary.push_back({x, std::sin(psi), std::cos(psi)});
        }
        Octant pole = side;
        pole.bands = pole_bands;
        for (OctantTable* t : {&result.side[table], &result.pole[table]}) {
            t->overlaps.resize(cells);
            t->begin.resize(cells);
        }
        parallelFor(2 * cells, threads, [&](std::size_t task) {
            const std::size_t a = task / 2;
            const bool is_side = task % 2 == 0;
            OctantTable& t = is_side ? result.side[table] : result.pole[table];
            Found found;
            if (is_side) {
                sideCells(side, lines, static_cast<int>(a), found);
            } else {
                for (int b = 0; b <= static_cast<int>(a); ++b) {
                    poleCell(pole, lines, static_cast<int>(a), b, found);
                }
            }
            found.store(static_cast<int>(cells), t.overlaps[a], t.begin[a]);
        });
    }
    return result;
}

} // namespace ibl
