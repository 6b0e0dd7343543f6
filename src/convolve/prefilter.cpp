#include "convolve/prefilter.h"

#include "convolve/analysis.h"
#include "convolve/synthesis.h"
#include "convolve/texels.h"
#include "core/error.h"
#include "core/parallel.h"
#include "panorama/layouts.h"

#include <algorithm>
#include <cmath>

namespace ibl {

PrefilterOptions optionsFor(Quality quality, int threads) {
    for (const QualityRow& row : kQualities) {
        if (row.quality == quality) return {row.max_error, quality == Quality::reference, threads};
    }
    return {};
}

std::vector<PrefilterResult> prefilter(const Image& latlong,
                                       std::span<const PrefilterRequest> requests,
                                       const PrefilterOptions& options) {
    const int degree = 256;
    const RowSpectrum rows = analyseRows(latlong, 1, degree, options.threads);
    const Harmonics harmonics = analyse(rows, degree, options.threads);
    std::vector<PrefilterResult> results;
    for (const PrefilterRequest& request : requests) {
        PrefilterResult result;
        const V2i extent = layoutExtent(request.layout, request.size);
        result.map = {request.layout, Image(extent.x, extent.y)};
        std::ranges::fill(result.map.image.pixels, 0.0f);
        const std::vector<double> k = zonalCoefficients(request.lobe, degree + 1);
        const SmoothField field = synthesise(harmonics, k, degree, options.threads);
        const TexelPoints points = texelPoints(result.map, options.threads);
        for (std::size_t i = 0; i < points.size(); ++i) {
            sampleField(field, &points.u[i], &points.v[i], 1,
                        result.map.image.pixels.data() + std::size_t{3} * points.pixel[i]);
        }
        result.band_limit = degree;
        results.push_back(std::move(result));
    }
    return results;
}

} // namespace ibl
