#include "convolve/theta_resample.h"

#include "convolve/legendre.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ibl {
namespace {

constexpr double kPi = std::numbers::pi;

int wrapped(int k, int n) {
    return ((k % n) + n) % n;
}

/// A group's columns: those of even m and of odd m, lane by lane; absent ones are null.
struct ColumnGroup {
    const double* even_m[kLanes];
    const double* odd_m[kLanes];
};

/// The great circle's values from the half circle's. Columns of even m go on past the pole with the
/// sign `even_sign`, those of odd m with the opposite one.
void unfold(const ColumnGroup& group, std::ptrdiff_t re, std::ptrdiff_t im, int n, double even_sign,
            ComplexLanes* circle) {
    for (int lane = 0; lane < kLanes; ++lane) {
        const double *a = group.even_m[lane], *b = group.odd_m[lane];
        for (int r = 0; r < n; ++r) {
            const double are = a ? a[re + r] : 0, aim = a ? a[im + r] : 0;
            const double bre = b ? b[re + r] : 0, bim = b ? b[im + r] : 0;
            circle[r].re[lane] = are + bre;
            circle[r].im[lane] = aim + bim;
            circle[2 * n - 1 - r].re[lane] = even_sign * (are - bre);
            circle[2 * n - 1 - r].im[lane] = even_sign * (aim - bim);
        }
    }
}

} // namespace

ThetaResample makeThetaResample(int in, int out, int degree, RingSource source) {
    ThetaResample plan{in, out, degree, source, makeFftPlan(2 * in), makeFftPlan(2 * out), {}};
    plan.factors.resize(static_cast<std::size_t>(2 * degree + 1));
    for (int k = -degree; k <= degree; ++k) {
        // Both grids start half a step from the pole.
        const double phase = 0.5 * kPi * k * (1.0 / out - 1.0 / in);
        const double x = 0.5 * kPi * k / in;
        const double area = source == RingSource::pixel_rows && k != 0 ? std::sin(x) / x : 1;
        plan.factors[k + degree] = std::polar(area / (2.0 * in), phase);
    }
    return plan;
}

void thetaResample(const ThetaResample& plan, const double* columns, int count, double* result) {
    const std::ptrdiff_t column = static_cast<std::ptrdiff_t>(kParts) * plan.in;
    const std::ptrdiff_t out_column = static_cast<std::ptrdiff_t>(kParts) * plan.out;
    ColumnGroup group;
    for (int lane = 0; lane < kLanes; ++lane) {
        const int m = 2 * lane;
        group.even_m[lane] = m < count ? columns + m * column : nullptr;
        group.odd_m[lane] = m + 1 < count ? columns + (m + 1) * column : nullptr;
    }
    const double even_sign = plan.source == RingSource::samples ? 1 : -1;
    const int n = 2 * plan.in, n_out = 2 * plan.out;
    LaneVector<ComplexLanes> circle(n), resampled(n_out),
        work(std::max(fftWorkspace(plan.forward), fftWorkspace(plan.backward)));
    for (int channel = 0; channel < 3; ++channel) {
        const std::ptrdiff_t re = 2 * channel, im = re + 1;
        unfold(group, re * plan.in, im * plan.in, plan.in, even_sign, circle.data());
        fft(plan.forward, circle.data(), work.data());
        std::fill(resampled.begin(), resampled.end(), ComplexLanes{});
        for (int k = -plan.degree; k <= plan.degree; ++k) {
            const ComplexLanes& c = circle[wrapped(k, n)];
            const std::complex<double> f = plan.factors[k + plan.degree];
            ComplexLanes& to = resampled[wrapped(k, n_out)];
            // Swapped, so that the forward transform is the inverse.
            to.im += c.re * f.real() - c.im * f.imag();
            to.re += c.re * f.imag() + c.im * f.real();
        }
        fft(plan.backward, resampled.data(), work.data());
        for (int lane = 0; lane < kLanes; ++lane) {
            const int m = 2 * lane;
            for (int odd = 0; odd < 2 && m + odd < count; ++odd) {
                double* out_re = result + (m + odd) * out_column + re * plan.out;
                double* out_im = result + (m + odd) * out_column + im * plan.out;
                const double sign = odd ? -even_sign : even_sign;
                for (int r = 0; r < plan.out; ++r) {
                    const ComplexLanes &a = resampled[r], &b = resampled[n_out - 1 - r];
                    out_re[r] = 0.5 * (a.im[lane] + sign * b.im[lane]);
                    out_im[r] = 0.5 * (a.re[lane] + sign * b.re[lane]);
                }
            }
        }
    }
}

} // namespace ibl
