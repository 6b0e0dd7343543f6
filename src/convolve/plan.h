// Which band limit, how many peaks, which method: decided before any work, from the asked error.
//
// Cutting K at degree B leaves, over the sphere (Parseval),
//
//     || (K - K_B) * L ||^2 = sum over l > B of k_l^2 S_l
//                          <= max over l > B of k_l^2 * (int L^2 - sum over l <= B of S_l),
//
// S_l the energy of the probe's degree l. This bound needs no model of the probe; before the
// analysis its last factor is taken as the whole int L^2. Splitting peaks off makes that smaller,
// at the price of (texels x peaks) evaluations of the lobe. The cheapest of a few numbers of peaks
// is taken, by the costs measured in tests/bench/convolve.
#pragma once

#include "convolve/peaks.h"
#include "convolve/prefilter.h"

#include <span>
#include <vector>

namespace ibl {

enum class Method {
    area,      ///< mirrors: the area-filtered probe
    harmonics, ///< a band limit, and the peaks directly
    narrow,    ///< the lobe's tail in harmonics, its core in space (narrow.h)
};

/// Degree of the far part of Method::narrow. With 768 or 1024 the near part reaches less far, but
/// takes the same time within a tenth, for twice and three times the memory.
inline constexpr int kNarrowDegree = 512;

/// The same of lobes that see a probe's own texels (near_own_texels.h): what is read into a
/// lat-long is exact to lower degrees than that has rows.
inline constexpr int kDegreeOfTails = 64;

struct LobePlan {
    Method method = Method::harmonics;
    int degree = 0;
    std::vector<double> k; ///< coefficients, more than `degree` of them
    double allowed = 0;    ///< for Method::narrow: the largest coefficient that may be left out
};

/// For requests that share an analysis.
struct Plan {
    std::vector<std::size_t> requests; ///< which they are
    double threshold = 0;              ///< for the analysis that Method::harmonics uses
    int peaks = 0;
    int degree = 0;              ///< of that analysis
    std::vector<LobePlan> lobes; ///< of each of them
};

/// `source` is what the lat-long was read from, if it was. One for all requests, or two: a wide
/// lobe's horizon may need a thousand peaks, which at all of a large map's texels, for a narrower
/// lobe that needs none, take a hundred times as long as an analysis of their own.
std::vector<Plan> makePlans(const ProbeStatistics& probe,
                            std::span<const PrefilterRequest> requests, double max_error,
                            int probe_width, const Panorama* source, int threads);

/// Least degree, up to `most`, whose truncation bound is at most `allowed`; `energy_beyond(B)` is
/// the probe's energy beyond degree B. `most` + 1 when there is none.
int leastDegree(const std::vector<double>& k, int most, double allowed,
                const std::vector<double>& energy_beyond);

/// max |k_i| over i > l, for l = 0 .. k.size() - 1; the last entries stand for all that follow.
std::vector<double> tailMaximum(const std::vector<double>& k);

/// The norm over the sphere that errors are measured against: not more than that of the result, and
/// for suns, whose result is a spot, a few times the mean, so that the dark around it is right too.
double referenceNorm(const ProbeStatistics& probe, const std::vector<double>& k);

/// The norm over the sphere that an output's truncation may have for its bound to keep the asked
/// relative RMSE: half of it, and less where texels are few.
double allowedNorm(const ProbeStatistics& probe, const PrefilterRequest& request,
                   const std::vector<double>& k, double max_error);

} // namespace ibl
