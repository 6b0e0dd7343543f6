#include "convolve/narrow.h"

#include "panorama/conventions.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

constexpr double kTaper = 3;
constexpr double kTableReach = 100; ///< of the table, in units of 1 / degree
constexpr int kTableDensity = 8;    ///< samples per 1 / degree

/// M_smooth(t) = sum k_l (P_(l-1) - P_(l+1)) / 2, and for l = 0 (1 - P_1) / 2.
double smoothMass(const std::vector<double>& k, double t) {
    const double x = std::cos(t), s = std::sin(0.5 * t);
    double before = 1, here = x; // P_(l-1), P_l
    double mass = k[0] * s * s;
    for (std::size_t l = 1; l < k.size(); ++l) {
        const double after = ((2.0 * l + 1) * x * here - l * before) / (l + 1.0);
        mass += 0.5 * k[l] * (before - after);
        before = here;
        here = after;
    }
    return mass;
}

int wrappedColumn(int i, int width) {
    return ((i % width) + width) % width;
}

/// Where the core's disc meets a parallel: half of its range of azimuths, pi when all of it.
double halfWidthAt(const Axis& axis, double theta, double radius) {
    const double s2 = std::sin(theta) * axis.sin_theta;
    const double gap = std::sin(0.5 * (theta - axis.theta)), reach = std::sin(0.5 * radius);
    const double room = reach * reach - gap * gap;
    if (room <= 0) return 0;
    if (room >= s2) return kPi;
    return 2 * std::asin(std::sqrt(room / s2));
}

struct Accumulator {
    const Image& probe;
    double* sum;

    void add(const float* left, const float* right, double weight) const {
        for (int c = 0; c < 3; ++c)
            sum[c] += weight * (double{left[c]} - double{right[c]});
    }
    static bool same(const float* a, const float* b) {
        return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
    }
};

} // namespace

std::vector<double> smoothCoefficients(const Lobe& lobe, int degree) {
    std::vector<double> k = zonalCoefficients(lobe, degree + 1);
    for (int l = 0; l <= degree; ++l) {
        k[l] *= std::erfc(kTaper * (2.0 * l / degree - 1)) / std::erfc(-kTaper);
    }
    return k;
}

double LobeCore::operator()(double h) const {
    if (smooth_mass.empty()) return -mass_beyond(h);
    const double within = h <= inner_h ? inner_mass : 1 - mass_beyond(h);
    // Cubic Lagrange interpolation of the smooth mass, which is even in t.
    const double x = 2 * std::asin(std::sqrt(h)) / step;
    const std::size_t i = static_cast<std::size_t>(x);
    if (i + 2 >= smooth_mass.size()) return 0;
    const double t = x - static_cast<double>(i);
    const double y0 = smooth_mass[i == 0 ? 1 : i - 1], y1 = smooth_mass[i], y2 = smooth_mass[i + 1],
                 y3 = smooth_mass[i + 2];
    const double smooth = -t * (t - 1) * (t - 2) / 6 * y0 + (t + 1) * (t - 1) * (t - 2) / 2 * y1 -
                          (t + 1) * t * (t - 2) / 2 * y2 + (t + 1) * t * (t - 1) / 6 * y3;
    return within - smooth;
}

LobeCore makeCore(const Lobe& lobe, const std::vector<double>& smooth, double inner,
                  double tolerance) {
    LobeCore core{LobeMassBeyond(lobe), {0, 0}, 0, 0, 0, {}};
    core.inner_h = std::sin(0.5 * inner) * std::sin(0.5 * inner);
    core.inner_mass = inner > 0 ? 1 - core.mass_beyond(core.inner_h) : 0;
    const double degree = static_cast<double>(smooth.size()) - 1;
    core.step = 1 / (kTableDensity * degree);
    core.disc.variation = 16 / degree;
    const int count = static_cast<int>(std::min(kTableReach / degree, 0.5 * kPi) / core.step);
    core.smooth_mass.resize(count + 3);
    for (int i = 0; i < count + 3; ++i)
        core.smooth_mass[i] = smoothMass(smooth, i * core.step);
    int last = count;
    while (last > 1) {
        const double s = std::sin(0.5 * last * core.step);
        if (std::abs(core(s * s)) > tolerance) break;
        --last;
    }
    core.disc.radius = (last + 1) * core.step;
    return core;
}

LobeCore makeWholeCore(const Lobe& lobe) {
    return {LobeMassBeyond(lobe), {0.5 * kPi, 0.2}, 0, 0, 0, {}};
}

void addCore(const LobeCore& core, const Image& probe, double scale, const Axis& axis,
             double* sum) {
    const int w = probe.width, h = probe.height;
    const double row_step = kPi / h, column_step = 2 * kPi / w, factor = scale / (2 * kPi);
    const Accumulator out{probe, sum};
    const int own_row = std::clamp(static_cast<int>(axis.theta / row_step), 0, h - 1);
    const int own_column = static_cast<int>(std::floor(axis.psi / column_step));
    // M(pi) of the core: the smooth part has all of the lobe's mass and the innermost part's share
    // is with the area-filtered map.
    const float* own = probe.at(wrappedColumn(own_column, w), own_row);
    const double mass = (core.smooth_mass.empty() ? 1 : 0) - core.inner_mass;
    for (int c = 0; c < 3; ++c)
        sum[c] += scale * mass * own[c];

    const int first = std::max(0, static_cast<int>((axis.theta - core.disc.radius) / row_step));
    const int last = std::min(h - 1, static_cast<int>((axis.theta + core.disc.radius) / row_step));
    for (int j = first; j <= last; ++j) {
        const double top = row_step * j, bottom = row_step * (j + 1);
        // Parallel between rows j and j + 1.
        if (j < last) {
            const double reach = halfWidthAt(axis, bottom, core.disc.radius);
            const int west = static_cast<int>(std::floor((axis.psi - reach) / column_step));
            const int count = std::min(
                w, static_cast<int>(std::floor((axis.psi + reach) / column_step)) - west + 1);
            for (int i = west; reach > 0 && i < west + count; ++i) {
                const int column = wrappedColumn(i, w);
                const float *above = probe.at(column, j), *below = probe.at(column, j + 1);
                if (Accumulator::same(above, below)) continue;
                const double integral =
                    parallelIntegral(core, core.disc, axis, bottom, i * column_step - axis.psi,
                                     (i + 1) * column_step - axis.psi);
                out.add(above, below, factor * integral);
            }
        }
        // Meridians between the columns of row j.
        const double widest = std::max({halfWidthAt(axis, top, core.disc.radius),
                                        halfWidthAt(axis, bottom, core.disc.radius),
                                        axis.theta > top && axis.theta < bottom
                                            ? halfWidthAt(axis, axis.theta, core.disc.radius)
                                            : 0.0});
        if (widest <= 0) continue;
        const int west = static_cast<int>(std::floor((axis.psi - widest) / column_step)) - 1;
        const int count =
            std::min(w, static_cast<int>(std::floor((axis.psi + widest) / column_step)) + 1 - west);
        for (int i = west + 1; i <= west + count; ++i) {
            const float *left = probe.at(wrappedColumn(i - 1, w), j),
                        *right = probe.at(wrappedColumn(i, w), j);
            if (Accumulator::same(left, right)) continue;
            out.add(left, right,
                    factor * meridianIntegral(core, core.disc, axis, i * column_step - axis.psi,
                                              top, bottom));
        }
    }
}

} // namespace ibl
