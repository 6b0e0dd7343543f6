#include "convolve/error_bound.h"

#include "convolve/plan.h"
#include "convolve/synthesis.h"

#include <algorithm>

namespace ibl {

std::vector<double> energyBeyond(const std::vector<double>& power, double energy) {
    std::vector<double> beyond(power.size());
    double left = energy;
    for (std::size_t l = 0; l < power.size(); ++l) {
        left -= power[l];
        // The difference of nearly equal sums is known to their rounding.
        beyond[l] = std::max(left, 1e-14 * energy);
    }
    return beyond;
}

SpectrumError spectrumError(const std::vector<double>& k, const std::vector<double>& power,
                            double energy, int degree) {
    const std::vector<double> beyond = energyBeyond(power, energy);
    const std::vector<double> tail = tailMaximum(k);
    double interpolation = 0, measured = 0;
    for (int l = 0; l <= degree; ++l) {
        const double e = interpolationError(l, degree);
        interpolation += k[l] * k[l] * power[l] * e * e;
    }
    for (std::size_t l = degree + 1; l < power.size(); ++l)
        measured += k[l] * k[l] * power[l];

    // S_l = S (l / L)^-p beyond the last degree L, sum = S L / (p - 1) = what is left.
    const std::size_t last = power.size() - 1, first = last - last / 4;
    double level = 0;
    for (std::size_t l = first; l <= last; ++l)
        level += power[l] / static_cast<double>(last - first + 1);
    const double p = 1 + level * static_cast<double>(last) / std::max(beyond[last], 1e-300);
    double modelled = 0;
    for (std::size_t l = last + 1; l < k.size(); ++l) {
        modelled +=
            k[l] * k[l] * level * std::pow(static_cast<double>(l) / static_cast<double>(last), -p);
    }
    SpectrumError error;
    error.bound = tail[degree] * std::sqrt(beyond[degree]) + std::sqrt(interpolation);
    // The interpolation's root mean square, over places between the samples and over directions of
    // the waves, is about an eighth of its worst.
    error.estimate = std::sqrt(measured + modelled + interpolation / 64);
    return error;
}

double relative(double norm, double size, std::size_t texels) {
    if (size <= 0) return 0;
    const double room = texels > 0 ? 1 + 4 / std::sqrt(static_cast<double>(texels)) : 1;
    const double ratio = norm / size * room,
                 rounding = texels > 0 ? 4 * kFloatRounding : kFloatRounding;
    return std::hypot(ratio, rounding);
}

} // namespace ibl
