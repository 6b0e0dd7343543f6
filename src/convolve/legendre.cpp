#include "convolve/legendre.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ibl {
namespace {

constexpr double kPi = std::numbers::pi;

/// Values below 2^-kNegligible are not summed; each carries a factor 2^(kStep * exponent) with
/// exponent <= 0 and is summed when that is 0.
constexpr int kNegligible = 100;
constexpr int kStep = 512;

/// Factors of the step from l to l + 2: P_(l+2) = (a x^2 - b) P_l - c P_(l-2).
struct Step {
    double a, b, c;
};

std::vector<Step> stepsOf(int m, int degree) {
    const auto epsilon = [m](double l) {
        return std::sqrt((l * l - 1.0 * m * m) / (4 * l * l - 1));
    };
    std::vector<Step> steps(static_cast<std::size_t>(degree - m + 1));
    double before = 0, here = 0, after = epsilon(m + 1); // e_(l-1), e_l, e_(l+1); e_m = 0
    for (int l = m; l <= degree; ++l) {
        const double next = epsilon(l + 2), a = 1 / (after * next);
        steps[l - m] = {a, a * (after * after + here * here), a * here * before};
        before = here;
        here = after;
        after = next;
    }
    return steps;
}

/// log2 of P_mm / sin^m theta = sqrt((2m+1)!! / (4 pi (2m)!!)).
double log2Sectoral(int m) {
    return 0.5 * ((std::lgamma(2.0 * m + 2) - 2 * std::lgamma(m + 1.0)) / std::numbers::ln2 -
                  2.0 * m - std::log2(4 * kPi));
}

/// The two latest values of one parity's recurrence on V vectors of ring pairs.
template <int V>
struct Chain {
    Lanes previous[V];
    Lanes current[V];
    Lanes x_squared[V];
    LaneMask exponent[V];
};

/// Start of the chain of l - m even (parity 0: P_mm) or odd (P_(m+1)m = sqrt(2m + 3) x P_mm).
template <int V>
IBL_INLINE void startChain(Chain<V>& chain, const RingGeometry& rings, int first, int m, int parity,
                           double log2_sectoral) {
    for (int v = 0; v < V; ++v) {
        chain.x_squared[v] = rings.x_squared[first + v];
        chain.previous[v] = Lanes{};
        for (int i = 0; i < kLanes; ++i) {
            const double log2_value =
                log2_sectoral +
                m * rings.log2_sin[static_cast<std::size_t>(first + v) * kLanes + i];
            const double e = std::min(0.0, std::floor((log2_value + kNegligible) / kStep));
            chain.exponent[v][i] = static_cast<std::int64_t>(e);
            chain.current[v][i] = std::exp2(log2_value - kStep * e);
        }
        if (parity == 1) chain.current[v] *= std::sqrt(2.0 * m + 3) * rings.x[first + v];
    }
}

template <int V>
IBL_INLINE void advance(Chain<V>& chain, const Step& step) {
    for (int v = 0; v < V; ++v) {
        const Lanes next =
            (step.a * chain.x_squared[v] - step.b) * chain.current[v] - step.c * chain.previous[v];
        chain.previous[v] = chain.current[v];
        chain.current[v] = next;
    }
}

/// Moves factors of 2^kStep from values that have grown into their exponents. Returns whether every
/// lane now counts.
template <int V>
IBL_INLINE bool renormalise(Chain<V>& chain) {
    bool all = true;
    for (int v = 0; v < V; ++v) {
        for (int i = 0; i < kLanes; ++i) {
            if (chain.exponent[v][i] == 0) continue;
            if (std::abs(chain.current[v][i]) > 0x1p412) {
                chain.current[v][i] *= 0x1p-512;
                chain.previous[v][i] *= 0x1p-512;
                chain.exponent[v][i] += 1;
            }
            all = all && chain.exponent[v][i] == 0;
        }
    }
    return all;
}

/// The values that count: those whose exponent is 0.
template <int V>
IBL_INLINE void liveValues(const Chain<V>& chain, Lanes* live) {
    for (int v = 0; v < V; ++v) {
        live[v] = chain.exponent[v] == 0 ? chain.current[v] : Lanes{};
    }
}

/// sums[l][part] += P_l g_part over V vectors of pairs. `g` is [part][v].
template <int V>
IBL_INLINE void analyseChain(Chain<V>& chain, const std::vector<Step>& steps, const Lanes* g,
                             int parity, int count, Lanes* sums) {
    bool all = renormalise(chain);
    for (int i = parity; i < count; i += 2) {
        Lanes live[V];
        if (all)
            std::copy(chain.current, chain.current + V, live);
        else
            liveValues(chain, live);
        Lanes* sum = sums + static_cast<std::ptrdiff_t>(i) * kParts;
        for (int part = 0; part < kParts; ++part) {
            Lanes total = sum[part];
            for (int v = 0; v < V; ++v)
                total += live[v] * g[part * V + v];
            sum[part] = total;
        }
        advance(chain, steps[i]);
        if (!all) all = renormalise(chain);
    }
}

/// g[part][v] = sum over l of coefficients[l][part] P_l.
template <int V>
IBL_INLINE void synthesiseChain(Chain<V>& chain, const std::vector<Step>& steps,
                                const Parts* coefficients, int parity, int count, Lanes* g) {
    Lanes sum[kParts][V] = {};
    bool all = renormalise(chain);
    for (int i = parity; i < count; i += 2) {
        Lanes live[V];
        if (all)
            std::copy(chain.current, chain.current + V, live);
        else
            liveValues(chain, live);
        for (int part = 0; part < kParts; ++part) {
            for (int v = 0; v < V; ++v)
                sum[part][v] += live[v] * coefficients[i][part];
        }
        advance(chain, steps[i]);
        if (!all) all = renormalise(chain);
    }
    for (int part = 0; part < kParts; ++part) {
        for (int v = 0; v < V; ++v)
            g[part * V + v] = sum[part][v];
    }
}

/// Above this order nothing on a ring of that sine reaches 2^-kNegligible by the last degree: P_lm
/// falls off exponentially once m exceeds l sin theta (Reinecke and Seljebotn 2013, section 2.3).
bool negligible(int m, int degree, double sin_theta) {
    return m > degree * sin_theta + std::max(100.0, 0.01 * degree);
}

struct AnalysisTask {
    const RingGeometry& rings;
    const std::vector<Step>& steps;
    const Lanes* even; ///< [part][vector]: sum of a pair's rings, weighted
    const Lanes* odd;  ///< their difference
    int m;
    int degree;
    double log2_sectoral;
};

template <int V>
IBL_INLINE void analyseBlock(const AnalysisTask& task, int first, Lanes* sums) {
    const int vectors = task.rings.rings / (2 * kLanes);
    if (negligible(task.m, task.degree, task.rings.sin[(first + V) * kLanes - 1])) return;
    for (int parity = 0; parity < 2; ++parity) {
        Lanes g[kParts * V];
        for (int part = 0; part < kParts; ++part) {
            for (int v = 0; v < V; ++v) {
                g[part * V + v] = (parity == 0 ? task.even : task.odd)[part * vectors + first + v];
            }
        }
        Chain<V> chain;
        startChain(chain, task.rings, first, task.m, parity, task.log2_sectoral);
        analyseChain(chain, task.steps, g, parity, task.degree - task.m + 1, sums);
    }
}

IBL_MULTIVERSION
void analyseRings(const AnalysisTask& task, Lanes* sums) {
    const int vectors = task.rings.rings / (2 * kLanes);
    int first = 0;
    for (; first + 4 <= vectors; first += 4)
        analyseBlock<4>(task, first, sums);
    for (; first < vectors; ++first)
        analyseBlock<1>(task, first, sums);
}

struct SynthesisTask {
    const RingGeometry& rings;
    const std::vector<Step>& steps;
    const Parts* coefficients; ///< k_l f_lm, l = m .. degree
    int m;
    int degree;
    double log2_sectoral;
};

template <int V>
IBL_INLINE void synthesiseBlock(const SynthesisTask& task, int first, Lanes* even, Lanes* odd) {
    const int vectors = task.rings.rings / (2 * kLanes);
    const bool skip = negligible(task.m, task.degree, task.rings.sin[(first + V) * kLanes - 1]);
    for (int parity = 0; parity < 2; ++parity) {
        Lanes g[kParts * V] = {};
        if (!skip) {
            Chain<V> chain;
            startChain(chain, task.rings, first, task.m, parity, task.log2_sectoral);
            synthesiseChain(chain, task.steps, task.coefficients, parity, task.degree - task.m + 1,
                            g);
        }
        for (int part = 0; part < kParts; ++part) {
            for (int v = 0; v < V; ++v) {
                (parity == 0 ? even : odd)[part * vectors + first + v] = g[part * V + v];
            }
        }
    }
}

IBL_MULTIVERSION
void synthesiseRings(const SynthesisTask& task, Lanes* even, Lanes* odd) {
    const int vectors = task.rings.rings / (2 * kLanes);
    int first = 0;
    for (; first + 2 <= vectors; first += 2)
        synthesiseBlock<2>(task, first, even, odd);
    for (; first < vectors; ++first)
        synthesiseBlock<1>(task, first, even, odd);
}

} // namespace

