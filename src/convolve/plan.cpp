#include "convolve/plan.h"

#include "convolve/error_bound.h"
#include "convolve/near_own_texels.h"
#include "convolve/texels.h"
#include "core/parallel.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace ibl {
namespace {

/// Highest degrees, by the cost of the Legendre sums, which grows with the cube: a wide lobe that
/// needs more has a horizon, against which only peaks help; a narrow one is worth 3 s of one core.
constexpr int kMostDegree = 768;
constexpr int kMostDegreeOfNarrow = 1536;
/// More peaks than these cost more than a second analysis.
constexpr int kManyPeaks = 64;
/// Coefficients known beyond it, from which the tail's envelope is read.
constexpr int kTailBands = 64;

/// Nanoseconds on one core, measured.
struct Costs {
    static constexpr double kLegendre = 0.4;     ///< a cubed degree, analysis or synthesis
    static constexpr double kGrid = 300;         ///< a squared degree: transforms of the synthesis
    static constexpr double kPeak = 10;          ///< a peak and a point, of a rational lobe,
    static constexpr double kPeakOfOthers = 170; ///< of other lobes,
    static constexpr double kPeakEdges = 800;    ///< or by edges, where lobes are narrow
    static constexpr double kPeakOutlines = 1e5; ///< a peak and a texel (peak_map.h)
};

/// What half the error is worth where the asked one cannot be kept within kMostDegree.
constexpr double kUnmet = 3e9;

/// Whether what harmonics cannot hold of a lobe is its core, not its horizon.
bool isNarrow(const Lobe& lobe) {
    return lobeWidth(lobe) < 0.1;
}

int mostDegree(const Lobe& lobe) {
    return isNarrow(lobe) ? kMostDegreeOfNarrow : kMostDegree;
}

/// Cost of the plan's harmonic lobes when each needs degree degrees[i], or is `over[i]` times off
/// what is allowed, and `peaks` are split from a probe whose pixels are `pixel` radians wide.
double costOf(const std::vector<int>& degrees, const std::vector<double>& over,
              std::span<const PrefilterRequest> requests, int peaks, double pixel) {
    const auto cube = [](double d) { return d * d * d; };
    double cost = 0;
    int most = 0;
    for (std::size_t i = 0; i < degrees.size(); ++i) {
        if (degrees[i] < 0) continue;
        const double d = degrees[i];
        if (d > mostDegree(requests[i].lobe)) cost += kUnmet * (1 + std::log2(over[i]));
        cost += Costs::kLegendre * cube(d) + Costs::kGrid * d * d;
        const Footprint footprint =
            footprintOf(requests[i].lobe, texelAngle(requests[i]), kAnyDegree);
        const bool smooth = 2 * pixel < lobeWidth(requests[i].lobe);
        const double each = !smooth                          ? Costs::kPeakEdges
                            : rationalLobe(requests[i].lobe) ? Costs::kPeak
                                                             : Costs::kPeakOfOthers;
        const double at_points = each * footprint.samples * footprint.samples;
        cost +=
            (isCrossedByHorizons(requests[i].lobe, footprint) ? Costs::kPeakOutlines : at_points) *
            peaks * texelCount(requests[i]);
        most = std::max(most, degrees[i]);
    }
    return cost + Costs::kLegendre * cube(most);
}

} // namespace

std::vector<double> tailMaximum(const std::vector<double>& k) {
    std::vector<double> tail(k.size());
    // The envelope beyond the table is not above that of its last few entries.
    double most = 0;
    for (std::size_t i = k.size() - std::min<std::size_t>(k.size(), 8); i < k.size(); ++i) {
        most = std::max(most, std::abs(k[i]));
    }
    for (std::size_t l = k.size(); l-- > 0;) {
        tail[l] = most;
        most = std::max(most, std::abs(k[l]));
    }
    return tail;
}

int leastDegree(const std::vector<double>& k, int most, double allowed,
                const std::vector<double>& energy_beyond) {
    const std::vector<double> tail = tailMaximum(k);
    for (int l = 1; l <= most; ++l) {
        const std::size_t e = std::min<std::size_t>(l, energy_beyond.size() - 1);
        if (tail[l] * std::sqrt(energy_beyond[e]) <= allowed) return l;
    }
    return most + 1;
}

double referenceNorm(const ProbeStatistics& probe, const std::vector<double>& k) {
    double kernel = 0; // int K^2
    for (std::size_t l = 0; l < k.size(); ++l)
        kernel += (2.0 * l + 1) / (4 * kPi) * k[l] * k[l];
    double mean = 0; // norm of the constant field of the mean
    for (const double a : probe.absolute)
        mean += a * a / (4 * kPi);
    // Pixels are taken as apart from one another, which for non-negative probes only makes it less:
    // smaller than the lobe each is a spot of the lobe's shape, larger than it its own.
    const double small = kernel * probe.squares;
    const double spots = small > 0 ? small * probe.energy / (small + probe.energy) : 0;
    return std::min(std::sqrt(std::max(mean, spots)), 4 * std::sqrt(mean));
}

