#include "convolve/evaluate.h"

#include "core/parallel.h"
#include "panorama/conventions.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

/// Thetas in [0, pi / 2] less apart than this are one: waves of any degree differ by less than
/// 1e-9 there.
constexpr double kSameTheta = 1e-13;

/// The points' different thetas, folded to the upper half, and which of them each point has.
struct Thetas {
    std::vector<double> different;
    std::vector<std::size_t> of_point;
};

Thetas differentThetas(const double* v, std::size_t n) {
    Thetas thetas;
    std::vector<double> folded(n);
    for (std::size_t i = 0; i < n; ++i)
        folded[i] = kPi * std::min(v[i], 1 - v[i]);
    std::vector<double> sorted = folded;
    std::ranges::sort(sorted);
    for (const double theta : sorted) {
        std::vector<double>& different = thetas.different;
        if (!different.empty() && theta - different.back() <= kSameTheta) continue;
        // No group has thetas from either side of pi / 4: those near the pole are reckoned apart.
        const bool crosses = !different.empty() && different.back() < kPi / 4 && theta >= kPi / 4;
        while (crosses && different.size() % kPairGroup != 0)
            different.push_back(different.back());
        different.push_back(theta);
    }
    for (const double theta : folded) {
        const auto above = std::ranges::upper_bound(thetas.different, theta);
        thetas.of_point.push_back(static_cast<std::size_t>(above - thetas.different.begin() - 1));
    }
    return thetas;
}

/// Adds 2 Re g_m exp(i m psi), m = 0 once, over all m: g[m][even, odd][part][pair].
IBL_MULTIVERSION
void sumOrders(const double* g, int degree, std::ptrdiff_t pairs, bool lower, double psi,
               double* out) {
    const double step_re = std::cos(psi), step_im = std::sin(psi), sign = lower ? -1 : 1;
    double re = 1, im = 0;
    for (int m = 0; m <= degree; ++m, g += 2 * kParts * pairs) {
        const double weight = m == 0 ? 1 : 2;
        for (int c = 0; c < 3; ++c) {
            const double *part = g + 2 * c * pairs, *odd = part + kParts * pairs;
            const double g_re = part[0] + sign * odd[0], g_im = part[pairs] + sign * odd[pairs];
            out[c] += weight * (g_re * re - g_im * im);
        }
        const double next = re * step_re - im * step_im;
        im = re * step_im + im * step_re;
        re = next;
    }
}

} // namespace

void evaluateField(const Harmonics& harmonics, const std::vector<double>& scale, int degree,
                   const double* u, const double* v, std::size_t n, int threads, double* out) {
    if (n == 0) return;
    const Thetas thetas = differentThetas(v, n);
    const RingPairs pairs = makePairs(thetas.different);
    const std::size_t column = static_cast<std::size_t>(2 * kParts) * pairs.pairs;
    LaneVector<double> g(column * (degree + 1));
    constexpr int kOrders = 8;
    parallelFor(degree / kOrders + 1, threads, [&](std::size_t group) {
        const int first = static_cast<int>(group) * kOrders;
        legendreSynthesis(pairs, harmonics, scale.data(), degree, first,
                          std::min(kOrders, degree + 1 - first), g.data() + first * column);
    });
    constexpr std::size_t kPointsAtOnce = 64;
    parallelForRuns(n, kPointsAtOnce, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            std::fill_n(out + 3 * i, 3, 0.0);
            sumOrders(g.data() + thetas.of_point[i], degree, pairs.pairs, v[i] > 0.5,
                      2 * kPi * u[i], out + 3 * i);
        }
    });
}

bool evaluationIsCheaper(int degree, std::size_t points) {
    // Measured with the points of cube maps.
    return points < 4 * static_cast<std::size_t>(degree);
}

std::size_t mapPoints(Layout layout, const Image& map, const Footprint& footprint) {
    const auto samples = static_cast<std::size_t>(
        footprintOfTexel(footprint, layout, map.width, 0, map.height / 2).samples);
    return static_cast<std::size_t>(map.width) * map.height * samples * samples;
}

MapValues evaluateMap(const Harmonics& harmonics, const std::vector<double>& scale, int degree,
                      Layout layout, int width, int height, const Footprint& footprint,
                      int threads) {
    MapValues result;
    std::vector<double> u, v;
    result.rows.resize(static_cast<std::size_t>(height));
    parallelFor(result.rows.size(), threads, [&](std::size_t y) {
        result.rows[y] = rowPoints(layout, width, height, static_cast<int>(y), footprint);
    });
    for (const RowPoints& points : result.rows) {
        result.first.push_back(u.size());
        u.insert(u.end(), points.u.begin(), points.u.end());
        v.insert(v.end(), points.v.begin(), points.v.end());
    }
    result.values.resize(3 * u.size());
    evaluateField(harmonics, scale, degree, u.data(), v.data(), u.size(), threads,
                  result.values.data());
    return result;
}

} // namespace ibl
