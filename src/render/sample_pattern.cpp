#include "render/sample_pattern.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace ibl {

std::vector<V2d> samplePattern(int count) {
    const auto n = static_cast<std::size_t>(count);
    const auto fraction = [](std::size_t i) {
        const double x = static_cast<double>(i) / std::numbers::phi;
        return x - std::floor(x);
    };
    std::vector<std::size_t> by_height(n);
    std::iota(by_height.begin(), by_height.end(), std::size_t{0});
    std::sort(by_height.begin(), by_height.end(),
              [&](std::size_t a, std::size_t b) { return fraction(a) < fraction(b); });
    std::vector<V2d> points(n);
    for (std::size_t rank = 0; rank < n; ++rank) {
        points[by_height[rank]] = {(static_cast<double>(by_height[rank]) + 0.5) / count,
                                   (static_cast<double>(rank) + 0.5) / count};
    }
    return points;
}

} // namespace ibl
