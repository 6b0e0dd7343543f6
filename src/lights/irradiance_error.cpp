#include "lights/irradiance_error.h"

#include <cmath>
#include <utility>

namespace ibl {
namespace {

double square(const LightHarmonics::Parts& parts) {
    double sum = 0;
    for (const double part : parts)
        sum += part * part;
    return sum;
}

} // namespace

IrradianceWeights irradianceWeights(int degree, bool endless) {
    IrradianceWeights weights{degree, 4 * kPi * kPi / 9, {}};
    double a = kPi;
    const auto advance = [&](int l) { a *= -(l - 1.0) / (l + 4); };
    for (int l = 0; l <= degree; l += 2) {
        weights.even.push_back(a * a);
        advance(l);
    }
    if (!endless) return weights;
    constexpr int kFar = 4096; // of the sum over all l, 1e-8 lies beyond
    double beyond = 0;
    for (int l = degree + 2; l <= kFar; l += 2) {
        beyond += a * a * (2 * l + 1);
        advance(l);
    }
    const int first = 3 * degree / 8 + 1; // l / 2 of the upper quarter
    for (int i = first; i <= degree / 2; ++i)
        weights.even[static_cast<std::size_t>(i)] +=
            beyond / (degree / 2 + 1 - first) / (4 * i + 1);
    return weights;
}

double irradiancePower(const LightHarmonics& h, const IrradianceWeights& weights) {
    double sum = weights.first * (square(h.first[0]) + 2 * square(h.first[1]));
    for (int m = 0; m <= h.degree; ++m) {
        const LightHarmonics::Parts* in = h.even.data() + h.column(m);
        double column = 0;
        for (std::size_t i = static_cast<std::size_t>(m + 1) / 2; i < weights.even.size(); ++i)
            column += weights.even[i] * square(*in++);
        sum += (m == 0 ? 1 : 2) * column;
    }
    return sum;
}

double irradiancePower(std::span<const Light> lights, const IrradianceWeights& weights) {
    double sum = 0;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            const double x = lights[i].direction.dot(lights[j].direction);
            // P_(l+1) = ((2l + 1) x P_l - l P_(l-1)) / (l + 1)
            double before = 1, p = x, kernel = weights.even[0] + 3 * weights.first * x;
            for (int l = 1; l < weights.degree; ++l) {
                const double next = ((2 * l + 1) * x * p - l * before) / (l + 1);
                before = std::exchange(p, next);
                if (l % 2)
                    kernel += weights.even[static_cast<std::size_t>(l + 1) / 2] * (2 * l + 3) * p;
            }
            sum += (i == j ? 1 : 2) * kernel / (4 * kPi) *
                   lights[i].irradiance.dot(lights[j].irradiance);
        }
    }
    return sum;
}

double irradianceError(const LightHarmonics& probe, const LightHarmonics& difference) {
    const double norm = irradiancePower(probe, irradianceWeights(probe.degree, false));
    return norm > 0
               ? std::sqrt(irradiancePower(difference, irradianceWeights(difference.degree, true)) /
                           norm)
               : 0.0;
}

} // namespace ibl