double allowedNorm(const ProbeStatistics& probe, const PrefilterRequest& request,
                   const std::vector<double>& k, double max_error) {
    const auto texels = static_cast<std::size_t>(texelCount(request));
    return 0.5 * max_error * referenceNorm(probe, k) / roomFor(texels);
}

namespace {

Plan planTogether(const ProbeStatistics& probe, std::span<const PrefilterRequest> requests,
                  double max_error, int probe_width, const Panorama* source, int threads) {
    Plan plan;
    plan.requests.resize(requests.size());
    std::iota(plan.requests.begin(), plan.requests.end(), std::size_t{0});
    plan.lobes.resize(requests.size());
    std::vector<double> allowed(requests.size());
    parallelFor(requests.size(), threads, [&](std::size_t i) {
        LobePlan& lobe = plan.lobes[i];
        if (isMirror(requests[i].lobe)) {
            lobe.method = Method::area;
            return;
        }
        lobe.k = zonalCoefficients(requests[i].lobe, mostDegree(requests[i].lobe) + kTailBands);
        allowed[i] = allowedNorm(probe, requests[i], lobe.k, max_error);
    });

    double best = std::numeric_limits<double>::infinity();
    std::vector<int> chosen(requests.size(), -1);
    for (const int peaks : {0, 1, 2, 4, 8, 16, 32, 64, 128, 256, kMostPeaks}) {
        const double threshold = peakThreshold(probe, peaks);
        const std::vector<double> energy{clampedEnergy(probe, threshold)};
        std::vector<int> degrees(requests.size(), -1);
        std::vector<double> over(requests.size(), 1);
        for (std::size_t i = 0; i < requests.size(); ++i) {
            if (plan.lobes[i].method == Method::area) continue;
            const int most = mostDegree(requests[i].lobe);
            degrees[i] = leastDegree(plan.lobes[i].k, most, allowed[i], energy);
            if (degrees[i] > most && isNarrow(requests[i].lobe)) degrees[i] = -1;
            if (source && seesOwnTexels(*source, requests[i].lobe)) degrees[i] = -1;
            if (degrees[i] > most)
                over[i] = tailMaximum(plan.lobes[i].k)[most] * std::sqrt(energy[0]) / allowed[i];
        }
        const double cost = costOf(degrees, over, requests, peaks, 2 * kPi / probe_width);
        if (cost >= best) continue;
        best = cost;
        chosen = degrees;
        plan.peaks = peaks;
        plan.threshold = threshold;
        if (energy[0] == 0) break;
    }
    for (std::size_t i = 0; i < requests.size(); ++i) {
        LobePlan& lobe = plan.lobes[i];
        if (lobe.method == Method::area) continue;
        lobe.degree = std::min(chosen[i], mostDegree(requests[i].lobe));
        if (chosen[i] < 0) {
            lobe.method = Method::narrow;
            const bool own = source && seesOwnTexels(*source, requests[i].lobe);
            lobe.degree = own ? kDegreeOfTails : kNarrowDegree;
            lobe.k.resize(static_cast<std::size_t>(lobe.degree + kTailBands));
            lobe.allowed = allowed[i] / std::sqrt(std::max(probe.energy, 1e-300));
        } else {
            plan.degree = std::max(plan.degree, lobe.degree);
        }
    }
    return plan;
}

} // namespace

std::vector<Plan> makePlans(const ProbeStatistics& probe,
                            std::span<const PrefilterRequest> requests, double max_error,
                            int probe_width, const Panorama* source, int threads) {
    const auto together = [&](std::span<const PrefilterRequest> some) {
        return planTogether(probe, some, max_error, probe_width, source, threads);
    };
    const Plan all = together(requests);
    if (all.peaks <= kManyPeaks) return {all};
    std::vector<std::size_t> which[2]; // by whether one needs many peaks by itself
    for (std::size_t i = 0; i < requests.size(); ++i)
        which[together(requests.subspan(i, 1)).peaks > kManyPeaks].push_back(i);
    if (which[0].empty() || which[1].empty()) return {all};
    std::vector<Plan> plans;
    for (const std::vector<std::size_t>& indices : which) {
        std::vector<PrefilterRequest> some;
        for (const std::size_t i : indices)
            some.push_back(requests[i]);
        plans.push_back(together(some));
        plans.back().requests = indices;
    }
    return plans;
}

} // namespace ibl
