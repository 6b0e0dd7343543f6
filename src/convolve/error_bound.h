// What a result may be off by, and what it probably is.
#pragma once

#include "image/image.h"

#include <cmath>
#include <cstddef>
#include <vector>

namespace ibl {

/// Relative RMSE that rounding to float leaves in any map.
inline constexpr double kFloatRounding = 1e-7;

/// Sums of w b^2 and w |b| over a map's texels and channels.
class MapNorm {
public:
    void add(double solid_angle, double value) {
        sum_ += solid_angle * value * value;
        absolute_ += solid_angle * std::abs(value);
        ++values_;
    }
    void add(const MapNorm& other) {
        sum_ += other.sum_;
        absolute_ += other.absolute_;
        values_ += other.values_;
    }
    double root() const { return std::sqrt(sum_); }
    /// Integral of the channels' absolute values.
    double absolute() const { return absolute_; }
    std::size_t texels() const { return values_ / 3; }

private:
    double sum_ = 0;
    double absolute_ = 0;
    std::size_t values_ = 0;
};

/// The probe's energy beyond each degree l: `energy` less the sum of `power` up to l.
std::vector<double> energyBeyond(const std::vector<double>& power, double energy);

/// Errors of cutting a lobe's coefficients k at `degree` and of interpolating what is kept.
struct SpectrumError {
    double bound;     ///< norm over the sphere, not exceeded
    double pointwise; ///< at any direction, over the channels together, not exceeded
    double estimate;  ///< norm over the sphere, likely
};

/// The bound is that of plan.h, with what the analysis has measured of the probe's spectrum. At a
/// point, by Cauchy and Schwarz with the addition theorem for |Y_lm|^2,
///
///     |sum over l > B of k_l f_lm Y_lm|^2 <= sum over l > B of (2l + 1) / (4 pi) k_l^2 * S_(l >
///     B).
///
/// The estimate sums k_l^2 S_l with the measured S_l as far as they go and beyond that with the
/// power law that continues the last octave and has the energy that is left.
SpectrumError spectrumError(const std::vector<double>& k, const std::vector<double>& power,
                            double energy, int degree);

/// By how much the mean square over that many texels may exceed the sphere's: four standard
/// deviations of a mean square of as many values, as a factor of its root.
double roomFor(std::size_t texels);

/// Norms as relative RMSE over a map.
struct RelativeError {
    double bound;
    double estimate;
};

/// Texels that look where a lobe has its greatest errors (shareAlongEdges).
struct WorstTexels {
    double share = 0; ///< of the map
    double times = 1; ///< how many times as great as over the sphere, at most; maybe infinite
};

/// Of a ring along the horizon (Charlie): 5 was measured, of Uffizi and Pisa onto lat-longs of 5
/// rows and octahedral maps of 6.
inline constexpr double kRingTimes = 8;

/// Of a map with the norm `size` and that many texels, rounding included: the less of what holds
/// over the sphere, with room for few texels and for the worst of them, and of what holds at every
/// point.
RelativeError relativeError(const SpectrumError& error, double size, std::size_t texels,
                            const WorstTexels& worst = {});

/// What rounding to float leaves of the brightest texel, beside the map's mean.
double roundingOfBrightest(const Image& map, const MapNorm& norm);

/// A norm over the sphere as relative RMSE of a map, rounding included.
double relative(double norm, double size);

} // namespace ibl
