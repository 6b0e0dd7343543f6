// What of a lat-long's pixels lies below the lines of a cube's grid.
//
// The geometry of one octant of cubes and lat-longs (overlap.h). psi is the longitude away from the
// axis, 0 to pi/4. With p along the axis, l across it and h upwards, a side face is p = 1 and +-Y
// is h = 1. All lines of both faces' grids are great circles (planes through the centre):
//
//     side face, h = g:    tan(latitude)   = g cos psi
//     side face, l = g:    psi = atan g, a meridian: bounds a cell's range of psi
//     pole face, p = g:    tan(colatitude) = g / cos psi
//     pole face, l = g:    tan(colatitude) = g / sin psi
//
// so that each is a curve "height over psi" when heights are counted from the equator on side faces
// and from the pole on +-Y, and a cell lies between an inner curve (nearer to the reference) and an
// outer one. Counting from the nearer of the two keeps small areas precise.
#pragma once

#include "panorama/overlap.h"

#include <vector>

namespace ibl {

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
    double tangent(const Longitude& at) const;

    /// The height in z of its tangent: sin of latitude, 1 - cos of colatitude.
    double height(double tangent) const;

    /// Where the curve has that height.
    Longitude at(double tangent, double columns_per_radian) const;

    /// Solid angle between the curve and the reference. On a side face that is the integral of
    /// z = k cos psi / sqrt(1 + k^2 cos^2 psi), whose antiderivative is
    /// asin(k sin psi / sqrt(1 + k^2)). On +-Y it is the spherical triangle of the pole and two
    /// points of the line, at offsets o0 and o1 from its foot (van Oosterom and Strackee 1983).
    double area(const Longitude& from, const Longitude& to) const;
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

/// What of a column's rows, about its `middle`, lies below the curve from a to b.
Coverage& cover(const Octant& octant, const Curve& curve, const Longitude& a, const Longitude& b,
                double middle, Coverage& out);

/// Heights of row boundaries from the equator. With an odd number of rows the middle one begins
/// below the equator; its upper half is row 0 here.
Bands sideBands(const LatlongGrid& grid);

/// Heights from the pole. No line of the face comes near a right angle.
Bands poleBands(const LatlongGrid& grid);

} // namespace ibl
