#include "lights/light_harmonics.h"

#include "core/parallel.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

/// Lights are taken a few at a time, one to a lane.
constexpr int kLanes = 8;
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));

double sum(const Lanes& v) {
    double total = 0;
    for (int k = 0; k < kLanes; ++k)
        total += v[k];
    return total;
}

struct LightLanes {
    Lanes x{}, sine{}, cos_psi{}, sin_psi{};
    Lanes colour[3]{};
};

LightLanes load(const std::vector<Light>& lights, std::size_t begin) {
    LightLanes lanes;
    for (int k = 0; k < kLanes && begin + k < lights.size(); ++k) {
        const Light& light = lights[begin + k];
        const V3d& d = light.direction;
        const double sine = std::hypot(d.x, d.z);
        lanes.x[k] = d.y;
        lanes.sine[k] = sine;
        // psi = 2 pi u = pi - atan2(x, z).
        lanes.cos_psi[k] = sine > 0 ? -d.z / sine : 1;
        lanes.sin_psi[k] = sine > 0 ? d.x / sine : 0;
        for (int c = 0; c < 3; ++c)
            lanes.colour[c][k] = light.irradiance[c];
    }
    return lanes;
}

void add(const Lanes& p, const Lanes (&wave)[6], LightHarmonics::Parts& out) {
    for (int i = 0; i < 6; ++i)
        out[static_cast<std::size_t>(i)] += sum(p * wave[i]);
}

void addLanes(const LightLanes& lanes, LightHarmonics& harmonics) {
    Lanes sectoral = lanes.x * 0 + std::sqrt(1 / (4 * kPi)); // P_00
    Lanes re = lanes.x * 0 + 1, im = lanes.x * 0;            // exp(-i m psi)
    for (int m = 0; m <= harmonics.degree; ++m) {
        Lanes wave[6];
        for (int c = 0; c < 3; ++c) {
            wave[2 * c] = lanes.colour[c] * re;
            wave[2 * c + 1] = lanes.colour[c] * im;
        }
        LightHarmonics::Parts* out = harmonics.even.data() + harmonics.column(m);
        legendreColumn(m, harmonics.degree, lanes.x, sectoral, [&](int l, const Lanes& p) {
            if (l == 1) add(p, wave, harmonics.first[static_cast<std::size_t>(m)]);
            if (l % 2 == 0) add(p, wave, *out++);
        });
        const double next = m + 1;
        sectoral *= lanes.sine * std::sqrt((2 * next + 1) / (2 * next));
        const Lanes turned = re * lanes.cos_psi + im * lanes.sin_psi;
        im = im * lanes.cos_psi - re * lanes.sin_psi;
        re = turned;
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
    return count <= 1024 ? 64 : 128;
}

LightHarmonics lightHarmonics(const std::vector<Light>& lights, int degree, int threads) {
    constexpr std::size_t kRun = 256; // a multiple of kLanes
    const std::size_t runs = (lights.size() + kRun - 1) / kRun;
    std::vector<LightHarmonics> parts(runs, LightHarmonics(degree));
    parallelFor(runs, threads, [&](std::size_t run) {
        const std::size_t end = std::min(lights.size(), (run + 1) * kRun);
        for (std::size_t i = run * kRun; i < end; i += kLanes)
            addLanes(load(lights, i), parts[run]);
    });
    LightHarmonics total(degree);
    for (const LightHarmonics& part : parts)
        total += part;
    return total;
}

} // namespace ibl
