// Lobes too narrow for a band limit.
//
// Up to the highest degree B that is worth its cost the lobe is known by its coefficients k_l.
// Beyond, all that can be said cheaply is a constant: about 1 where the lobe is so much narrower
// than 1 / B that it leaves what is there alone, about 0 where it removes it. With m = k_(3B/4) and
// a taper h_l that falls from 1 to 0 about 3B/4, the result is
//
//     m A + sum over l <= B of (k_l - m) h_l L_lm Y_lm,
//
// A the probe's mean over the texel (the area filter of panorama/resample.h). For roughness 0 it is
// A itself; where k_B is small it is the band-limited convolution; from the one to the other it
// goes without a step. What it leaves out is (k_l - m)(1 - h_l) of the degrees beyond about B/2.
// Beside a sun that would be seen, so L and A are those of the probe without its brightest pixels,
// and these are convolved directly: over the points of a texel near them, at the centre of others.
//
// Measured (tests/unit/convolve/narrow_test.cpp and tests/bench/convolve): convolving the core in
// space, over the edges of the pixels within its reach, was exact but took 5 to 240 us a point and
// up to 256 points a texel, minutes for a map.
#pragma once

#include "convolve/lobe.h"
#include "convolve/peaks.h"
#include "convolve/texels.h"
#include "image/image.h"

#include <vector>

namespace ibl {

struct NarrowLobe {
    double area = 0;           ///< m
    std::vector<double> k;     ///< (k_l - m) h_l, l = 0 .. B
    std::vector<double> error; ///< |(k_l - m)(1 - h_l)|, l = 0 .. B
    double decay = 0;          ///< beyond B k_l is about exp(-decay l)
};

NarrowLobe makeNarrowLobe(const Lobe& lobe, int degree);

/// Norm over the sphere of what is left out, from the power of each of the probe's degrees and its
/// `energy` in all. The texel's footprint, `texel` radians, takes its part of the high degrees.
double narrowError(const NarrowLobe& lobe, const std::vector<double>& power, double energy,
                   double texel);

/// Adds the peaks' part to one row of a map. Of the lobe's innermost part, which falls between a
/// texel's points, the mean is that of the area filter: `area_row` is what the peaks add to the
/// area-filtered map's row. `texel` is the texel's angle, `probe` the extent.
void addNarrowPeaks(const std::vector<Peak>& peaks, const Image& probe, const Lobe& lobe,
                    double texel, const Footprint& footprint, const RowPoints& points,
                    const std::vector<double>& area_row, std::vector<double>& texels);

} // namespace ibl
