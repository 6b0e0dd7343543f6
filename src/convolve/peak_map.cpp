#include "convolve/peak_map.h"

#include "convolve/near_weights.h"
#include "core/parallel.h"
#include "panorama/layouts.h"

#include <algorithm>

namespace ibl {

Image peakMap(const std::vector<Peak>& peaks, double scale, int width, int height,
              const PrefilterRequest& request, const Footprint& footprint, int threads) {
    const V2i size = layoutExtent(request.layout, request.size);
    const MapExtent map{request.layout, size.x, size.y, texelAngle(request)};
    NearRules rules = nearRules(kPeakMapError);
    rules.nodes = 2; // what touches in a plane is not met here
    const NearField field =
        makeNearField(NearKernel(request.lobe, 0, 0), rules, width, height, threads);
    Image result(size.x, size.y);
    const std::size_t texels = static_cast<std::size_t>(size.x) * size.y;
    parallelFor(texels, threads, [&](std::size_t at) {
        const int x = static_cast<int>(at) % size.x, y = static_cast<int>(at) / size.x;
        float* texel = result.at(x, y);
        std::fill_n(texel, 3, 0.0f);
        if (!texelDirection(map.layout, map.width, map.height, x + 0.5, y + 0.5)) return;
        const std::vector<double> masses = peakMasses(field, map, x, y, footprint, peaks);
        for (int c = 0; c < 3; ++c) {
            double sum = 0;
            for (std::size_t p = 0; p < peaks.size(); ++p)
                sum += masses[p] * peaks[p].excess[c];
            texel[c] = static_cast<float>(sum / scale);
        }
    });
    return result;
}

} // namespace ibl
