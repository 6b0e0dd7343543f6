#include "convolve/legendre.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ibl {
namespace {

constexpr double kPi = std::numbers::pi;

/// A value is mantissa * 2^(kStep * exponent), exponent <= 0, and is summed from when the exponent
/// is 0. Exponents are brought up to date every kDegrees degrees, in which a value grows by less
/// than 2^88; the mantissa is let no higher than 2^324 before, so that nothing above 2^-100 is left
/// out.
constexpr int kStep = 512;
constexpr double kHighest = 0x1p324, kLowest = 0x1p-188, kUnit = 0x1p512;

/// Degrees and pairs done together: their Legendre functions fill half of the nearest cache.
constexpr int kDegrees = 16;
constexpr int kPairs = 128;

/// The recurrence's factors for l = m .. degree, filled up with zeros to a multiple of kDegrees.
///
/// Near the pole x^2 is close to 1, and its rounding moves theta by eps / sin 2 theta, l times
/// which is lost at degree l; near the equator that happens to sin^2 theta. So a x^2 - b is there
/// taken as a (-sin^2 theta) - (b - a).
struct Steps {
    std::vector<double> a, b, b_a, t;
};

IBL_INLINE void makeSteps(int m, int degree, std::vector<double>& e, Steps& steps) {
    const int count = degree - m + 1;
    const std::size_t padded = (count + kDegrees - 1) / kDegrees * kDegrees;
    steps.a.assign(padded, 0.0);
    steps.b.assign(padded, 0.0);
    steps.b_a.assign(padded, 0.0);
    steps.t.assign(padded + 2, 1.0);
    e.resize(static_cast<std::size_t>(count) + 3);
    for (int i = 0; i < count + 3; ++i) { // e_(l-1) stands at i = l - m
        const double l = m + i - 1;
        e[i] = i < 2 ? 0 : std::sqrt((l * l - 1.0 * m * m) / (4 * l * l - 1));
    }
    double* t = steps.t.data();
    for (int i = 0; i < count; ++i) {
        const double down = e[i] * e[i + 1], up = 1 / (e[i + 2] * e[i + 3]);
        t[i + 2] = i < 2 ? 1 : t[i - 2] * (down * up);
        steps.a[i] = up;
        steps.b[i] = e[i + 2] * e[i + 2] + e[i + 1] * e[i + 1];
    }
    for (int i = 0; i < count; ++i) {
        const double a = steps.a[i] * t[i] / t[i + 2];
        steps.a[i] = a;
        steps.b_a[i] = a * (steps.b[i] - 1);
        steps.b[i] *= a;
    }
}

/// P_mm of all pairs, for one m after another.
struct Sectoral {
    int m = 0;
    LaneVector<double> mantissa, exponent;
};

/// P_mm = sqrt((2m+1)!! / (4 pi (2m)!!)) sin^m theta, by long logarithms, so that m times the
/// rounding of log2 sin theta does not show.
Sectoral startSectoral(const RingPairs& rings, int m) {
    const long double factor = 0.5L * ((std::lgamma(2.0L * m + 2) - 2 * std::lgamma(m + 1.0L)) /
                                           std::numbers::ln2_v<long double> -
                                       2.0L * m - std::log2(4 * std::numbers::pi_v<long double>));
    Sectoral start{m, LaneVector<double>(rings.pairs), LaneVector<double>(rings.pairs)};
    for (int p = 0; p < rings.pairs; ++p) {
        const long double value = m == 0 ? factor : factor + m * rings.log2_sin[p];
        // A pole itself (sin theta = 0) has no harmonics but those of m = 0.
        const long double e = std::max(-1e6L, std::min(0.0L, std::floor((value + 188) / kStep)));
        start.exponent[p] = static_cast<double>(e);
        start.mantissa[p] = static_cast<double>(std::exp2(value - kStep * e));
    }
    return start;
}

/// P_(m+1)(m+1) = sqrt((2m + 3) / (2m + 2)) sin theta P_mm.
IBL_INLINE void nextSectoral(const RingPairs& rings, Sectoral& sectoral) {
    const double factor = std::sqrt((2.0 * sectoral.m + 3) / (2.0 * sectoral.m + 2));
    for (int p = 0; p < rings.pairs; ++p) {
        const double next = sectoral.mantissa[p] * factor * rings.sin[p];
        const bool low = next < kLowest;
        sectoral.mantissa[p] = low ? next * kUnit : next;
        sectoral.exponent[p] -= low ? 1 : 0;
    }
    ++sectoral.m;
}

/// The recurrence's state on up to kPairs pairs, in even (0) and odd (1) l - m.
struct Chains {
    alignas(64) double previous[2][kPairs];
    alignas(64) double current[2][kPairs];
    alignas(64) double exponent[kPairs];
    alignas(64) double argument[kPairs];
    int count;                          ///< pairs, a multiple of kPairGroup
    int live;                           ///< first pair of the first group that counts
    bool all_live[kPairs / kPairGroup]; ///< whether all pairs of a group count
};

IBL_INLINE void startChains(const RingPairs& rings, const Sectoral& sectoral, int first, int count,
                            Chains& chains) {
    const double odd = std::sqrt(2.0 * sectoral.m + 3);
    chains.count = count;
    chains.live = count;
    std::fill(std::begin(chains.all_live), std::end(chains.all_live), false);
    for (int p = 0; p < count; ++p) {
        const double value = sectoral.mantissa[first + p];
        chains.argument[p] = rings.argument[first + p];
        chains.exponent[p] = sectoral.exponent[first + p];
        chains.previous[0][p] = chains.previous[1][p] = 0;
        chains.current[0][p] = value;
        chains.current[1][p] = odd * rings.x[first + p] * value; // P_(m+1)m = sqrt(2m+3) x P_mm
    }
}

/// Moves factors of 2^kStep from a group's values that have grown into their exponents; `mask`
/// receives 1 for each pair that counts. Returns how many do.
IBL_INLINE int renormalise(Chains& chains, int group, double* mask) {
    int live = 0;
    for (int p = group; p < group + kPairGroup; ++p) {
        const double size =
            std::max(std::abs(chains.current[0][p]), std::abs(chains.current[1][p]));
        const bool grown = chains.exponent[p] < 0 && size > kHighest;
        const double factor = grown ? 1 / kUnit : 1;
        for (int parity = 0; parity < 2; ++parity) {
            chains.current[parity][p] *= factor;
            chains.previous[parity][p] *= factor;
        }
        chains.exponent[p] += grown ? 1 : 0;
        mask[p - group] = chains.exponent[p] == 0 ? 1 : 0;
        live += chains.exponent[p] == 0 ? 1 : 0;
    }
    return live;
}

template <int Width>
struct VectorOf {
    typedef double Type __attribute__((vector_size(Width * sizeof(double)), may_alias));
};

/// One vector of pairs, of one parity, through kDegrees degrees: values[degree][pair], times `mask`
/// unless all pairs count.
template <int Width, bool All>
IBL_INLINE void advanceVector(double* previous, double* current, const double* argument,
                              const double* mask, const double* a, const double* b,
                              double* values) {
    using Vector = typename VectorOf<Width>::Type;
    const Vector x = *reinterpret_cast<const Vector*>(argument);
    Vector p = *reinterpret_cast<const Vector*>(previous);
    Vector q = *reinterpret_cast<const Vector*>(current);
    const auto put = [&](int i, const Vector& value) {
        Vector& out = *reinterpret_cast<Vector*>(values + i * kPairs);
        if constexpr (All)
            out = value;
        else
            out = value * *reinterpret_cast<const Vector*>(mask);
    };
    for (int i = 0; i < kDegrees; i += 4) {
        put(i, q);
        p = (a[i] * x - b[i]) * q - p;
        put(i + 2, p);
        q = (a[i + 2] * x - b[i + 2]) * p - q;
    }
    *reinterpret_cast<Vector*>(previous) = p;
    *reinterpret_cast<Vector*>(current) = q;
}

/// One group's Legendre functions of kDegrees degrees from m + `from`: values[degree][pair].
template <int Width>
IBL_INLINE void advanceGroup(Chains& chains, const Steps& steps, int from, int group,
                             double (*values)[kPairs]) {
    alignas(64) double mask[kPairGroup];
    bool& all = chains.all_live[group / kPairGroup];
    if (!all) {
        const int live = renormalise(chains, group, mask);
        if (live > 0) chains.live = std::min(chains.live, group);
        all = live == kPairGroup;
    }
    const bool near_pole = std::signbit(chains.argument[group]); // at a pole it is -0
    const double *a = steps.a.data() + from, *b = (near_pole ? steps.b_a : steps.b).data() + from;
    for (int v = 0; v < kPairGroup; v += Width) {
        for (int parity = 0; parity < 2; ++parity) {
            double *previous = chains.previous[parity] + group + v,
                   *current = chains.current[parity] + group + v, *out = values[parity] + group + v;
            const double* argument = chains.argument + group + v;
            if (all)
                advanceVector<Width, true>(previous, current, argument, mask + v, a + parity,
                                           b + parity, out);
            else
                advanceVector<Width, false>(previous, current, argument, mask + v, a + parity,
                                            b + parity, out);
        }
    }
}

template <int Width>
IBL_INLINE void advance(Chains& chains, const Steps& steps, int from, double (*values)[kPairs]) {
    for (int group = 0; group < chains.count; group += kPairGroup)
        advanceGroup<Width>(chains, steps, from, group, values);
}

/// sums[degree][part] += over pairs of values[degree][pair] g[part][pair], for four degrees of one
/// parity and three parts: twelve sums in registers.
template <int Width>
IBL_INLINE void sumPairs(const Chains& chains, const double (*values)[kPairs], const double* g,
                         std::ptrdiff_t stride, double* sums) {
    using Vector = typename VectorOf<Width>::Type;
    constexpr int kFour = 4, kThree = 3;
    Vector total[kFour][kThree] = {};
    for (int p = chains.live; p < chains.count; p += Width) {
        Vector part[kThree];
        for (int c = 0; c < kThree; ++c)
            part[c] = *reinterpret_cast<const Vector*>(g + c * stride + p);
        for (int i = 0; i < kFour; ++i) {
            const Vector value = *reinterpret_cast<const Vector*>(values[2 * i] + p);
            for (int c = 0; c < kThree; ++c)
                total[i][c] += value * part[c];
        }
    }
    for (int i = 0; i < kFour; ++i) {
        for (int c = 0; c < kThree; ++c) {
            double sum = 0;
            for (int lane = 0; lane < Width; ++lane)
                sum += total[i][c][lane];
            sums[2 * i * kParts + c] += sum;
        }
    }
}

/// g[part][pair] += over kDegrees degrees of one parity of coefficients[degree][part]
/// values[degree][pair].
template <int Width>
IBL_INLINE void sumDegrees(const Chains& chains, const double (*values)[kPairs],
                           const Parts* coefficients, double* g, std::ptrdiff_t stride) {
    using Vector = typename VectorOf<Width>::Type;
    constexpr int kVectors = Width == kPairGroup ? 1 : 2;
    for (int p = chains.live; p < chains.count; p += kVectors * Width) {
        Vector total[kParts][kVectors];
        for (int part = 0; part < kParts; ++part) {
            for (int v = 0; v < kVectors; ++v)
                total[part][v] =
                    *reinterpret_cast<const Vector*>(g + part * stride + p + v * Width);
        }
        for (int i = 0; i < kDegrees; i += 2) {
            Vector value[kVectors];
            for (int v = 0; v < kVectors; ++v)
                value[v] = *reinterpret_cast<const Vector*>(values[i] + p + v * Width);
            for (int part = 0; part < kParts; ++part) {
                for (int v = 0; v < kVectors; ++v)
                    total[part][v] += coefficients[i][part] * value[v];
            }
        }
        for (int part = 0; part < kParts; ++part) {
            for (int v = 0; v < kVectors; ++v)
                *reinterpret_cast<Vector*>(g + part * stride + p + v * Width) = total[part][v];
        }
    }
}

/// Above this order nothing on a ring of that sine reaches 2^-100 by the last degree: P_lm falls
/// off exponentially once m exceeds l sin theta (Reinecke and Seljebotn 2013, section 2.3).
bool negligible(int m, int degree, double sin_theta) {
    return m > degree * sin_theta + std::max(100.0, 0.01 * degree);
}

/// First pair of the first group that is not negligible.
int firstPair(const RingPairs& rings, int m, int degree) {
    int first = 0;
    while (first < rings.pairs && negligible(m, degree, rings.sin[first + kPairGroup - 1]))
        first += kPairGroup;
    return first;
}

struct Task {
    const RingPairs& rings;
    int first;
    int count;
    int degree;
};

template <int Width>
IBL_INLINE void analyseOrder(const RingPairs& rings, const Sectoral& sectoral, const Steps& steps,
                             int degree, const double* g, Parts* sums) {
    alignas(64) double values[kDegrees][kPairs];
    Chains chains;
    const int count = degree - sectoral.m + 1;
    const std::ptrdiff_t odd = static_cast<std::ptrdiff_t>(kParts) * rings.pairs;
    for (int first = firstPair(rings, sectoral.m, degree); first < rings.pairs; first += kPairs) {
        startChains(rings, sectoral, first, std::min(kPairs, rings.pairs - first), chains);
        for (int from = 0; from < count; from += kDegrees) {
            advance<Width>(chains, steps, from, values);
            for (int i = 0; i < kDegrees; i += i % 2 ? 7 : 1) { // 0, 1, 8, 9
                for (int c = 0; c < kParts; c += 3) {
                    const double* part = g + (i % 2) * odd + c * rings.pairs + first;
                    sumPairs<Width>(chains, values + i, part, rings.pairs,
                                    sums[from + i].data() + c);
                }
            }
        }
    }
}

template <int Width>
IBL_INLINE void synthesiseOrder(const RingPairs& rings, const Sectoral& sectoral,
                                const Steps& steps, int degree, const Parts* coefficients,
                                double* g) {
    alignas(64) double values[kDegrees][kPairs];
    Chains chains;
    const int count = degree - sectoral.m + 1;
    const std::ptrdiff_t odd = static_cast<std::ptrdiff_t>(kParts) * rings.pairs;
    for (int first = firstPair(rings, sectoral.m, degree); first < rings.pairs; first += kPairs) {
        startChains(rings, sectoral, first, std::min(kPairs, rings.pairs - first), chains);
        for (int from = 0; from < count; from += kDegrees) {
            advance<Width>(chains, steps, from, values);
            for (int parity = 0; parity < 2; ++parity) {
                sumDegrees<Width>(chains, values + parity, coefficients + from + parity,
                                  g + parity * odd + first, rings.pairs);
            }
        }
    }
}

/// Sums and differences of a pair's rings, weighted: g[even, odd][part][pair].
IBL_INLINE void foldPairs(const RingPairs& rings, const double* column, double* g) {
    const int used = rings.used, pairs = rings.pairs;
    const double weight = kPi / (2.0 * used);
    for (int part = 0; part < kParts; ++part) {
        const double *upper = column + static_cast<std::ptrdiff_t>(part) * 2 * used,
                     *lower = upper + 2 * used - 1;
        double *even = g + static_cast<std::ptrdiff_t>(part) * pairs, *odd = even + kParts * pairs;
        for (int p = 0; p < used; ++p) {
            const double w = weight * rings.sin[p];
            even[p] = w * (upper[p] + lower[-p]);
            odd[p] = w * (upper[p] - lower[-p]);
        }
        std::fill(even + used, even + pairs, 0.0);
        std::fill(odd + used, odd + pairs, 0.0);
    }
}

template <int Width>
IBL_INLINE void analyseOrders(const Task& task, const double* columns, Harmonics& harmonics) {
    const RingPairs& rings = task.rings;
    const std::ptrdiff_t column = static_cast<std::ptrdiff_t>(kParts) * 2 * rings.used;
    Sectoral sectoral = startSectoral(rings, task.first);
    Steps steps;
    std::vector<double> e;
    LaneVector<double> g(static_cast<std::size_t>(2) * kParts * rings.pairs);
    std::vector<Parts> sums;
    for (int m = task.first; m < task.first + task.count; ++m) {
        makeSteps(m, task.degree, e, steps);
        sums.assign(steps.a.size(), Parts{});
        foldPairs(rings, columns + (m - task.first) * column, g.data());
        analyseOrder<Width>(rings, sectoral, steps, task.degree, g.data(), sums.data());
        Parts* out = &harmonics.at(m, m);
        for (int i = 0; i <= task.degree - m; ++i) {
            for (int part = 0; part < kParts; ++part)
                out[i][part] = steps.t[i] * sums[i][part];
        }
        nextSectoral(rings, sectoral);
    }
}

template <int Width>
IBL_INLINE void synthesiseOrders(const Task& task, const Harmonics& harmonics, const double* scale,
                                 double* columns) {
    const RingPairs& rings = task.rings;
    const std::ptrdiff_t column = static_cast<std::ptrdiff_t>(kParts) * 2 * rings.pairs;
    Sectoral sectoral = startSectoral(rings, task.first);
    Steps steps;
    std::vector<double> e;
    std::vector<Parts> coefficients;
    std::fill(columns, columns + task.count * column, 0.0);
    for (int m = task.first; m < task.first + task.count; ++m) {
        makeSteps(m, task.degree, e, steps);
        coefficients.assign(steps.a.size(), Parts{});
        const Parts* f = &harmonics.at(m, m);
        for (int i = 0; i <= task.degree - m; ++i) {
            for (int part = 0; part < kParts; ++part)
                coefficients[i][part] = steps.t[i] * scale[m + i] * f[i][part];
        }
        synthesiseOrder<Width>(rings, sectoral, steps, task.degree, coefficients.data(),
                               columns + (m - task.first) * column);
        nextSectoral(rings, sectoral);
    }
}

// The width is that of the instruction set's registers, which a clone of one function cannot know.
#if defined(__x86_64__)
[[gnu::target("arch=x86-64-v4")]] void analyseTask(const Task& task, const double* columns,
                                                   Harmonics& harmonics) {
    analyseOrders<8>(task, columns, harmonics);
}
[[gnu::target("arch=x86-64-v3")]] void analyseTask(const Task& task, const double* columns,
                                                   Harmonics& harmonics) {
    analyseOrders<4>(task, columns, harmonics);
}
[[gnu::target("arch=x86-64-v4")]] void synthesiseTask(const Task& task, const Harmonics& harmonics,
                                                      const double* scale, double* columns) {
    synthesiseOrders<8>(task, harmonics, scale, columns);
}
[[gnu::target("arch=x86-64-v3")]] void synthesiseTask(const Task& task, const Harmonics& harmonics,
                                                      const double* scale, double* columns) {
    synthesiseOrders<4>(task, harmonics, scale, columns);
}
[[gnu::target("default")]]
#endif
void analyseTask(const Task& task, const double* columns, Harmonics& harmonics) {
    analyseOrders<2>(task, columns, harmonics);
}
#if defined(__x86_64__)
[[gnu::target("default")]]
#endif
void synthesiseTask(const Task& task, const Harmonics& harmonics, const double* scale,
                    double* columns) {
    synthesiseOrders<2>(task, harmonics, scale, columns);
}

} // namespace

