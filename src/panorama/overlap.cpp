#include "panorama/overlap.h"

#include "core/parallel.h"

#include <algorithm>
#include <limits>

namespace ibl {
namespace {

// Geometry of one octant. psi is the longitude away from the axis, 0 to pi/4. With p along the
// axis, l across it and h upwards, a side face is p = 1 and +-Y is h = 1. All lines of both faces'
// grids are great circles (planes through the centre):
//
//     side face, h = g:    tan(latitude)   = g cos psi
//     side face, l = g:    psi = atan g, a meridian: bounds a cell's range of psi
//     pole face, p = g:    tan(colatitude) = g / cos psi
//     pole face, l = g:    tan(colatitude) = g / sin psi
//
// so that each is a curve "height over psi" when heights are counted from the equator on side faces
// and from the pole on +-Y, and a cell lies between an inner curve (nearer to the reference) and an
// outer one. Counting from the nearer of the two keeps small areas precise.

/// A longitude in the octant, in columns from the axis, with its sine and cosine.
struct Longitude {
    double x;
    double sine;
    double cosine;
};

enum class CurveKind { sideRow, poleAlong, poleAcross };

struct Curve {
    CurveKind kind;
    double g;

    /// Tangent of the height.
    double tangent(const Longitude& at) const {
        switch (kind) {
        case CurveKind::sideRow:
            return g * at.cosine;
        case CurveKind::poleAlong:
            return g / at.cosine;
        default:
            return g / at.sine;
        }
    }

    /// The height in z of its tangent: sin of latitude, 1 - cos of colatitude.
    double height(double tangent) const {
        const double root = std::sqrt(1 + tangent * tangent);
        return kind == CurveKind::sideRow ? tangent / root
                                          : tangent * tangent / (root * (root + 1));
    }

    /// Where the curve has that height.
    Longitude at(double tangent, double columns_per_radian) const {
        double cosine, sine;
        if (kind == CurveKind::poleAcross) {
            sine = std::min(1.0, g / tangent);
            cosine = std::sqrt(1 - sine * sine);
        } else {
            cosine = std::min(1.0, kind == CurveKind::sideRow ? tangent / g : g / tangent);
            sine = std::sqrt(1 - cosine * cosine);
        }
        return {std::atan2(sine, cosine) * columns_per_radian, sine, cosine};
    }

    /// Solid angle between the curve and the reference. On a side face that is the integral of
    /// z = k cos psi / sqrt(1 + k^2 cos^2 psi), whose antiderivative is
    /// asin(k sin psi / sqrt(1 + k^2)). On +-Y it is the spherical triangle of the pole and two
    /// points of the line, at offsets o0 and o1 from its foot (van Oosterom and Strackee 1983).
    double area(const Longitude& from, const Longitude& to) const {
        if (g == 0) return 0;
        if (kind == CurveKind::sideRow) {
            const double kappa = g / std::sqrt(1 + g * g);
            return std::abs(std::asin(kappa * to.sine) - std::asin(kappa * from.sine));
        }
        const bool along = kind == CurveKind::poleAlong;
        const double o0 = g * (along ? from.sine / from.cosine : from.cosine / from.sine);
        const double o1 = g * (along ? to.sine / to.cosine : to.cosine / to.sine);
        const double n0 = std::sqrt(1 + g * g + o0 * o0), n1 = std::sqrt(1 + g * g + o1 * o1);
        const double numerator = g * std::abs(o1 - o0);
        return 2 * std::atan2(numerator, n0 * n1 + 1 + g * g + o0 * o1 + n0 + n1);
    }
};

/// The rows of the lat-long, counted from the reference. Row k lies between heights k and k + 1.
struct Bands {
    std::vector<double> tangent; ///< of the height; infinite from a right angle on
    std::vector<double> area;    ///< between the reference and the height, a radian of longitude
    bool first_is_half = false;  ///< row 0's pixels reach as far to the reference's other side

    double height(std::size_t row) const { return area[row + 1] - area[row]; }

    /// Where a part of the row's height is in its pixels, in their heights from the middle.
    double fromMiddle(std::size_t row, double part) const {
        return row == 0 && first_is_half ? 0.5 * part : part - 0.5;
    }
};

/// Solid angle, and that times the way from the middle of a pixel (see OctantOverlap).
struct Mass {
    double area = 0;
    double across = 0;
    double away = 0;

    Mass operator+(const Mass& m) const {
        return {area + m.area, across + m.across, away + m.away};
    }
    Mass operator-(const Mass& m) const {
        return {area - m.area, across - m.across, away - m.away};
    }
};

/// What lies between the reference and a curve, over a range of longitude, row by row: all of rows
/// before `first`, `masses` of rows first to last, nothing of later ones.
struct Coverage {
    int first = 0;
    int last = -1;
    std::vector<Mass> masses;

