#include "convolve/error_bound.h"

#include "convolve/plan.h"
#include "convolve/synthesis.h"
#include "panorama/conventions.h"

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
    double interpolation = 0, interpolation_at_point = 0, measured = 0;
    for (int l = 0; l <= degree; ++l) {
        const double e = interpolationError(l, degree) * std::abs(k[l]) * std::sqrt(power[l]);
        interpolation += e * e;
        interpolation_at_point += e * std::sqrt((2 * l + 1) / (4 * kPi));
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
    // Beyond the table k_l is not above the envelope that falls as a horizon's, l^-2.5.
    const double end = static_cast<double>(k.size());
    double kernel = tail.back() * tail.back() * end * end / (6 * kPi);
    for (std::size_t l = degree + 1; l < k.size(); ++l)
        kernel += (2.0 * static_cast<double>(l) + 1) / (4 * kPi) * k[l] * k[l];
    SpectrumError error;
    error.bound = tail[degree] * std::sqrt(beyond[degree]) + std::sqrt(interpolation);
    error.pointwise = std::sqrt(kernel * beyond[degree]) + interpolation_at_point;
    // The interpolation's root mean square, over places between the samples and over directions of
    // the waves, is about an eighth of its worst.
    error.estimate = std::sqrt(measured + modelled + interpolation / 64);
    return error;
}

double roomFor(std::size_t texels) {
    return 1 + 4 / std::sqrt(static_cast<double>(texels));
}

RelativeError relativeError(const SpectrumError& error, double size, std::size_t texels,
                            const WorstTexels& worst) {
    if (size <= 0) return {0, 0};
    const double at_points = error.pointwise * std::sqrt(4 * kPi), root = std::sqrt(worst.share);
    const double at_worst = std::min(at_points, worst.times * error.bound);
    const double over_sphere = std::hypot(error.bound * roomFor(texels), root * at_worst);
    const double likely = error.estimate * std::hypot(1, root * std::min(worst.times, kRingTimes));
    return {std::hypot(std::min(over_sphere, at_points) / size, 4 * kFloatRounding),
            relative(likely, size)};
}

double roundingOfBrightest(const Image& map, const MapNorm& norm) {
    float most = 0;
    for (const float p : map.pixels)
        most = std::max(most, std::abs(p));
    const double mean = norm.absolute() / (12 * kPi);
    return kFloatRounding * (mean > 0 ? std::max(1.0, most / mean) : 1);
}

double relative(double norm, double size) {
    return size > 0 ? std::hypot(norm / size, kFloatRounding) : 0;
}

} // namespace ibl