RingPairs makePairs(std::vector<double> thetas) {
    RingPairs pairs;
    pairs.used = static_cast<int>(thetas.size());
    while (thetas.size() % kPairGroup != 0)
        thetas.push_back(thetas.back());
    pairs.pairs = static_cast<int>(thetas.size());
    for (const double theta : thetas) {
        pairs.x.push_back(std::cos(theta));
        pairs.sin.push_back(std::sin(theta));
        pairs.log2_sin.push_back(std::log2(std::sin(static_cast<long double>(theta))));
    }
    for (std::size_t p = 0; p < thetas.size(); ++p) {
        const std::size_t last = p / kPairGroup * kPairGroup + kPairGroup - 1;
        const double x = pairs.x[p], sine = pairs.sin[p];
        pairs.argument.push_back(thetas[last] < kPi / 4 ? -sine * sine : x * x);
    }
    return pairs;
}

RingPairs makeRings(int rings) {
    std::vector<double> thetas;
    for (int r = 0; r < rings / 2; ++r)
        thetas.push_back(kPi * (r + 0.5) / rings);
    return makePairs(std::move(thetas));
}

int ringsFor(int degree) {
    for (int rings = (degree + 2 + kLanes - 1) / kLanes * kLanes;; rings += kLanes) {
        int rest = rings;
        for (const int p : {2, 3, 5, 7, 11, 13}) {
            while (rest % p == 0)
                rest /= p;
        }
        if (rest == 1) return rings;
    }
}

void legendreAnalysis(const RingPairs& pairs, const double* columns, int first, int count,
                      Harmonics& harmonics) {
    analyseTask({pairs, first, count, harmonics.degree}, columns, harmonics);
}

void legendreSynthesis(const RingPairs& pairs, const Harmonics& harmonics, const double* scale,
                       int degree, int first, int count, double* columns) {
    synthesiseTask({pairs, first, count, degree}, harmonics, scale, columns);
}

} // namespace ibl
