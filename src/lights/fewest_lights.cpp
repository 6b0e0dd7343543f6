// Every number of cuts has to be shown to miss the error, but not every one has to be tried. The
// error is a norm of the difference between probe and lights (irradiance_error.h), and a cut
// changes the lights, and so the difference, by a step whose norm follows from the three lights
// that it takes and makes. From one number of cuts to a later one the error falls by no more than
// the steps between them have together, so all that the steps cannot bring to the wanted error are
// skipped. A difference up to a lower degree has a smaller error still, and is quicker to follow.
#include "lights/fewest_lights.h"

#include "core/error.h"
#include "lights/irradiance_error.h"
#include "lights/lit_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace ibl {
namespace {

struct Search {
    const Image& latlong;
    const LightRequest& request;
    const LitTree& cuts;
    const std::vector<RegionSums>& sums;
    const LightHarmonics& probe;
    int threads;
};

/// The cuts of a probe, and the lights of their nodes.
struct Cuts {
    const LitTree& lit;
    std::vector<Light> lights; ///< of every node; of dark ones without light
    /// What the lights after each number of cuts add to the squared error beyond the degree.
    std::vector<double> beyond;
};

Cuts cutsOf(const Search& s, double norm) {
    Cuts cuts{s.cuts, std::vector<Light>(s.cuts.tree.nodes.size()), {}};
    std::vector<double> beyond;
    for (std::size_t node = 0; node < cuts.lights.size(); ++node) {
        if (s.cuts.is_lit[node]) {
            cuts.lights[node] = lightOf(s.sums[node], s.cuts.tree.nodes[node], s.latlong.width,
                                        s.latlong.height, s.request.placement);
        }
        beyond.push_back(powerBeyond(s.probe.degree, cuts.lights[node]) / norm);
    }
    cuts.beyond.push_back(beyond[0]);
    for (std::size_t k = 0; k < s.cuts.tree.cut.size(); ++k) {
        const double change = beyond[2 * k + 1] + beyond[2 * k + 2] -
                              beyond[static_cast<std::size_t>(s.cuts.tree.cut[k])];
        cuts.beyond.push_back(cuts.beyond.back() + change);
    }
    return cuts;
}

Light negative(Light light) {
    light.irradiance = -light.irradiance;
    return light;
}

/// The probe less its lights after some cuts, to some degree.
class Difference {
public:
    Difference(const Cuts& cuts, LightHarmonics probe, double norm, int threads)
        : cuts_(cuts),
          harmonics_(std::move(probe)),
          weights_(irradianceWeights(harmonics_.degree)),
          norm_(norm),
          threads_(threads) {
        harmonics_ -= lightHarmonics({cuts.lights[0]}, harmonics_.degree, 1);
    }

    /// The error after `cuts`, no fewer than the last time.
    double errorAfter(std::size_t cuts) {
        std::vector<Light> changed;
        const auto add = [&](std::size_t node, bool made) {
            const Light& light = cuts_.lights[node];
            if (light.irradiance != V3d(0)) changed.push_back(made ? light : negative(light));
        };
        // A node that was made and cut since is not in the difference before or after.
        std::vector<bool> gone(2 * (cuts - at_), false);
        for (std::size_t k = at_; k < cuts; ++k) {
            const auto node = static_cast<std::size_t>(cuts_.lit.tree.cut[k]);
            if (node <= 2 * at_)
                add(node, false);
            else
                gone[node - 2 * at_ - 1] = true;
        }
        for (std::size_t i = 0; i < gone.size(); ++i) {
            if (!gone[i]) add(2 * at_ + 1 + i, true);
        }
        harmonics_ -= lightHarmonics(changed, harmonics_.degree, threads_);
        at_ = cuts;
        distance_ = std::sqrt(irradiancePower(harmonics_, weights_) / norm_);
        return errorAt(cuts, distance_);
    }

    /// The first number of cuts beyond the last that may have the error `wanted`; one more than
    /// there are if none may.
    std::size_t nextWithin(double wanted) const {
        double distance = distance_;
        std::size_t cuts = at_;
        while (cuts < cuts_.lit.tree.cut.size()) {
            distance = std::max(0.0, distance - step(cuts++));
            if (errorAt(cuts, distance) <= wanted) return cuts;
        }
        return cuts + 1;
    }

private:
    double errorAt(std::size_t cuts, double distance) const {
        return std::sqrt(distance * distance + std::max(0.0, cuts_.beyond[cuts]));
    }

