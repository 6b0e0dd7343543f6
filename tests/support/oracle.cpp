#include "support/oracle.h"

#include <algorithm>
#include <cmath>

namespace ibl::oracle {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Rule {
    std::vector<double> x, w;
};

/// Gauss-Legendre on [0, 1], by bisection-safe Newton steps.
Rule gauss(int n) {
    Rule rule;
    for (int i = 0; i < n; ++i) {
        double x = std::cos(kPi * (i + 0.75) / (n + 0.5)), dp = 0;
        for (int it = 0; it < 50; ++it) {
            double p = 1, q = 0;
            for (int k = 1; k <= n; ++k) {
                const double r = q;
                q = p;
                p = ((2 * k - 1) * x * q - (k - 1) * r) / k;
            }
            dp = n * (x * p - q) / (x * x - 1);
            const double step = p / dp;
            x -= step;
            if (std::abs(step) < 1e-15) break;
        }
        rule.x.push_back(0.5 * (1 + x));
        rule.w.push_back(1 / ((1 - x * x) * dp * dp));
    }
    return rule;
}

/// All pixels against all directions with n x n points a pixel.
std::vector<std::array<double, 3>> sums(const Image& probe, const LobeFunction& lobe,
                                        const std::vector<Direction>& directions, int n) {
    const Rule rule = gauss(n);
    const int w = probe.width, h = probe.height;
    std::vector<std::array<double, 3>> result(directions.size(), {0, 0, 0});
    std::vector<double> sin_phi(static_cast<std::size_t>(w) * n), cos_phi(sin_phi.size());
    for (int i = 0; i < w; ++i) {
        for (int a = 0; a < n; ++a) {
            const double phi = 2 * kPi * (0.5 - (i + rule.x[a]) / w);
            sin_phi[i * n + a] = std::sin(phi);
            cos_phi[i * n + a] = std::cos(phi);
        }
    }
    for (std::size_t d = 0; d < directions.size(); ++d) {
        const Direction& axis = directions[d];
        std::array<double, 3> total{};
        for (int j = 0; j < h; ++j) {
            const double top = std::cos(kPi * j / h), bottom = std::cos(kPi * (j + 1) / h);
            std::vector<double> kernel(w, 0.0);
            for (int b = 0; b < n; ++b) {
                const double y = bottom + (top - bottom) * rule.x[b];
                const double r = std::sqrt(std::max(0.0, 1 - y * y));
                for (int i = 0; i < w; ++i) {
                    for (int a = 0; a < n; ++a) {
                        const double c = axis.y * y + r * (axis.x * sin_phi[i * n + a] +
                                                           axis.z * cos_phi[i * n + a]);
                        if (c > 0) kernel[i] += rule.w[a] * rule.w[b] * lobe(std::min(1.0, c));
                    }
                }
            }
            for (int i = 0; i < w; ++i) {
                const double weight = kernel[i] * (top - bottom) * 2 * kPi / w;
                for (int ch = 0; ch < 3; ++ch)
                    total[ch] += weight * probe.at(i, j)[ch];
            }
        }
        result[d] = total;
    }
    return result;
}

} // namespace

LobeFunction lambert() {
    return [](double c) { return c; };
}

LobeFunction ggx(double roughness) {
    const double a2 = std::pow(roughness, 4);
    return [a2](double c) {
        const double cos2_h = 0.5 * (1 + c); // cos^2(t/2)
        const double d = (a2 - 1) * cos2_h + 1;
        return a2 / (kPi * d * d) * c;
    };
}

LobeFunction phong(double exponent) {
    return [exponent](double c) { return std::pow(c, exponent); };
}

double integral(const LobeFunction& lobe) {
    // t = e^s - e^-40: panels of equal ratio resolve any width of lobe.
    const Rule rule = gauss(20);
    double total = 0;
    const double low = std::log(1e-9), high = std::log(kPi / 2);
    const int panels = 200;
    for (int p = 0; p < panels; ++p) {
        const double a = low + (high - low) * p / panels, b = low + (high - low) * (p + 1) / panels;
        for (std::size_t i = 0; i < rule.x.size(); ++i) {
            const double t = std::exp(a + (b - a) * rule.x[i]);
            total += rule.w[i] * (b - a) * t * lobe(std::cos(t)) * std::sin(t);
        }
    }
    return 2 * kPi * total;
}

std::vector<std::array<double, 3>> convolve(const Image& probe, const LobeFunction& lobe,
                                            const std::vector<Direction>& directions,
                                            double tolerance) {
    const double norm = 1 / integral(lobe);
    std::vector<std::array<double, 3>> previous;
    for (int n = 1; n <= 64; n = n < 4 ? n + 1 : n + n / 2) {
        std::vector<std::array<double, 3>> now = sums(probe, lobe, directions, n);
        double largest = 0, moved = 0;
        for (std::size_t i = 0; i < now.size(); ++i) {
            for (int c = 0; c < 3; ++c) {
                now[i][c] *= norm;
                largest = std::max(largest, std::abs(now[i][c]));
                if (!previous.empty())
                    moved = std::max(moved, std::abs(now[i][c] - previous[i][c]));
            }
        }
        if (!previous.empty() && moved <= tolerance * largest) return now;
        previous = std::move(now);
    }
    return previous;
}

} // namespace ibl::oracle
