// The brightest pixels, convolved directly.
//
// A band limit leaves an error in proportion to the energy that the probe has beyond it, and a
// small sun has most of it there. What a few pixels have above a threshold is therefore taken out
// before the analysis and convolved exactly with each lobe, so the harmonics see the probe clamped
// at the threshold (non-negative where the probe is).
#pragma once

#include "image/image.h"
#include "panorama/conventions.h"

#include <vector>

namespace ibl {

/// A pixel that may be split off. Values are scaled like the analysis.
struct Candidate {
    int column;
    int row;
    double magnitude; ///< of its largest channel
    double solid_angle;
    double value[3];
};

/// Statistics of a probe, from which the split is chosen; values are scaled.
struct ProbeStatistics {
    double scale = 1;                 ///< scaleFor the largest magnitude
    std::vector<Candidate> brightest; ///< by magnitude, descending; at most kMostPeaks + 1
    double energy = 0;                ///< integral of L^2 over the sphere, all channels
    double squares = 0;               ///< sum of (w L)^2
    double absolute[3] = {0, 0, 0};   ///< integral of |L|
    bool negative = false;            ///< some value is below zero
};

inline constexpr int kMostPeaks = 1024;

/// In one pass. Throws Error (input) on values that are not finite.
ProbeStatistics measureProbe(const Image& probe, int threads);

/// The threshold that splits off the `count` brightest pixels: the magnitude of the next one.
double peakThreshold(const ProbeStatistics& statistics, int count);

/// The integral of L^2 of the probe clamped to +-threshold.
double clampedEnergy(const ProbeStatistics& statistics, double threshold);

/// What a pixel has above the threshold (below minus it, for negative values).
struct Peak {
    int column;
    int row;
    double excess[3];
};

std::vector<Peak> splitPeaks(const ProbeStatistics& statistics, double threshold);

/// n x n Gauss points over a pixel, as polar directions.
struct PixelPoints {
    std::vector<double> x, y, z;
    std::vector<double> weight; ///< summing to the pixel's solid angle
};

/// Gauss's in (psi, theta): in cos theta the pixels at the poles would not be smooth.
PixelPoints pixelPoints(int width, int height, int column, int row, int n);

/// A direction with the pole along +Z.
inline V3d polar(const V3d& d) {
    return {-d.z, d.x, d.y};
}

/// The direction of which that is the polar one.
inline V3d unpolar(const V3d& d) {
    return {d.y, d.z, -d.x};
}

/// The direction of colatitude theta and azimuth psi, with the pole along +Z.
V3d polarDirection(double theta, double psi);

} // namespace ibl
