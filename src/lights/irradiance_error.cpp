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

/// int_a^inf (1 - exp(-x^2))^2 / x^4 dx, by parts: with p = 1, 2
///     int_a^inf exp(-p x^2) / x^4 dx = e / (3 a^3) - 2 p / 3 (e / a - sqrt(pi p) erfc(a sqrt p)),
/// e = exp(-p a^2). Near 0 the integrand is 1 and the terms cancel.
double spreadIntegral(double a) {
    if (a < 1e-3) return 4.0 / 3 * std::sqrt(kPi) * (std::sqrt(2.0) - 1) - a;
    const auto part = [&](double p) {
        const double e = std::exp(-p * a * a);
        return e / (3 * a * a * a) -
               2 * p / 3 * (e / a - std::sqrt(kPi * p) * std::erfc(a * std::sqrt(p)));
    };
    return 1 / (3 * a * a * a) - 2 * part(1) + part(2);
}

} // namespace

IrradianceWeights irradianceWeights(int degree) {
    IrradianceWeights weights{degree, 4 * kPi * kPi / 9, {}};
    double a = kPi;
    for (int l = 0; l <= degree; l += 2) {
        weights.even.push_back(a * a);
        a *= -(l - 1.0) / (l + 4);
    }
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

double powerBeyond(int degree, const Light& light) {
    const double radius =
        light.radius > 0 ? light.radius : std::sqrt(light.solid_angle / (2 * kPi));
    return 2 * light.irradiance.length2() * std::pow(radius / 2, 3) *
           spreadIntegral((degree + 1.5) * radius / 2);
}

double irradianceError(const LightHarmonics& probe, const LightHarmonics& difference,
                       std::span<const Light> lights) {
    const IrradianceWeights weights = irradianceWeights(probe.degree);
    const double norm = irradiancePower(probe, weights);
    if (norm <= 0) return 0;
    double power = irradiancePower(difference, weights);
    for (const Light& light : lights)
        power += powerBeyond(probe.degree, light);
    return std::sqrt(power / norm);
}

} // namespace ibl
