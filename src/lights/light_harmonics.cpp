#include "lights/light_harmonics.h"

#include "core/parallel.h"
#include "lights/harmonic_sums.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

/// P_10 = x sqrt(3 / (4 pi)) and P_11 = sin theta sqrt(3 / (8 pi)), times exp(-i m psi).
void addFirst(const Light& light, double sine, double cos_psi, double sin_psi,
              LightHarmonics& harmonics) {
    const double p0 = light.direction.y * std::sqrt(3 / (4 * kPi));
    const double p1 = sine * std::sqrt(3 / (8 * kPi));
    for (int c = 0; c < 3; ++c) {
        const std::size_t k = 2 * static_cast<std::size_t>(c);
        harmonics.first[0][k] += p0 * light.irradiance[c];
        harmonics.first[1][k] += p1 * cos_psi * light.irradiance[c];
        harmonics.first[1][k + 1] -= p1 * sin_psi * light.irradiance[c];
    }
}

/// Lights [begin, end): order by order, so that the sums of one order stay in the cache.
void addLights(const std::vector<Light>& lights, std::size_t begin, std::size_t end,
               LightHarmonics& harmonics) {
    HarmonicSources sources(end - begin);
    std::vector<double> cos_psi(end - begin), sin_psi(end - begin);
    for (std::size_t i = 0; i < end - begin; ++i) {
        const Light& light = lights[begin + i];
        const V3d& d = light.direction;
        const double sine = std::hypot(d.x, d.z);
        sources.x[i] = d.y;
        sources.sine[i] = sine;
        // psi = 2 pi u = pi - atan2(x, z).
        cos_psi[i] = sine > 0 ? -d.z / sine : 1;
        sin_psi[i] = sine > 0 ? d.x / sine : 0;
        for (int c = 0; c < 3; ++c)
            sources.wave[2 * c][i] = light.irradiance[c];
        addFirst(light, sine, cos_psi[i], sin_psi[i], harmonics);
    }
    for (int m = 0; m <= harmonics.degree; ++m) {
        addOrder(sources, m, harmonics.degree, harmonics.even.data() + harmonics.column(m));
        raiseSectoral(sources, m);
        for (std::size_t c = 0; c < 3; ++c) { // times exp(-i psi)
            double *re = sources.wave[2 * c].data(), *im = sources.wave[2 * c + 1].data();
            for (std::size_t i = 0; i < end - begin; ++i) {
                const double turned = re[i] * cos_psi[i] + im[i] * sin_psi[i];
                im[i] = im[i] * cos_psi[i] - re[i] * sin_psi[i];
                re[i] = turned;
            }
        }
    }
}

} // namespace

LightHarmonics& LightHarmonics::operator+=(const LightHarmonics& other) {
    for (std::size_t i = 0; i < even.size(); ++i) {
        for (std::size_t k = 0; k < 6; ++k)
            even[i][k] += other.even[i][k];
    }
    for (std::size_t m = 0; m < 2; ++m) {
        for (std::size_t k = 0; k < 6; ++k)
            first[m][k] += other.first[m][k];
    }
    return *this;
}

LightHarmonics& LightHarmonics::operator-=(const LightHarmonics& other) {
    for (std::size_t i = 0; i < even.size(); ++i) {
        for (std::size_t k = 0; k < 6; ++k)
            even[i][k] -= other.even[i][k];
    }
    for (std::size_t m = 0; m < 2; ++m) {
        for (std::size_t k = 0; k < 6; ++k)
            first[m][k] -= other.first[m][k];
    }
    return *this;
}

int harmonicDegree(int count) {
    return count <= 1024 ? 64 : count <= 16384 ? 128 : 256;
}

LightHarmonics lightHarmonics(const std::vector<Light>& lights, int degree, int threads) {
    constexpr std::size_t kRun = 256;
    const std::size_t runs = (lights.size() + kRun - 1) / kRun;
    std::vector<LightHarmonics> parts(runs, LightHarmonics(degree));
    parallelFor(runs, threads, [&](std::size_t run) {
        const std::size_t end = std::min(lights.size(), (run + 1) * kRun);
        addLights(lights, run * kRun, end, parts[run]);
    });
    LightHarmonics total(degree);
    for (const LightHarmonics& part : parts)
        total += part;
    return total;
}

} // namespace ibl
