// Integrals of the direction over a lat-long's pixels.
#pragma once

#include "panorama/conventions.h"

#include <cmath>
#include <vector>

namespace ibl {

/// Integral of the direction over each pixel of row j, as factors: x and z are `horizontal` times
/// the integral of (sin phi, cos phi) over the pixel, y is `vertical`.
struct RowMoments {
    double solid_angle;
    double horizontal; ///< int sin^2 theta = [theta - sin theta cos theta] / 2
    double vertical;   ///< dphi int sin theta cos theta = dphi [sin^2 theta] / 2
};

inline RowMoments rowMoments(int width, int height, int j) {
    const double top = kPi * j / height, bottom = kPi * (j + 1) / height;
    const double dphi = 2 * kPi / width;
    return {latlongPixelSolidAngle(width, height, j),
            0.5 * (bottom - top) - 0.5 * std::sin(bottom - top) * std::cos(bottom + top),
            dphi * 0.5 * std::sin(bottom - top) * std::sin(bottom + top)};
}

/// sin and cos of the longitude of each column's centre, times the chord 2 sin(dphi/2): the
/// integral of (sin phi, cos phi) over the column. (phi falls from left to right.)
struct ColumnMoments {
    std::vector<double> sine;
    std::vector<double> cosine;
};

inline ColumnMoments columnMoments(int width) {
    ColumnMoments columns;
    const double chord = 2 * std::sin(kPi / width);
    for (int i = 0; i < width; ++i) {
        const double phi = 2 * kPi * (0.5 - (i + 0.5) / width);
        columns.sine.push_back(chord * std::sin(phi));
        columns.cosine.push_back(chord * std::cos(phi));
    }
    return columns;
}

} // namespace ibl
