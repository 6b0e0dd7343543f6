#include "convolve/sh_coefficients.h"

#include "convolve/analysis.h"
#include "convolve/gauss.h"
#include "convolve/probe_scale.h"
#include "core/error.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace ibl {
namespace {

constexpr double kPi = std::numbers::pi;

/// Filament multiplies by 1, y, z, x, xy, yz, 3 z^2 - 1, xz and x^2 - y^2 (libs/ibl/src/
/// CubemapSH.cpp, renderPreScaledSH3Bands): the constants of Y before these.
const std::array<double, 9>& filamentConstants() {
    static const std::array<double, 9> constants = [] {
        const double one = std::sqrt(3 / (4 * kPi)), two = std::sqrt(15 / (4 * kPi));
        return std::array{std::sqrt(1 / (4 * kPi)),  one, one,    one, two, two,
                          std::sqrt(5 / (16 * kPi)), two, two / 2};
    }();
    return constants;
}

/// Real coefficients in the analysis's own frame. Its field is
///
///     L = sum_l f_l0 P_l0 + sum_(m > 0) 2 Re(f_lm exp(i m psi)) P_lm,
///
/// so those of sqrt 2 P_lm cos m psi and sqrt 2 P_lm sin m psi are sqrt 2 Re f_lm and
/// -sqrt 2 Im f_lm.
std::vector<std::array<double, 3>> realOf(const Harmonics& f, int order) {
    std::vector<std::array<double, 3>> real(static_cast<std::size_t>(order) * order);
    for (int l = 0; l < order; ++l) {
        for (int m = 0; m <= l; ++m) {
            const double factor = m == 0 ? 1 : std::numbers::sqrt2;
            for (int c = 0; c < 3; ++c) {
                real[l * l + l + m][c] = factor * f.at(l, m)[2 * c];
                if (m > 0) real[l * l + l - m][c] = -factor * f.at(l, m)[2 * c + 1];
            }
        }
    }
    return real;
}

/// Adds to `turned` what the point `d` of a quadrature rule says of every degree.
void addPoint(int order, const V3d& d, double weight,
              std::span<const std::array<double, 3>> in_analysis_frame,
              std::vector<std::array<double, 3>>& turned) {
    std::array<double, kMaxShOrder * kMaxShOrder> from, to;
    shBasis(order, {-d.z, d.x, d.y}, from);
    shBasis(order, d, to);
    for (int l = 0; l < order; ++l) {
        std::array<double, 3> band{};
        for (int i = l * l; i < (l + 1) * (l + 1); ++i) {
            for (int c = 0; c < 3; ++c)
                band[c] += in_analysis_frame[i][c] * from[i];
        }
        for (int i = l * l; i < (l + 1) * (l + 1); ++i) {
            for (int c = 0; c < 3; ++c)
                turned[i][c] += weight * band[c] * to[i];
        }
    }
}

/// From the analysis's frame to ours. There psi = 2 pi u = pi - phi is the azimuth about +Y, so
///
///     (sin theta cos psi, sin theta sin psi, cos theta) = (-z, x, y).
///
/// Turning and mirroring keep each degree by itself. The degree's part is projected anew by a rule
/// that is exact for products of two harmonics of degree order - 1: `order` Gauss points in z and
/// 2 order in azimuth.
std::vector<std::array<double, 3>> turn(const std::vector<std::array<double, 3>>& in_analysis_frame,
                                        int order) {
    std::vector<std::array<double, 3>> turned(in_analysis_frame.size());
    const GaussRule& rule = gaussRule(order);
    for (int i = 0; i < order; ++i) {
        const double z = rule.nodes[i], across = std::sqrt((1 - z) * (1 + z));
        for (int k = 0; k < 2 * order; ++k) {
            const double alpha = kPi * k / order;
            addPoint(order, {across * std::cos(alpha), across * std::sin(alpha), z},
                     rule.weights[i] * kPi / order, in_analysis_frame, turned);
        }
    }
    return turned;
}

} // namespace

