#include "support/contour_oracle.h"

#include "support/oracle.h"

#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>

namespace ibl::oracle {
namespace {

using Imath::V3d;

constexpr double kPi = 3.14159265358979323846;
constexpr double kLeast = 1e-9;
/// Curves are cut in pieces this long, which are nearly straight.
constexpr double kPiece = 0.1;

/// A curve on the sphere over s in [0, 1]: an arc from p to q, or of a parallel.
struct Curve {
    V3d p{0, 0, 0}, q{0, 0, 0};
    bool parallel = false;
    double theta = 0, phi = 0, turn = 0;
    double length = 0;
};

V3d direction(double theta, double phi) {
    return {std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi)};
}

V3d at(const Curve& c, double s) {
    if (c.parallel) return direction(c.theta, c.phi + s * c.turn);
    return (c.p + (c.q - c.p) * s).normalized();
}

V3d tangent(const Curve& c, double s) {
    if (c.parallel) {
        const double phi = c.phi + s * c.turn;
        return V3d(std::cos(phi), 0, -std::sin(phi)) * (std::sin(c.theta) * c.turn);
    }
    const V3d v = c.p + (c.q - c.p) * s, d = v.normalized();
    const V3d along = c.q - c.p;
    return (along - d * along.dot(d)) / v.length();
}

void addArc(const V3d& p, const V3d& q, std::vector<Curve>& curves) {
    const int n = std::max(1, static_cast<int>(std::ceil((q - p).length() / kPiece)));
    for (int k = 0; k < n; ++k) {
        Curve c;
        c.p = (p + (q - p) * (double(k) / n)).normalized();
        c.q = (p + (q - p) * (double(k + 1) / n)).normalized();
        c.length = (c.q - c.p).length();
        curves.push_back(c);
    }
}

void addParallel(double theta, double phi, double turn, std::vector<Curve>& curves) {
    const double length = std::abs(turn) * std::sin(theta);
    const int n = std::max(1, static_cast<int>(std::ceil(length / kPiece)));
    for (int k = 0; k < n; ++k)
        curves.push_back({V3d(0), V3d(0), true, theta, phi + turn * k / n, turn / n, length / n});
}

/// The place on the line of c that is nearest to y, to within a few lengths of c.
double nearestPlace(const Curve& c, const V3d& y) {
    double s = 0.5;
    for (int i = 0; i < 4; ++i) {
        const V3d t = tangent(c, s);
        s = std::clamp(s + (y - at(c, s)).dot(t) / t.length2(), -3.0, 4.0);
    }
    return s;
}

/// Where an integrand over [0, 1] changes, and over what distance.
struct Site {
    double place, distance;
};

/// Ends of panels on [0, 1] that are no longer than their middles' distances from the sites.
std::vector<double> panels(const std::vector<Site>& sites) {
    std::vector<double> cuts{0, 1}, ends{0};
    for (const Site& s : sites)
        if (s.place > 0 && s.place < 1) cuts.push_back(s.place);
    std::ranges::sort(cuts);
    const std::function<void(double, double)> divide = [&](double a, double b) {
        const double middle = 0.5 * (a + b);
        double room = 10;
        for (const Site& s : sites)
            room = std::min(room, std::max(std::abs(middle - s.place), s.distance));
        if (b - a > room && b - a > 1e-10) {
            divide(a, middle);
            divide(middle, b);
        } else if (b > a) {
            ends.push_back(b);
        }
    };
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
        divide(cuts[i], cuts[i + 1]);
    return ends;
}

double valueAt(const Potential& potential, double t) {
    if (t >= 0.5 * kPi) return 0;
    const double x = std::log(std::max(t, 1e-15) / kLeast) / potential.step;
    if (x < 0) return potential.value[0] - x * potential.step / (2 * kPi);
    const std::size_t i = std::min(static_cast<std::size_t>(x), potential.value.size() - 2);
    const double f = x - double(i), f2 = f * f, f3 = f2 * f; // Hermite
    return potential.value[i] * (2 * f3 - 3 * f2 + 1) + potential.slope[i] * (f3 - 2 * f2 + f) +
           potential.value[i + 1] * (3 * f2 - 2 * f3) + potential.slope[i + 1] * (f3 - f2);
}

double overPanels(const std::vector<double>& ends, const Rule& rule,
                  const std::function<double(double)>& f) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        const double size = ends[i + 1] - ends[i];
        for (std::size_t k = 0; k < rule.x.size(); ++k)
            sum += rule.w[k] * size * f(ends[i] + size * rule.x[k]);
    }
    return sum;
}

/// int int Phi dx . dy over both curves.
double pairIntegral(const Potential& potential, const Curve& e, const Curve& f) {
    static const Rule kFar = gauss(5), kNear = gauss(7);
    const bool far = (at(e, 0.5) - at(f, 0.5)).length() > 2 * (e.length + f.length);
    const auto inner = [&](const V3d& x, const V3d& dx) {
        std::vector<double> ends{0, 1};
        if (!far) {
            const double s = nearestPlace(f, x), d = (at(f, s) - x).length() / f.length;
            ends = panels({{s, std::max(d, 1e-12)}});
        }
        return overPanels(ends, far ? kFar : kNear, [&](double s) {
            const double chord = (x - at(f, s)).length();
            return tangent(f, s).dot(dx) *
                   valueAt(potential, 2 * std::asin(std::min(1.0, 0.5 * chord)));
        });
    };
    std::vector<double> ends{0, 1};
    if (!far) {
        std::vector<Site> sites;
        for (const double end : {0.0, 1.0}) {
            const V3d y = at(f, end);
            const double s = nearestPlace(e, y), d = (at(e, s) - y).length() / e.length;
            sites.push_back({s, std::max(d, 1e-10)});
        }
        // Where the two are nearest, by turns.
        double s = 0.5, r = 0.5;
        for (int i = 0; i < 100; ++i) {
            r = std::clamp(nearestPlace(f, at(e, s)), 0.0, 1.0);
            s = std::clamp(nearestPlace(e, at(f, r)), 0.0, 1.0);
        }
        sites.push_back({s, std::max((at(e, s) - at(f, r)).length() / e.length, 1e-9)});
        ends = panels(sites);
    }
    return overPanels(ends, far ? kFar : kNear,
                      [&](double s) { return inner(at(e, s), tangent(e, s)); });
}

} // namespace

