// Texels of a map that share the weights of one of them.
#pragma once

#include "core/parallel.h"
#include "core/progress.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"

#include <algorithm>
#include <atomic>
#include <vector>

namespace ibl {

/// A texel and the one, y * width + x, whose weights it uses.
struct KeyedTexel {
    int key, x, y;
};

/// The map of that layout and extent: each texel `sum(weights, x, y)` of `weigh(x, y)` of its key's
/// texel, others 0. Progress is told a step for each of the map's rows, if at all.
template <class Weigh, class Sum>
Image sumByKeys(Layout layout, const V2i& extent, std::vector<KeyedTexel> texels, int threads,
                Progress* progress, const Weigh& weigh, const Sum& sum) {
    std::ranges::stable_sort(texels, {}, &KeyedTexel::key);
    std::vector<std::size_t> first;
    for (std::size_t i = 0; i < texels.size(); ++i)
        if (i == 0 || texels[i].key != texels[i - 1].key) first.push_back(i);
    first.push_back(texels.size());
    Panorama result{layout, Image(extent.x, extent.y)};
    std::ranges::fill(result.image.pixels, 0.0f);
    std::atomic<std::size_t> finished = 0;
    const std::size_t groups = first.size() - 1, rows = static_cast<std::size_t>(extent.y);
    // Of a map of few texels each may take seconds.
    const std::size_t at_once = std::clamp<std::size_t>(groups / 64, 1, 16);
    parallelForRuns(groups, at_once, threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t group = begin; group < end; ++group) {
            const int key = texels[first[group]].key;
            const auto weights = weigh(key % extent.x, key / extent.x);
            for (std::size_t i = first[group]; i < first[group + 1]; ++i) {
                const KeyedTexel& t = texels[i];
                const V3d value = sum(weights, t.x, t.y);
                for (int c = 0; c < 3; ++c)
                    result.image.at(t.x, t.y)[c] = static_cast<float>(value[c]);
            }
            const std::size_t at = finished++;
            for (std::size_t row = at * rows / groups; row < (at + 1) * rows / groups; ++row)
                if (progress) progress->step();
        }
    });
    mergeBorder(result);
    return std::move(result.image);
}

} // namespace ibl
