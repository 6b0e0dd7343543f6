#include "convolve/direct.h"

#include "panorama/conventions.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

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

double DirectLobe::operator()(double h) const {
    return -mass_beyond(h);
}

DirectLobe makeDirectLobe(const Lobe& lobe) {
    return {LobeMassBeyond(lobe), {lobeReach(lobe), lobeVariation(lobe)}};
}

void addDirect(const DirectLobe& lobe, const Image& probe, double scale, const Axis& axis,
               double* sum) {
    const int w = probe.width, h = probe.height;
    const double row_step = kPi / h, column_step = 2 * kPi / w, factor = scale / (2 * kPi);
    const Accumulator out{probe, sum};
    const int own_row = std::clamp(static_cast<int>(axis.theta / row_step), 0, h - 1);
    const int own_column = static_cast<int>(std::floor(axis.psi / column_step));
    const float* own = probe.at(wrappedColumn(own_column, w), own_row);
    for (int c = 0; c < 3; ++c)
        sum[c] += scale * own[c];

    const int first = std::max(0, static_cast<int>((axis.theta - lobe.disc.radius) / row_step));
    const int last = std::min(h - 1, static_cast<int>((axis.theta + lobe.disc.radius) / row_step));
    for (int j = first; j <= last; ++j) {
        const double top = row_step * j, bottom = row_step * (j + 1);
        // Parallel between rows j and j + 1.
        if (j < last) {
            const double reach = halfWidthAt(axis, bottom, lobe.disc.radius);
            const int west = static_cast<int>(std::floor((axis.psi - reach) / column_step));
            const int count = std::min(
                w, static_cast<int>(std::floor((axis.psi + reach) / column_step)) - west + 1);
            for (int i = west; reach > 0 && i < west + count; ++i) {
                const int column = wrappedColumn(i, w);
                const float *above = probe.at(column, j), *below = probe.at(column, j + 1);
                if (Accumulator::same(above, below)) continue;
                const double integral =
                    parallelIntegral(lobe, lobe.disc, axis, bottom, i * column_step - axis.psi,
                                     (i + 1) * column_step - axis.psi);
                out.add(above, below, factor * integral);
            }
        }
        // Meridians between the columns of row j.
        const double widest = std::max({halfWidthAt(axis, top, lobe.disc.radius),
                                        halfWidthAt(axis, bottom, lobe.disc.radius),
                                        axis.theta > top && axis.theta < bottom
                                            ? halfWidthAt(axis, axis.theta, lobe.disc.radius)
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
                    factor * meridianIntegral(lobe, lobe.disc, axis, i * column_step - axis.psi,
                                              top, bottom));
        }
    }
}

} // namespace ibl