RingGeometry makeRings(int rings) {
    RingGeometry geometry;
    geometry.rings = rings;
    const int pairs = rings / 2;
    geometry.x.resize(static_cast<std::size_t>(pairs / kLanes));
    geometry.x_squared.resize(geometry.x.size());
    geometry.sin.resize(static_cast<std::size_t>(pairs));
    geometry.log2_sin.resize(geometry.sin.size());
    for (int r = 0; r < pairs; ++r) {
        const double theta = kPi * (r + 0.5) / rings, x = std::cos(theta);
        geometry.x[r / kLanes][r % kLanes] = x;
        geometry.x_squared[r / kLanes][r % kLanes] = x * x;
        geometry.sin[r] = std::sin(theta);
        geometry.log2_sin[r] = std::log2(geometry.sin[r]);
    }
    return geometry;
}

int ringsFor(int degree) {
    // Twice as many points on the great circle must also make a good Fourier length.
    for (int q = (degree + 2 + 2 * kLanes - 1) / (2 * kLanes);; ++q) {
        int rest = q;
        for (const int p : {2, 3, 5}) {
            while (rest % p == 0)
                rest /= p;
        }
        if (rest == 1) return 2 * kLanes * q;
    }
}

void legendreAnalysis(const RingGeometry& rings, const double* rings_of_m, int m,
                      Harmonics& harmonics) {
    const int pairs = rings.rings / 2, count = harmonics.degree - m + 1;
    const std::size_t vectors = static_cast<std::size_t>(pairs / kLanes);
    LaneVector<Lanes> even(kParts * vectors), odd(kParts * vectors);
    for (int part = 0; part < kParts; ++part) {
        const double* g = rings_of_m + static_cast<std::ptrdiff_t>(part) * rings.rings;
        for (int r = 0; r < pairs; ++r) {
            const double w = kPi / rings.rings * rings.sin[r];
            const std::size_t v = part * vectors + r / kLanes;
            even[v][r % kLanes] = w * (g[r] + g[rings.rings - 1 - r]);
            odd[v][r % kLanes] = w * (g[r] - g[rings.rings - 1 - r]);
        }
    }
    const std::vector<Step> steps = stepsOf(m, harmonics.degree);
    LaneVector<Lanes> sums(static_cast<std::size_t>(count) * kParts, Lanes{});
    analyseRings({rings, steps, even.data(), odd.data(), m, harmonics.degree, log2Sectoral(m)},
                 sums.data());
    Parts* out = &harmonics.at(m, m);
    for (int i = 0; i < count; ++i) {
        for (int part = 0; part < kParts; ++part) {
            const Lanes& sum = sums[static_cast<std::size_t>(i) * kParts + part];
            double total = 0;
            for (int lane = 0; lane < kLanes; ++lane)
                total += sum[lane];
            out[i][part] = total;
        }
    }
}

