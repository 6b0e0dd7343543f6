// The sum of split peaks, each convolved with a lobe.
#pragma once

#include "convolve/edges.h"
#include "convolve/lobe.h"
#include "convolve/peaks.h"
#include "convolve/texels.h"

#include <vector>

namespace ibl {

/// Gauss points over a pixel as polar directions.
struct PixelPoints {
    std::vector<V3d> directions;
    std::vector<double> weights; ///< summing to the pixel's solid angle
};

/// Where a peak lies, and points in it.
struct PeakRectangle {
    Rectangle edges;
    double size; ///< the longer edge, radians
    PixelPoints coarse, fine;
};

/// A peak where 2 x 2 points do: seen from directions whose cosine with the first of them is in
/// [low, high], and from those below `none`, of which all of it lies beyond the horizon.
struct SmoothPeak {
    double x[4], y[4], z[4]; ///< of its points
    double weight[4];
    double low, high, none;
    double excess[3];
};

/// Peaks and the lobe that they are convolved with.
struct PeakSum {
    std::vector<Peak> peaks;
    std::vector<PeakRectangle> rectangles;
    std::vector<SmoothPeak> smooth; ///< of lobes that are a rational function of cos t, else none
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
