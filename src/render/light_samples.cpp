#include "render/light_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace ibl {
namespace {

/// Largest share, over the channels, of the sum of all strengths.
std::vector<double> sharesOf(std::span<const SceneLight> lights) {
    V3d total(0);
    for (const SceneLight& light : lights)
        total += light.strength;
    std::vector<double> shares;
    for (const SceneLight& light : lights) {
        double share = light.type == LightType::directional ? 0 : 1;
        for (int c = 0; c < 3; ++c) {
            if (total[c] > 0) share = std::max(share, light.strength[c] / total[c]);
        }
        shares.push_back(share);
    }
    return shares;
}

} // namespace

std::vector<std::vector<SampledLight>> spreadLights(std::span<const SceneLight> lights, int samples,
                                                    double step) {
    std::vector<std::vector<SampledLight>> lists(static_cast<std::size_t>(samples));
    const std::vector<double> shares = sharesOf(lights);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const int count = std::clamp(static_cast<int>(std::ceil(shares[i] / step)), 1, samples);
        // The first by the golden ratio, so that lights which follow each other in the list, and
        // stand side by side in the sky, are far apart among the samples.
        const double start = static_cast<double>(i) / std::numbers::phi;
        const auto first = static_cast<int>((start - std::floor(start)) * samples);
        for (int k = 0; k < count; ++k) {
            const auto later = static_cast<int>(static_cast<std::int64_t>(k) * samples / count);
            lists[static_cast<std::size_t>((first + later) % samples)].push_back(
                {i, static_cast<double>(samples) / count});
        }
    }
    return lists;
}

} // namespace ibl