void legendreSynthesis(const RingGeometry& rings, const Harmonics& harmonics, const double* scale,
                       int degree, int m, double* rings_of_m) {
    const int pairs = rings.rings / 2;
    const std::size_t vectors = static_cast<std::size_t>(pairs / kLanes);
    std::vector<Parts> scaled(static_cast<std::size_t>(degree - m + 1));
    const Parts* f = &harmonics.at(m, m);
    for (int l = m; l <= degree; ++l) {
        for (int part = 0; part < kParts; ++part)
            scaled[l - m][part] = scale[l] * f[l - m][part];
    }
    const std::vector<Step> steps = stepsOf(m, degree);
    LaneVector<Lanes> even(kParts * vectors), odd(kParts * vectors);
    synthesiseRings({rings, steps, scaled.data(), m, degree, log2Sectoral(m)}, even.data(),
                    odd.data());
    for (int part = 0; part < kParts; ++part) {
        double* g = rings_of_m + static_cast<std::ptrdiff_t>(part) * rings.rings;
        for (int r = 0; r < pairs; ++r) {
            const double e = even[part * vectors + r / kLanes][r % kLanes];
            const double o = odd[part * vectors + r / kLanes][r % kLanes];
            g[r] = e + o;
            g[rings.rings - 1 - r] = e - o;
        }
    }
}

} // namespace ibl
