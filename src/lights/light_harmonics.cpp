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

using LaneParts = std::array<Lanes, 6>;

LightHarmonics::Parts sum(const LaneParts& parts) {
    LightHarmonics::Parts total;
    for (std::size_t i = 0; i < total.size(); ++i)
        total[i] = sum(parts[i]);
    return total;
}

/// Lights with what changes from one order m to the next.
struct Group {
    LightLanes lanes;
    Lanes sectoral; ///< P_mm
    Lanes re, im;   ///< exp(-i m psi)
};

void addColumn(const Group& group, int m, int degree, std::vector<LaneParts>& even,
               LaneParts& first) {
    LaneParts wave;
    for (std::size_t c = 0; c < 3; ++c) {
        wave[2 * c] = group.lanes.colour[c] * group.re;
        wave[2 * c + 1] = group.lanes.colour[c] * group.im;
    }
    LaneParts* out = even.data();
    legendreColumn(m, degree, group.lanes.x, group.sectoral, [&](int l, const Lanes& p) {
        if (l != 1 && l % 2 != 0) return;
        LaneParts& to = l == 1 ? first : *out++;
        for (std::size_t i = 0; i < to.size(); ++i)
            to[i] += p * wave[i];
    });
}

void advance(Group& group, int m) {
    const LightLanes& lanes = group.lanes;
    const double next = m + 1;
    group.sectoral *= lanes.sine * std::sqrt((2 * next + 1) / (2 * next));
    const Lanes turned = group.re * lanes.cos_psi + group.im * lanes.sin_psi;
    group.im = group.im * lanes.cos_psi - group.re * lanes.sin_psi;
    group.re = turned;
}

/// Lights [begin, end): order by order, so that the sums of one order stay in the cache.
void addLights(const std::vector<Light>& lights, std::size_t begin, std::size_t end,
               LightHarmonics& harmonics) {
    const Lanes zero{};
    std::vector<Group> groups;
    for (std::size_t i = begin; i < end; i += kLanes)
        groups.push_back({load(lights, i), zero + std::sqrt(1 / (4 * kPi)), zero + 1, zero});
    const std::size_t rows = static_cast<std::size_t>(harmonics.degree / 2) + 1;
    for (int m = 0; m <= harmonics.degree; ++m) {
        std::vector<LaneParts> even(rows, LaneParts{});
        LaneParts first{};
        for (Group& group : groups) {
            addColumn(group, m, harmonics.degree, even, first);
            advance(group, m);
        }
        const std::size_t column = harmonics.column(m);
        for (std::size_t i = 0; i + static_cast<std::size_t>(m + 1) / 2 < rows; ++i)
            harmonics.even[column + i] = sum(even[i]);
        if (m < 2) harmonics.first[static_cast<std::size_t>(m)] = sum(first);
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
        addLights(lights, run * kRun, end, parts[run]);
    });
    LightHarmonics total(degree);
    for (const LightHarmonics& part : parts)
        total += part;
    return total;
}

} // namespace ibl