Potential makePotential(const std::function<double(double h)>& lobe) {
    static const Rule kRule = gauss(10);
    constexpr int kSteps = 2000;
    Potential potential;
    potential.step = std::log(0.5 * kPi / kLeast) / kSteps;
    const auto massBetween = [&](double from, double to) { // of log t
        double sum = 0;
        for (std::size_t i = 0; i < kRule.x.size(); ++i) {
            const double t = std::exp(from + (to - from) * kRule.x[i]), s = std::sin(0.5 * t);
            sum += kRule.w[i] * (to - from) * t * 2 * kPi * std::sin(t) * lobe(s * s);
        }
        return sum;
    };
    const auto node = [&](double i) { return std::log(kLeast) + i * potential.step; };
    std::vector<double> beyond(kSteps + 1, 0.0);
    for (int i = kSteps - 1; i >= 0; --i)
        beyond[i] = beyond[i + 1] + massBetween(node(i), node(i + 1));
    const double all = beyond[0];
    potential.value.assign(kSteps + 1, 0.0);
    for (int i = 0; i <= kSteps; ++i) {
        const double t = std::exp(node(i));
        potential.slope.push_back(-beyond[i] / all * t * potential.step / (2 * kPi * std::sin(t)));
    }
    for (int i = kSteps - 1; i >= 0; --i) {
        potential.value[i] = potential.value[i + 1];
        for (std::size_t k = 0; k < kRule.x.size(); ++k) {
            const double x = node(i + kRule.x[k]), t = std::exp(x);
            const double mass = (beyond[i + 1] + massBetween(x, node(i + 1))) / all;
            potential.value[i] += kRule.w[k] * potential.step * t * mass / (2 * kPi * std::sin(t));
        }
    }
    return potential;
}

namespace {

std::array<double, 3> changeWithin(const Image& latlong, const Potential& potential,
                                   const std::vector<Curve>& outline, double signed_area) {
    const int w = latlong.width, h = latlong.height;
    std::array<double, 3> change{};
    const auto add = [&](const std::vector<Curve>& side, const float* left, const float* right) {
        double sum = 0;
        for (const Curve& f : side)
            for (const Curve& e : outline)
                sum += pairIntegral(potential, e, f);
        for (int c = 0; c < 3; ++c)
            change[c] -= sum * (double(left[c]) - double(right[c])) / signed_area;
    };
    // Seen from outside columns run to the west: eastwards, counter-clockwise, is a row's lower
    // side.
    for (int j = 0; j < h; ++j) {
        for (int i = 0; i < w; ++i) {
            const double theta = kPi * j / h, phi = 2 * kPi * (0.5 - double(i) / w);
            std::vector<Curve> parallel, meridian;
            if (j > 0) {
                addParallel(theta, phi, -2 * kPi / w, parallel);
                add(parallel, latlong.at(i, j), latlong.at(i, j - 1));
            }
            // In two: an arc's ends must not be opposite one another.
            const double middle = kPi * (j + 0.5) / h, bottom = kPi * (j + 1) / h;
            addArc(direction(theta, phi), direction(middle, phi), meridian);
            addArc(direction(middle, phi), direction(bottom, phi), meridian);
            add(meridian, latlong.at((i + w - 1) % w, j), latlong.at(i, j));
        }
    }
    return change;
}

} // namespace

std::array<double, 3> contourChange(const Image& latlong, const Potential& potential, int face,
                                    int x, int y, int edge) {
    std::vector<Curve> outline;
    const auto corner = [&](double i, double j) {
        const Direction d = cubeDirection(face, x - 0.5 + i, y - 0.5 + j, edge);
        return V3d(d.x, d.y, d.z);
    };
    const V3d corners[4] = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
    for (int k = 0; k < 4; ++k)
        addArc(corners[k], corners[(k + 1) % 4], outline);
    // The solid angle of two spherical triangles (Van Oosterom and Strackee 1983).
    const auto triangle = [&](const V3d& a, const V3d& b, const V3d& c) {
        return 2 * std::atan2(a.dot(b.cross(c)), 1 + a.dot(b) + b.dot(c) + c.dot(a));
    };
    return changeWithin(latlong, potential, outline,
                        triangle(corners[0], corners[1], corners[2]) +
                            triangle(corners[0], corners[2], corners[3]));
}

std::array<double, 3> latlongContourChange(const Image& latlong, const Potential& potential, int x,
                                           int y, int width, int height) {
    const double top = kPi * y / height, bottom = kPi * (y + 1) / height;
    const double west = 2 * kPi * (0.5 - double(x) / width), turn = -2 * kPi / width;
    std::vector<Curve> outline;
    // To the next column along the bottom, north, back, south: clockwise as seen from outside.
    addParallel(bottom, west, turn, outline);
    addArc(direction(bottom, west + turn), direction(top, west + turn), outline);
    addParallel(top, west + turn, -turn, outline);
    addArc(direction(top, west), direction(bottom, west), outline);
    return changeWithin(latlong, potential, outline, turn * (std::cos(top) - std::cos(bottom)));
}

} // namespace ibl::oracle
