// What a result may be off by, and what it probably is.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace ibl {

/// Relative RMSE that rounding to float leaves in any map.
inline constexpr double kFloatRounding = 1e-7;

/// Where only an estimate is known, which tests hold within a factor of three, its bound is this
/// many times as large.
inline constexpr double kBoundOverEstimate = 3;

/// Sum of w b^2 over a map's texels and channels.
class MapNorm {
public:
    void add(double solid_angle, double value) {
        sum_ += solid_angle * value * value;
        ++values_;
    }
    void add(const MapNorm& other) {
        sum_ += other.sum_;
        values_ += other.values_;
    }
    double root() const { return std::sqrt(sum_); }
    std::size_t texels() const { return values_ / 3; }

private:
    double sum_ = 0;
    std::size_t values_ = 0;
};

/// The probe's energy beyond each degree l: `energy` less the sum of `power` up to l.
std::vector<double> energyBeyond(const std::vector<double>& power, double energy);

/// Norms over the sphere of the error of cutting a lobe's coefficients k at `degree`, and of the
/// interpolation of what is kept.
struct SpectrumError {
    double bound;
    double estimate;
};

/// The bound is that of plan.h, with what the analysis has measured of the probe's spectrum. The
/// estimate sums k_l^2 S_l with the measured S_l as far as they go and beyond that with the power
/// law that continues the last octave and has the energy that is left.
SpectrumError spectrumError(const std::vector<double>& k, const std::vector<double>& power,
                            double energy, int degree);

/// A norm as relative RMSE over a map of norm `size`, rounding included. The norm is over the
/// sphere; a sum over few texels scatters about it, for which a bound has room (four standard
/// deviations of a mean square of that many values). `texels` 0: no such room.
double relative(double norm, double size, std::size_t texels);

} // namespace ibl
