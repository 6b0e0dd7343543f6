#include "lights/harmonic_sums.h"

#include "lights/lit_lanes.h"
#include "panorama/conventions.h"

#include <cmath>
#include <utility>

namespace ibl {
namespace {

/// P_(l+1)m = a (x P_lm - b P_(l-1)m).
struct Step {
    double a, b;
};

/// The recurrence's steps from l = m on, two more than lead to the degree.
///     a = sqrt((4 n^2 - 1) / (n^2 - m^2)) with n = l + 1, and b is 1 over the a before.
std::vector<Step> stepsOf(int m, int degree) {
    std::vector<Step> steps;
    double b = 0;
    for (int l = m; l <= degree + 1; ++l) {
        const double n = l + 1.0;
        const double a = std::sqrt((4 * n * n - 1) / (n * n - double{1} * m * m));
        steps.push_back({a, b});
        b = 1 / a;
    }
    return steps;
}

/// Adds P wave of all sources and goes two degrees on.
IBL_MULTIVERSION
void addDegree(HarmonicSources& s, const Step* steps, LightHarmonics::Parts& to) {
    Lanes sums[6]{};
    double *now = s.now.data(), *before = s.before.data();
    const double* x = s.x.data();
    const double* wave[6];
    for (std::size_t k = 0; k < 6; ++k)
        wave[k] = s.wave[k].data();
    for (std::size_t i = 0; i < s.size; i += kLanes) {
        const Lanes cosine = loadLanes(x + i), p = loadLanes(now + i);
        for (std::size_t k = 0; k < 6; ++k)
            sums[k] += p * loadLanes(wave[k] + i);
        const Lanes p1 = steps[0].a * (cosine * p - steps[0].b * loadLanes(before + i));
        const Lanes p2 = steps[1].a * (cosine * p1 - steps[1].b * p);
        __builtin_memcpy(before + i, &p1, sizeof p1);
        __builtin_memcpy(now + i, &p2, sizeof p2);
    }
    for (std::size_t k = 0; k < 6; ++k)
        to[k] += sumOf(sums[k]);
}

} // namespace

HarmonicSources::HarmonicSources(std::size_t count)
    : size((count + kLanes - 1) / kLanes * kLanes),
      x(size, 0.0),
      sine(size, 0.0),
      sectoral(size, std::sqrt(1 / (4 * kPi))),
      now(size),
      before(size) {
    for (std::vector<double>& values : wave)
        values.assign(size, 0.0);
}

void addOrder(HarmonicSources& sources, int m, int degree, LightHarmonics::Parts* even) {
    const std::vector<Step> steps = stepsOf(m, degree);
    const int odd = m % 2;
    for (std::size_t i = 0; i < sources.size; ++i) {
        const double p = sources.sectoral[i];
        sources.before[i] = odd ? p : 0.0;
        sources.now[i] = odd ? steps[0].a * sources.x[i] * p : p;
    }
    for (int l = m + odd; l <= degree; l += 2)
        addDegree(sources, &steps[static_cast<std::size_t>(l - m)], *even++);
}

void raiseSectoral(HarmonicSources& sources, int m) {
    const double factor = std::sqrt((2.0 * m + 3) / (2.0 * m + 2));
    for (std::size_t i = 0; i < sources.size; ++i)
        sources.sectoral[i] *= sources.sine[i] * factor;
}

} // namespace ibl
