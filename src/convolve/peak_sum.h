// The sum of split peaks, each convolved with a lobe.
#pragma once

#include "convolve/edges.h"
#include "convolve/lobe.h"
#include "convolve/peaks.h"
#include "convolve/texels.h"

#include <array>
#include <vector>

namespace ibl {

/// Points over a pixel and, of a lobe that is a rational function of cos t, for which places they
/// do: those whose direction's cosine with the first point of the fewest is in [low, high].
struct RangedPoints {
    PixelPoints points;
    double low, high;
};

/// Where a peak lies, and points in it.
struct PeakRectangle {
    Rectangle edges;
    double size;                        ///< the longer edge, radians
    double none;                        ///< cosine below which all of it lies beyond the horizon
    std::array<RangedPoints, 3> points; ///< from few to many
};

/// Peaks and the lobe that they are convolved with.
struct PeakSum {
    std::vector<Peak> peaks;
    std::vector<PeakRectangle> rectangles;
    Lobe lobe;
    LobeMassBeyond mass_beyond;
    double width; ///< lobeWidth
    double norm;  ///< 1 / integral of the lobe
    Disc disc;    ///< where the lobe is not zero
};

/// `width` x `height` is the probe's size.
PeakSum makePeakSum(const std::vector<Peak>& peaks, int width, int height, const Lobe& lobe);

/// Adds the peaks' part of the lobe-weighted mean at the points: values[3 i + channel] += sum of
/// excess times the lobe's normalised mass over the peak's pixel.
void addPeaks(const PeakSum& sum, const RowPoints& points, double* values);

} // namespace ibl
