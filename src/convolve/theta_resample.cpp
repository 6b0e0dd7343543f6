#include "convolve/theta_resample.h"

#include "convolve/legendre.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace ibl {
namespace {

constexpr double kPi = std::numbers::pi;

IBL_INLINE Lanes load(const double* p) {
    return *reinterpret_cast<const Lanes*>(p);
}
IBL_INLINE void store(const Lanes& x, double* p) {
    *reinterpret_cast<Lanes*>(p) = x;
}

/// kLanes rings of the columns m = odd, odd + 2, ...: x[ring], a lane a column.
IBL_INLINE void loadColumns(const double* columns, ColumnLayout from, int count, int odd,
                            std::ptrdiff_t at, Lanes (&x)[kLanes]) {
    for (int lane = 0; lane < kLanes; ++lane) {
        const int m = 2 * lane + odd;
        x[lane] = m < count ? load(columns + m * kParts * from.part + at) : Lanes{};
    }
    transpose(x);
}

/// The great circle's values from the half circle's, those of even and odd m together. Columns of
/// even m go on past the pole with the sign `even_sign`, those of odd m with the opposite one.
IBL_MULTIVERSION
void unfold(const ThetaResample& plan, const double* columns, ColumnLayout from, int count,
            int channel, double even_sign, ComplexLanes* circle) {
    const int n = plan.in;
    for (int block = 0; block * kLanes < n; ++block) {
        const std::ptrdiff_t re = block * from.block + 2 * channel * from.part;
        Lanes are[kLanes], aim[kLanes], bre[kLanes], bim[kLanes];
        loadColumns(columns, from, count, 0, re, are);
        loadColumns(columns, from, count, 0, re + from.part, aim);
        loadColumns(columns, from, count, 1, re, bre);
        loadColumns(columns, from, count, 1, re + from.part, bim);
        for (int i = 0; i < std::min(kLanes, n - block * kLanes); ++i) {
            const int r = block * kLanes + i;
            circle[plan.forward.slot(r)] = {are[i] + bre[i], aim[i] + bim[i]};
            circle[plan.forward.slot(2 * n - 1 - r)] = {even_sign * (are[i] - bre[i]),
                                                        even_sign * (aim[i] - bim[i])};
        }
    }
}

/// The spectrum `from` k = -degree on, times the plan's factors, to where the inverse transform
/// reads it; real and imaginary parts swapped, so that the forward transform is the inverse.
IBL_MULTIVERSION
void placeSpectrum(const ThetaResample& plan, const ComplexLanes* from, ComplexLanes* to) {
    const int n = 2 * plan.out, d = plan.degree;
    std::fill(to + d + 1, to + n - d, ComplexLanes{});
    for (int k = -d; k <= d; ++k) {
        const ComplexLanes& c = from[k + d];
        const std::complex<double> f = plan.factors[k + d];
        to[k < 0 ? k + n : k] = {c.re * f.imag() + c.im * f.real(),
                                 c.re * f.real() - c.im * f.imag()};
    }
}

/// The reverse of unfold, from swapped parts.
IBL_MULTIVERSION
void fold(const ThetaResample& plan, const ComplexLanes* circle, int channel, double even_sign,
          int count, double* result, ColumnLayout to) {
    for (int block = 0; block * kLanes < plan.out; ++block) {
        const std::ptrdiff_t re = block * to.block + 2 * channel * to.part;
        for (int odd = 0; odd < 2; ++odd) {
            const double sign = odd ? -even_sign : even_sign;
            Lanes x[kLanes], y[kLanes];
            for (int i = 0; i < kLanes; ++i) {
                const int r = block * kLanes + i;
                const ComplexLanes &a = circle[r], &b = circle[2 * plan.out - 1 - r];
                x[i] = 0.5 * (a.im + sign * b.im);
                y[i] = 0.5 * (a.re + sign * b.re);
            }
            transpose(x);
            transpose(y);
            for (int lane = 0; lane < kLanes && 2 * lane + odd < count; ++lane) {
                double* out = result + (2 * lane + odd) * kParts * to.part + re;
                store(x[lane], out);
                store(y[lane], out + to.part);
            }
        }
    }
}

} // namespace

ThetaResample makeThetaResample(int in, int out, int degree, RingSource source) {
    assert(out % kLanes == 0 && out > degree);
    ThetaResample plan{in, out, degree, source, makePrunedFft(2 * in, degree), makeFftPlan(2 * out),
                       {}};
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

void thetaResample(const ThetaResample& plan, const double* columns, ColumnLayout from, int count,
                   double* result, ColumnLayout to) {
    const double even_sign = plan.source == RingSource::samples ? 1 : -1;
    const std::size_t most = static_cast<std::size_t>(2 * std::max(plan.in, plan.out));
    LaneVector<ComplexLanes> circle(most), spectrum(plan.factors.size()),
        work(std::max(fftWorkspace(plan.forward.part), fftWorkspace(plan.backward)));
    for (int channel = 0; channel < 3; ++channel) {
        unfold(plan, columns, from, count, channel, even_sign, circle.data());
        prunedFft(plan.forward, circle.data(), work.data(), spectrum.data());
        placeSpectrum(plan, spectrum.data(), circle.data());
        fft(plan.backward, circle.data(), work.data());
        fold(plan, circle.data(), channel, even_sign, count, result, to);
    }
}

} // namespace ibl
