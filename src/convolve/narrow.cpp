#include "convolve/narrow.h"

#include "convolve/gauss.h"
#include "convolve/plan.h"
#include "panorama/conventions.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

double alphaSquared(const Lobe& lobe) {
    return std::pow(lobe.parameter, 4);
}

double squaredSine(double t) {
    const double s = std::sin(0.5 * t);
    return s * s;
}

} // namespace

NearKernel::NearKernel(const Lobe& lobe, double u, double negligible)
    : lobe_(lobe), u_(u), norm_(1 / lobeIntegral(lobe)), mass_beyond_(lobe) {
    mass = massBeyond(0);
    width = 0.5 * lobeWidth(lobe);
    if (u > 0) width = std::min(width, std::sqrt(2 / u));
    double low = 0, high = 0.5 * kPi;
    for (int i = 0; i < 40; ++i) {
        const double mid = 0.5 * (low + high);
        (massBeyond(squaredSine(mid)) > negligible ? low : high) = mid;
    }
    reach = high;
}

double NearKernel::value(double h) const {
    if (u_ == 0) return norm_ * lobeValue(lobe_, 1 - 2 * h);
    // From the cosine q would not be known: it is 1e-16 on the axis of roughness 1e-4.
    const double a2 = alphaSquared(lobe_), q = a2 + (1 - a2) * h, uq = u_ * q;
    return norm_ * a2 / (kPi * q * q) * (1 - 2 * h) * std::exp(-uq) * (1 + uq);
}

// With beta = 1 - alpha^2, 2 pi sin t dt = 4 pi dh and cos t = 1 - 2h = (1 + 2 alpha^2 / beta) -
// (2 / beta) q the mass beyond h is 4 alpha^2 / beta times the integral over q' from q of
//
//     exp(-u q') (1 + u q') / q'^2  dq' = -d [exp(-u q') / q'],
//     exp(-u q') (1 + u q') / q'    dq' = -d [E_1(u q') + exp(-u q')].
//
// At the horizon nothing is left of it: u is 1e4 or more.
double NearKernel::massBeyond(double h) const {
    if (u_ == 0) return mass_beyond_(h);
    const double a2 = alphaSquared(lobe_), beta = 1 - a2, q = a2 + beta * h;
    const double fall = std::exp(-u_ * q);
    if (fall < 1e-30) return 0;
    const double e1 = -std::expint(-u_ * q);
    const double lobe = (1 + 2 * a2 / beta) * fall / q - 2 / beta * (e1 + fall);
    return norm_ * 4 * a2 / beta * lobe;
}

std::vector<double> farCoefficients(std::vector<double> k, const NearKernel& near) {
    const auto subtract = [&](double weight, double x) { // weight * P_l(x)
        double previous = 0, current = 1;
        for (std::size_t l = 0; l < k.size(); ++l) {
            k[l] -= weight * current;
            const double n = static_cast<double>(l);
            const double next = ((2 * n + 1) * x * current - n * previous) / (n + 1);
            previous = current;
            current = next;
        }
    };
    // By parts: k_l = 2 pi int K P_l sin t dt over panels that grow with the distance.
    const GaussRule& rule = gaussRule(16);
    const double longest = 8.0 / static_cast<double>(k.size());
    double from = 0;
    while (from < near.reach) {
        const double to = std::min(near.reach, from + std::min(longest, from + 2 * near.width));
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double t = 0.5 * (from + to) + 0.5 * (to - from) * rule.nodes[i];
            subtract(0.5 * (to - from) * rule.weights[i] * 2 * kPi * std::sin(t) *
                         near.value(squaredSine(t)),
                     std::cos(t));
        }
        from = to;
    }
    // What lies beyond the reach counts as lying on it (EdgeTable): a ring.
    subtract(near.massBeyond(squaredSine(near.reach)), std::cos(near.reach));
    k[0] = 1 - near.mass;
    return k;
}

LobeSplit splitLobe(const Lobe& lobe, const std::vector<double>& k, int degree, double allowed) {
    // What lies beyond the reach is off by its distance from the pixels that it is counted in.
    const double negligible = kBeyondReach * allowed;
    if (lobe.kernel != Kernel::ggx) return {NearKernel(lobe, 0, negligible), 0, {}};
    for (double widths = 2.5;; widths += 0.25) {
        const double u = 2 * std::pow(degree / widths, 2);
        const NearKernel near(lobe, u, negligible);
        const std::vector<double> far = farCoefficients(k, near);
        if (tailMaximum(far)[static_cast<std::size_t>(degree)] <= allowed || widths >= 6.5)
            return {near, degree, far};
    }
}

} // namespace ibl