    Mass of(int row, const Mass& full) const {
        if (row < first) return full;
        return row > last ? Mass{} : masses[static_cast<std::size_t>(row - first)];
    }
};

struct Octant {
    Bands bands;
    double columns_per_radian;
    double phase;                    ///< column 0 is (phase - 1, phase], phase in (0, 1]
    double end;                      ///< psi = pi/4, in columns
    std::vector<Longitude> boundary; ///< between column n and n + 1, within the octant

    Longitude longitude(double across, double along) const {
        const double length = std::hypot(across, along);
        const double x = across == along ? end : std::atan2(across, along) * columns_per_radian;
        return {x, across / length, along / length};
    }

    double middleOf(int column) const { return column + phase - 0.5; }

    /// Of all of a row between two longitudes, in columns, of a column with that middle.
    Mass full(std::size_t row, double from, double to, double middle) const {
        const double area = std::abs(to - from) / columns_per_radian * bands.height(row);
        return {area, area * (0.5 * (from + to) - middle), area * bands.fromMiddle(row, 0.5)};
    }
};

/// Two longitudes nearer than this, in columns, are one: what is left between grid lines that ought
/// to coincide, as faces' edges and columns do.
constexpr double kSameColumn = 1e-11;
/// Overlaps below this part of a pixel are rounding of overlaps that are nothing.
constexpr double kNoOverlap = 1e-12;

/// Of `area` below a line over a row from one longitude to another, in columns, where it is at
/// parts p and q of the row's height.
Mass belowLine(const Bands& bands, std::size_t row, double area, double from, double to, double p,
               double q, double middle) {
    if (!(p + q > 0)) return {area, area * (0.5 * (from + to) - middle), 0};
    const double x = from + (to - from) * (p + 2 * q) / (3 * (p + q));
    const double y = (p * p + p * q + q * q) / (3 * (p + q));
    return {area, area * (x - middle), area * bands.fromMiddle(row, y)};
}

/// What of a column's rows, about its `middle`, lies below the curve from a to b.
Coverage& cover(const Octant& octant, const Curve& curve, const Longitude& a, const Longitude& b,
                double middle, Coverage& out) {
    out.masses.clear();
    out.first = 0;
    out.last = -1;
    if (curve.g == 0) return out;
    const std::vector<double>& tangent = octant.bands.tangent;
    const std::vector<double>& height = octant.bands.area;
    const double ta = curve.tangent(a), tb = curve.tangent(b);
    const Longitude low = ta <= tb ? a : b, high = ta <= tb ? b : a;
    const double highest = std::max(ta, tb);
    const auto above = std::upper_bound(tangent.begin() + 1, tangent.end() - 1, std::min(ta, tb));
    out.first = static_cast<int>(above - tangent.begin()) - 1;

    // Upwards along the curve from row to row. Past its crossing into the next row, all of a row
    // lies below the curve.
    const double radians = 1 / octant.columns_per_radian;
    const double total = std::abs(b.x - a.x) * radians;
    const auto part = [&](std::size_t row, double tangent_of_height) {
        const double z = curve.height(tangent_of_height);
        return std::clamp((z - height[row]) / octant.bands.height(row), 0.0, 1.0);
    };
    double done = 0;
    Longitude from = low;
    double from_part = part(static_cast<std::size_t>(out.first), std::min(ta, tb));
    for (int row = out.first;; ++row) {
        const auto k = static_cast<std::size_t>(row);
        const bool last = !(tangent[k + 1] < highest);
        const Longitude to = last ? high : curve.at(tangent[k + 1], octant.columns_per_radian);
        const double length = last ? total - done : std::abs(to.x - from.x) * radians;
        done += length;
        const double piece = std::max(0.0, curve.area(from, to) - length * height[k]);
        const Mass below = belowLine(octant.bands, k, piece, from.x, to.x, from_part,
                                     last ? part(k, highest) : 1, middle);
        out.masses.push_back(below + octant.full(k, to.x, high.x, middle));
        out.last = row;
        if (last) return out;
        from = to;
        from_part = 0;
    }
}

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

/// Heights of row boundaries from the equator. With an odd number of rows the middle one begins
/// below the equator; its upper half is row 0 here.
Bands sideBands(const LatlongGrid& grid) {
    Bands bands{{0}, {0}, grid.rows() % 2 == 1};
    for (int row = (grid.rows() - 1) / 2; row >= 0; --row) {
        const double theta = grid.theta[static_cast<std::size_t>(row)];
        bands.tangent.push_back(row == 0 ? std::numeric_limits<double>::infinity()
                                         : std::cos(theta) / std::sin(theta));
        bands.area.push_back(std::cos(theta));
    }
    return bands;
}

/// Heights from the pole. No line of the face comes near a right angle.
Bands poleBands(const LatlongGrid& grid) {
    Bands bands;
    for (double theta : grid.theta) {
        const double half = std::sin(0.5 * theta);
        bands.tangent.push_back(theta < 0.499 * kPi ? std::tan(theta)
                                                    : std::numeric_limits<double>::infinity());
        bands.area.push_back(2 * half * half);
    }
    return bands;
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
