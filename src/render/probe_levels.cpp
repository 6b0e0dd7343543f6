#include "render/probe_levels.h"

#include "core/parallel.h"
#include "panorama/lookup.h"
#include "panorama/resample.h"

#include <algorithm>
#include <bit>

namespace ibl {
namespace {

constexpr int kLargestEdge = 1024;

/// 1 3 3 1 / 8 across and down: bilinear lookups 3/4 of a texel from the new texel's centre, either
/// way, weigh their neighbours by 1/4 and 3/4.
Panorama halved(const Panorama& fine, int threads) {
    const int edge = fine.image.width / 2;
    const double offset = 3.0 / 8; // of a new texel
    Panorama coarse{Layout::faces, Image(edge, 6 * edge)};
    const Sampler sampler = makeSampler(fine);
    parallelFor(static_cast<std::size_t>(6 * edge), threads, [&](std::size_t row) {
        const int face = static_cast<int>(row) / edge, j = static_cast<int>(row) % edge;
        for (int i = 0; i < edge; ++i) {
            V3d sum(0);
            for (int k = 0; k < 4; ++k) {
                const double x = i + 0.5 + (k & 1 ? offset : -offset);
                const double y = j + 0.5 + (k & 2 ? offset : -offset);
                sum +=
                    radianceAt(sampler, cubeDirection({face, 2 * x / edge - 1, 2 * y / edge - 1}));
            }
            for (int c = 0; c < 3; ++c)
                coarse.image.at(i, static_cast<int>(row))[c] = static_cast<float>(sum[c] / 4);
        }
    });
    return coarse;
}

} // namespace

int cubeEdge(const Panorama& probe) {
    const bool latlong = probe.layout == Layout::latlong || probe.layout == Layout::exrLatlong;
    const int size = *layoutSize(probe.layout, probe.image.width, probe.image.height);
    return static_cast<int>(std::bit_ceil(static_cast<unsigned>(latlong ? size : 2 * size)));
}

std::vector<Panorama> probeLevels(const Panorama& probe, int threads) {
    const int edge = std::min(2 * cubeEdge(probe), kLargestEdge);
    std::vector<Panorama> levels;
    levels.push_back(resample(probe, Layout::faces, edge, threads, Enlarging::hold));
    while (levels.back().image.width > 1)
        levels.push_back(halved(levels.back(), threads));
    return levels;
}

} // namespace ibl
