#include "convolve/direct_map.h"

#include "convolve/direct.h"
#include "convolve/error_bound.h"
#include "convolve/fill_map.h"
#include "convolve/near_map.h"
#include "convolve/near_own_texels.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"

#include <algorithm>

namespace ibl {
namespace {

bool ownTexels(const PlacedProbe& probe, const Lobe& lobe) {
    return probe.source && seesOwnTexels(*probe.source, lobe);
}

/// What texels' own means are of, for nearMap: of lobes too narrow for the lat-long's pixels, which
/// see the light that is moved between those, the probe that it was read from. (Of faces of 64 of a
/// night, 2048 rows: a lobe half as wide as a pixel would be off by 4e-4 and not 1.2e-4, GGX 0.003
/// is 5e-4 from the mirror and not 7e-3.)
const Panorama& areasFor(const PlacedProbe& probe, const Lobe& lobe) {
    const bool narrower = lobeWidth(lobe) < 0.25 * kPi / probe.image.height;
    return probe.source && narrower ? *probe.source : probe.panorama;
}

} // namespace

const NearRules& nearRulesFor(const PlacedProbe& probe, const Lobe& lobe, double max_error) {
    // Coarse probes' edges are long and few.
    constexpr double kCoarse = 0.5 * kPi / 100;
    const bool coarse = ownTexels(probe, lobe) && pixelAngle(*probe.source) > kCoarse;
    return nearRules(coarse ? std::min(max_error, 1e-5) : max_error);
}

Image nearMapOf(const PlacedProbe& probe, const NearKernel& kernel, const NearRules& rules,
                const PrefilterRequest& request, const Footprint& footprint, int threads,
                Progress* progress) {
    // Faces have the most texels that share weights.
    if (isCubeFamily(request.layout) && request.layout != Layout::faces) {
        PrefilterRequest faces = request;
        faces.layout = Layout::faces;
        return resample({Layout::faces,
                         nearMapOf(probe, kernel, rules, faces, footprint, threads, progress)},
                        request.layout, request.size, threads)
            .image;
    }
    const NearField field =
        makeNearField(kernel, rules, probe.image.width, probe.image.height, threads);
    if (ownTexels(probe, request.lobe))
        return nearMapOfOwnTexels(*probe.source, field, request, footprint, threads, progress);
    return nearMap(probe.panorama, areasFor(probe, request.lobe), field, request, footprint,
                   threads, progress);
}

PrefilterResult directMap(const PlacedProbe& probe, const PrefilterRequest& request, int threads,
                          Progress& progress) {
    const Stopwatch watch;
    PrefilterResult result = emptyResult(request);
    const Footprint footprint = footprintOf(request.lobe, texelAngle(request), kAnyDegree);
    if (footprint.scale > 0 || ownTexels(probe, request.lobe)) {
        const NearRules& rules = nearRules(0);
        const NearKernel whole(request.lobe, 0, 0);
        result.map.image = nearMapOf(probe, whole, rules, request, footprint, threads, &progress);
        if (!probe.negative)
            for (float& p : result.map.image.pixels)
                p = std::max(0.0f, p);
        result.error_bound = result.error_estimate = rules.error;
    } else {
        const DirectSum direct = makeDirectSum(request.lobe, probe.image, probe.scale);
        Ingredients parts{probe.scale, probe.negative};
        parts.direct = &direct;
        MapNorm norm;
        fillMap(request, footprint, parts, threads, result.map, norm, &progress);
        result.error_bound = result.error_estimate = kFloatRounding;
        result.worst_bound = roundingOfBrightest(result.map.image, norm);
    }
    result.seconds_spatial = watch.seconds();
    return result;
}

bool isSummedSoon(const PlacedProbe& probe, const PrefilterRequest& request, double texels) {
    // Of a texel and a pixel, as measured: by a point and by outlines, of rings besides. A face's
    // outline in one piece has many arcs.
    constexpr double kPoint = 0.12e-6, kPointOfRing = 0.25e-6;
    constexpr double kOutlines = 3e-6, kOutlinesOfRing = 6e-6, kOutlinesOfFaces = 25e-6;
    const bool is_ring = request.lobe.kernel == Kernel::charlie;
    const double texel = texelAngle(request);
    double each = is_ring ? kPointOfRing : kPoint;
    if (footprintOf(request.lobe, texel, kAnyDegree).scale > 0)
        each = texel > 1 ? kOutlinesOfFaces : is_ring ? kOutlinesOfRing : kOutlines;
    return each * texels * probe.image.width * probe.image.height <= 12;
}

void sumDirectly(const PlacedProbe& probe, const PrefilterRequest& request,
                 const std::vector<V2i>& texels, int threads, Panorama& map) {
    const DirectSum direct = makeDirectSum(request.lobe, probe.image, probe.scale);
    Image& image = map.image;
    parallelFor(texels.size(), threads, [&](std::size_t i) {
        const V2i at = texels[i];
        const V2d p = latlongPoint(
            *texelDirection(request.layout, image.width, image.height, at.x + 0.5, at.y + 0.5));
        double sum[3] = {0, 0, 0};
        addDirect(direct, makeAxis(p.x, p.y), sum);
        for (int c = 0; c < 3; ++c) {
            const double value = sum[c] / probe.scale;
            image.at(at.x, at.y)[c] =
                static_cast<float>(probe.negative ? value : std::max(0.0, value));
        }
    });
}

} // namespace ibl
