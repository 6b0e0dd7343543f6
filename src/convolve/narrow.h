// Lobes too narrow for a band limit.
//
// Up to a degree B the lobe is known by its coefficients k_l. Beyond, all that can be said cheaply
// is a constant: about 1 where the lobe is so much narrower than 1 / B that it leaves what is there
// alone, about 0 where it removes it. With a constant m and a taper h_l that falls from 1 to 0
// about 0.85 B, the result is
//
//     m A + sum over l <= B of (k_l - m) h_l L_lm Y_lm,
//
// A the probe's mean over the texel. For roughness 0 it is A itself; where k_B is small it is the
// band-limited convolution; from the one to the other it goes without a step. What it leaves out is
// (k_l - m)(1 - h_l), of which a texel's footprint keeps about 2 / (l texel); m is what makes that
// least. Beside a sun that would be seen: in the texels about the brightest pixels, as far as the
// lobe and its band-limited part differ, the difference is added directly.
//
// Measured on texels and pixels of 1/256 of a quarter turn: for GGX of roughness 0.01, 0.02, 0.03,
// 0.05 the least part of the probe's variation left out is 2e-4, 5e-4, 4e-4, 3e-5 at B = 1024 and
// 1.4e-4, 1.5e-4, 4e-5, 2e-7 at B = 2048 (an edge's spectrum, S_l ~ l^-2). Convolving the core in
// space, over the edges of the pixels within its reach, was exact but took 5 to 240 us a point and
// up to 256 points a texel, minutes for a map.
#pragma once

#include "convolve/lobe.h"
#include "convolve/peaks.h"
#include "convolve/texels.h"
#include "image/image.h"

#include <vector>

namespace ibl {

/// A probe's energy by degree.
struct Spectrum {
    std::vector<double> power; ///< S_l, l = 0 .. power.size() - 1
    double beyond = 0;         ///< of all higher degrees together
};

/// The spectrum of a probe of that energy: `power` as far as it was measured (perhaps not at all),
/// beyond that the spectrum of edges, S_l ~ l^-2, with the energy that is left.
Spectrum continuedSpectrum(std::vector<double> power, double energy, int degree);

struct NarrowLobe {
    double area = 0;       ///< m
    std::vector<double> k; ///< (k_l - m) h_l, l = 0 .. B
    double error = 0;      ///< norm over the sphere of what is left out
};

/// `k` holds the lobe's coefficients, `spectrum` the probe's energies, to `degree` at least;
/// `footprint` is the edge (radians) of the square that a texel is the mean over.
NarrowLobe makeNarrowLobe(const std::vector<double>& k, int degree, const Spectrum& spectrum,
                          double footprint);

/// What the brightest pixels add beyond m A and the harmonics: their convolution with the lobe less
/// its band-limited part, which is a narrow kernel of the mass m.
struct NarrowPeaks {
    PeakSum sum;
    double area = 0;            ///< m
    double reach = 0;           ///< angle within which that kernel's mass lies
    double variation = 0;       ///< angle over which its band-limited part varies
    std::vector<double> beyond; ///< that part's mass beyond chords of i * step
    double step = 0;
};

/// `width` x `height` is the probe's extent.
NarrowPeaks makeNarrowPeaks(const std::vector<Peak>& peaks, int width, int height, const Lobe& lobe,
                            const NarrowLobe& narrow);

/// A row of a map.
struct MapRow {
    Layout layout;
    int width;
    int height; ///< of the map
    int y;
};

/// Adds to one row of a map, `texels`, what the peaks add to it; to the area-filtered map's row
/// they add `area_row`. Near a peak the mean over the texel is that of texel_mean.h, farther away
/// that over the texel's points.
void addNarrowPeaks(const NarrowPeaks& peaks, const MapRow& row, const Footprint& footprint,
                    const RowPoints& points, const std::vector<double>& area_row,
                    std::vector<double>& texels);

} // namespace ibl