void shBasis(int order, const V3d& d, std::span<double> basis) {
    // (re, im) = sin^m beta exp(i m alpha); p holds P_lm / sin^m beta, by rising l:
    // e_(l+1) P_(l+1) = z P_l - e_l P_(l-1), e_l = sqrt((l^2 - m^2) / (4 l^2 - 1)).
    double re = 1, im = 0, diagonal = std::sqrt(1 / (4 * kPi));
    for (int m = 0; m < order; ++m) {
        double before = 0, p = diagonal, e = 0;
        const double factor = m == 0 ? 1 : std::numbers::sqrt2;
        for (int l = m; l < order; ++l) {
            basis[l * l + l + m] = factor * p * re;
            if (m > 0) basis[l * l + l - m] = factor * p * im;
            const double n = l + 1.0, next_e = std::sqrt((n * n - double(m) * m) / (4 * n * n - 1));
            const double next = (d.z * p - e * before) / next_e;
            before = p;
            p = next;
            e = next_e;
        }
        diagonal *= std::sqrt((2 * m + 3.0) / (2 * m + 2.0));
        const double turned = re * d.x - im * d.y;
        im = re * d.y + im * d.x;
        re = turned;
    }
}

ShCoefficients projectProbe(const Image& latlong, int order, int threads) {
    if (order < 1 || order > kMaxShOrder) {
        throw Error(ExitCode::usage,
                    "order: " + std::to_string(order) +
                        " is not in [1, 20]; give a number of bands in that range");
    }
    const double scale = probeScale(latlong, threads);
    const RowSpectrum rows =
        analyseRows(latlong, scale, std::numeric_limits<double>::infinity(), order - 1, threads);
    ShCoefficients result{ShConvention::radiance, order,
                          turn(realOf(analyse(rows, order - 1, threads), order), order)};
    for (auto& rgb : result.values) {
        for (double& value : rgb)
            value /= scale;
    }
    return result;
}

double cosineFactor(int l) {
    if (l == 1) return 2 * kPi / 3;
    if (l % 2 == 1) return 0;
    // 2 pi (-1)^(l/2 - 1) / ((l + 2)(l - 1)) l! / (2^l (l/2)!^2); at l = 0 that is pi.
    double choose = 1;
    for (int k = 1; k <= l / 2; ++k)
        choose *= (2 * k - 1) / (2.0 * k);
    const double sign = l / 2 % 2 == 1 ? 1 : -1;
    return 2 * kPi * sign * choose / ((l + 2.0) * (l - 1.0));
}

ShCoefficients toConvention(const ShCoefficients& radiance, ShConvention convention) {
    if (convention == ShConvention::filament && radiance.order > 3) {
        throw Error(ExitCode::usage, "filament: takes 3 bands or fewer, not " +
                                         std::to_string(radiance.order) + "; ask for fewer");
    }
    ShCoefficients result = radiance;
    result.convention = convention;
    if (convention == ShConvention::radiance) return result;
    for (int l = 0; l < result.order; ++l) {
        for (int i = l * l; i < (l + 1) * (l + 1); ++i) {
            const bool filament = convention == ShConvention::filament;
            const double factor = cosineFactor(l) * (filament ? filamentConstants()[i] / kPi : 1);
            for (double& value : result.values[i])
                value *= factor;
        }
    }
    return result;
}

std::array<double, 3> evaluateSh(const ShCoefficients& coefficients, const V3d& d) {
    std::array<double, kMaxShOrder * kMaxShOrder> basis;
    shBasis(coefficients.order, d, basis);
    std::array<double, 3> sum{};
    for (std::size_t i = 0; i < coefficients.values.size(); ++i) {
        double y = basis[i];
        if (coefficients.convention == ShConvention::filament) y /= filamentConstants()[i];
        for (int c = 0; c < 3; ++c)
            sum[c] += coefficients.values[i][c] * y;
    }
    return sum;
}

} // namespace ibl
