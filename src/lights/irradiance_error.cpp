#include "lights/irradiance_error.h"

#include <cmath>

namespace ibl {
namespace {

double square(const LightHarmonics::Parts& parts) {
    double sum = 0;
    for (const double part : parts)
        sum += part * part;
    return sum;
}

/// |f_l|^2 over all m, for l = 0, 2, ... degree.
std::vector<double> evenPower(const LightHarmonics& h) {
    std::vector<double> power(static_cast<std::size_t>(h.degree / 2 + 1), 0.0);
    for (int m = 0; m <= h.degree; ++m) {
        const LightHarmonics::Parts* in = h.even.data() + h.column(m);
        for (std::size_t l = static_cast<std::size_t>(m + 1) / 2; l < power.size(); ++l)
            power[l] += (m == 0 ? 1 : 2) * square(*in++);
    }
    return power;
}

/// sum over l of A_l^2 |f_l|^2, the spectrum continued beyond the degree if `endless`.
double irradiancePower(const LightHarmonics& h, bool endless) {
    constexpr double kFirst = 2 * kPi / 3; // A_1
    double sum = kFirst * kFirst * (square(h.first[0]) + 2 * square(h.first[1]));
    const std::vector<double> power = evenPower(h);
    double a = kPi, level = 0;
    int levels = 0;
    for (std::size_t i = 0; i < power.size(); ++i) {
        const int l = 2 * static_cast<int>(i);
        sum += a * a * power[i];
        if (4 * l > 3 * h.degree) {
            level += power[i] / (2 * l + 1);
            ++levels;
        }
        a *= -(l - 1.0) / (l + 4);
    }
    if (!endless) return sum;
    constexpr int kFar = 4096; // of the sum over all l, 1e-8 lies beyond
    for (int l = h.degree + 2; l <= kFar; l += 2) {
        sum += a * a * (2 * l + 1) * level / levels;
        a *= -(l - 1.0) / (l + 4);
    }
    return sum;
}

} // namespace

double irradianceError(const LightHarmonics& probe, const LightHarmonics& difference) {
    const double norm = irradiancePower(probe, false);
    return norm > 0 ? std::sqrt(irradiancePower(difference, true) / norm) : 0.0;
}

} // namespace ibl
