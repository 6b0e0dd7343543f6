#include "support/oracle.h"

#include <algorithm>
#include <cmath>

namespace ibl::oracle {
namespace {

constexpr double kPi = 3.14159265358979323846;

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
                    const float* p = probe.at(i, j);
                    if (p[0] == 0 && p[1] == 0 && p[2] == 0) continue;
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

struct Rectangle {
    double phi0, phi1, y0, y1; ///< longitude and cos theta
};

double divided(const Rectangle& r, const LobeFunction& lobe, double width, const Direction& axis,
               const Rule& rule) {
    const double phi = 0.5 * (r.phi0 + r.phi1), y = 0.5 * (r.y0 + r.y1);
    const double theta0 = std::acos(r.y0), theta1 = std::acos(r.y1);
    const double s = std::sqrt(1 - y * y);
    const double wide = (r.phi1 - r.phi0) * std::sin(std::min(theta0, 0.5 * kPi)),
                 tall = std::abs(theta1 - theta0);
    const double dx = s * std::sin(phi) - axis.x, dy = y - axis.y, dz = s * std::cos(phi) - axis.z;
    const double distance = std::sqrt(dx * dx + dy * dy + dz * dz); // chord
    const double size = std::max(wide, tall);
    if (distance - size > 1.4143) return 0; // beyond the horizon
    const double horizon = std::abs(distance - 1.41421356);
    const bool kink = horizon < size && size > 2e-3;
    if (kink || (size > 0.5 * distance && size > width)) {
        double sum = 0;
        const bool cut_phi = wide > 0.7 * tall, cut_y = tall > 0.7 * wide;
        for (int a = 0; a < (cut_phi ? 2 : 1); ++a) {
            for (int b = 0; b < (cut_y ? 2 : 1); ++b) {
                Rectangle part = r;
                if (cut_phi) (a == 0 ? part.phi1 : part.phi0) = phi;
                const double middle = std::cos(0.5 * (theta0 + theta1));
                if (cut_y) (b == 0 ? part.y1 : part.y0) = middle;
                sum += divided(part, lobe, width, axis, rule);
            }
        }
        return sum;
    }
    double sum = 0;
    for (std::size_t b = 0; b < rule.x.size(); ++b) {
        const double py = r.y0 + (r.y1 - r.y0) * rule.x[b], ps = std::sqrt(1 - py * py);
        for (std::size_t a = 0; a < rule.x.size(); ++a) {
            const double pp = r.phi0 + (r.phi1 - r.phi0) * rule.x[a];
            const double ex = ps * std::sin(pp) - axis.x, ey = py - axis.y,
                         ez = ps * std::cos(pp) - axis.z;
            const double c = 1 - 0.5 * (ex * ex + ey * ey + ez * ez); // exact for small angles
            if (c > 0) sum += rule.w[a] * rule.w[b] * lobe(c);
        }
    }
    return sum * (r.phi1 - r.phi0) * std::abs(r.y1 - r.y0);
}

} // namespace

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

LobeFunction blinnPhong(double exponent) {
    return [exponent](double c) { return std::pow(0.5 * (1 + c), 0.5 * exponent) * c; };
}

LobeFunction charlie(double roughness) {
    const double alpha = roughness * roughness;
    return [alpha](double c) { return std::pow(0.5 * (1 - c), 0.5 / alpha) * c; };
}

double integral(const LobeFunction& lobe) {
    // Panels of equal ratio in t resolve any width of lobe.
    const Rule rule = gauss(20);
    double total = 0;
    const double low = std::log(1e-9), high = std::log(kPi / 2);
    const int panels = 400;
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

std::array<double, 3> convolveNarrow(const Image& probe, const LobeFunction& lobe, double width,
                                     const Direction& direction) {
    const Rule rule = gauss(5);
    std::array<double, 3> total{};
    for (int j = 0; j < probe.height; ++j) {
        for (int i = 0; i < probe.width; ++i) {
            const Rectangle r{2 * kPi * (0.5 - (i + 1.0) / probe.width),
                              2 * kPi * (0.5 - static_cast<double>(i) / probe.width),
                              std::cos(kPi * (j + 1) / probe.height),
                              std::cos(kPi * j / probe.height)};
            const double mass = divided(r, lobe, width, direction, rule);
            for (int c = 0; c < 3; ++c)
                total[c] += mass * probe.at(i, j)[c];
        }
    }
    const double norm = 1 / integral(lobe);
    for (double& t : total)
        t *= norm;
    return total;
}

Direction cubeDirection(int face, double i, double j, int edge) {
    const double s = (2 * i + 1) / edge - 1, t = (2 * j + 1) / edge - 1;
    const double r = 1 / std::sqrt(1 + s * s + t * t);
    switch (face) {
    case 0:
        return {r, -t * r, -s * r};
    case 1:
        return {-r, -t * r, s * r};
    case 2:
        return {s * r, r, t * r};
    case 3:
        return {s * r, -r, -t * r};
    case 4:
        return {s * r, -t * r, r};
    default:
        return {-s * r, -t * r, -r};
    }
}

double cubeWeight(double i, double j, int edge) {
    const double s = (2 * i + 1) / edge - 1, t = (2 * j + 1) / edge - 1;
    return 4.0 / edge / edge * std::pow(1 + s * s + t * t, -1.5);
}

} // namespace ibl::oracle