    /// How far cut k moves the difference, rounded up.
    double step(std::size_t k) const {
        const Light& whole = cuts_.lights[static_cast<std::size_t>(cuts_.lit.tree.cut[k])];
        const std::array<Light, 3> lights{negative(whole), cuts_.lights[2 * k + 1],
                                          cuts_.lights[2 * k + 2]};
        double rounding = 0;
        for (const Light& light : lights)
            rounding += 1e-12 * light.irradiance.length2();
        return std::sqrt((std::max(0.0, irradiancePower(lights, weights_)) + rounding) / norm_);
    }

    const Cuts& cuts_;
    LightHarmonics harmonics_;
    IrradianceWeights weights_;
    double norm_;
    int threads_;
    std::size_t at_ = 0;
    double distance_ = 0; ///< the error up to the degree
};

/// The coefficients up to a lower degree.
LightHarmonics lowPart(const LightHarmonics& harmonics, int degree) {
    LightHarmonics low(degree);
    low.first = harmonics.first;
    for (int m = 0; m <= degree; ++m) {
        const auto* from = harmonics.even.data() + harmonics.column(m);
        std::copy_n(from, degree / 2 + 1 - (m + 1) / 2, low.even.data() + low.column(m));
    }
    return low;
}

/// The first number of cuts that leaves more than `lit` regions with energy.
std::size_t cutsBeyond(const LitTree& cuts, int lit) {
    int count = cuts.is_lit[0] ? 1 : 0;
    std::size_t k = 0;
    for (; count <= lit && k < cuts.tree.cut.size(); ++k)
        count += int{cuts.is_lit[2 * k + 1]} + int{cuts.is_lit[2 * k + 2]} - 1;
    return k;
}

/// Tells of each percent of the most lights that the search has left behind.
class SearchProgress {
public:
    explicit SearchProgress(const TellProgress& tell) : tell_(tell) {}

    void reached(std::size_t cuts) {
        const int percent = static_cast<int>(100 * cuts / kMostLights);
        if (tell_ && percent > std::exchange(told_, percent)) tell_(0.01 * percent);
    }
    void finish() const {
        if (tell_) tell_(1);
    }

private:
    const TellProgress& tell_;
    int told_ = 0;
};

std::optional<LightSet> firstWithin(const Search& s, std::size_t first, SearchProgress& progress) {
    const double wanted = *s.request.max_error;
    const double norm = irradiancePower(s.probe, irradianceWeights(s.probe.degree));
    const Cuts all = cutsOf(s, norm);
    Difference whole(all, s.probe, norm, s.threads);
    Difference low(all, lowPart(s.probe, s.probe.degree / 4), norm, s.threads);
    for (std::size_t cuts = first; cuts <= s.cuts.tree.cut.size();) {
        progress.reached(cuts);
        if (low.errorAfter(cuts) > wanted) {
            cuts = low.nextWithin(wanted);
            continue;
        }
        if (whole.errorAfter(cuts) <= wanted) {
            // What dark regions hold goes to lights as well; that is in the error that counts.
            LightSet set;
            set.lights = lightsAfter(s.cuts, s.sums, cuts, s.latlong, s.request.placement);
            set.irradiance_error = errorOf(set.lights, s.probe, s.threads);
            if (set.irradiance_error <= wanted) return set;
        }
        cuts = whole.nextWithin(wanted);
    }
    return std::nullopt;
}

Error cannotBeMet(double wanted, int count, double error) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "--max-error %g cannot be met: %d lights have %.2g; allow a larger error", wanted,
                  count, error);
    return Error(ExitCode::accuracy, text);
}

} // namespace

LightSet fewestLights(const Image& latlong, const LightRequest& request, int threads) {
    SearchProgress progress(request.progress);
    // As many as are compared to one degree (harmonicDegree()).
    constexpr std::array kMost{64, 1024, 16384, kMostLights};
    int tried = 0;
    for (const int most : kMost) {
        const LightHarmonics probe = probeHarmonics(latlong, harmonicDegree(most), threads);
        const LitTree cuts = cutProbe(latlong, request.method, most, threads);
        const std::vector<RegionSums> sums = allSums(latlong, cuts.tree, threads);
        if (sums[0].energy <= 0) return {};
        const auto set = firstWithin({latlong, request, cuts, sums, probe, threads},
                                     cutsBeyond(cuts, tried), progress);
        tried = litCount(cuts);
        if (!set && most < kMostLights && tried == most) continue;
        progress.finish();
        if (set) return *set;
        throw cannotBeMet(
            *request.max_error, tried,
            errorOf(lightsAfter(cuts, sums, cuts.tree.cut.size(), latlong, request.placement),
                    probe, threads));
    }
    return {};
}

} // namespace ibl
