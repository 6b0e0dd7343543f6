#include "convolve/fill_map.h"

#include "core/parallel.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"

#include <algorithm>
#include <vector>

namespace ibl {
namespace {

/// Fills row y of the map.
void fillRow(const PrefilterRequest& request, const Footprint& footprint, const Ingredients& parts,
             int y, Image& map, MapNorm& norm) {
    RowPoints own;
    if (!parts.at_points) own = rowPoints(request.layout, map.width, map.height, y, footprint);
    const RowPoints& points = parts.at_points ? parts.at_points->rows[y] : own;
    const std::size_t count = points.u.size();
    std::vector<double> values(3 * count, 0.0);
    if (parts.field) {
        std::vector<float> smooth(3 * count);
        sampleField(*parts.field, points.u.data(), points.v.data(), static_cast<int>(count),
                    smooth.data());
        std::ranges::copy(smooth, values.begin());
    }
    if (parts.at_points) {
        const double* row = parts.at_points->values.data() + 3 * parts.at_points->first[y];
        std::copy_n(row, 3 * count, values.begin());
    }
    if (parts.peaks) {
        addPeaks(*parts.peaks, points, values.data());
    }
    for (std::size_t i = 0; parts.direct && i < count; ++i) {
        addDirect(*parts.direct, makeAxis(points.u[i], points.v[i]), &values[3 * i]);
    }
    float* out = map.row(y);
    std::fill(out, out + map.rowFloats(), 0.0f);
    for (std::size_t t = 0; t < points.column.size(); ++t) {
        float* texel = out + std::size_t{3} * points.column[t];
        for (int c = 0; c < 3; ++c) {
            double value = 0;
            for (std::size_t i = points.first[t]; i < points.first[t + 1]; ++i)
                value += points.share[i] * values[3 * i + c];
            value /= parts.scale;
            if (parts.map) value += parts.map->at(points.column[t], y)[c];
            // Rounding and the truncated tails may leave a little below zero beside a sun; a mean
            // of non-negative radiance is not.
            if (!parts.negative) value = std::max(0.0, value);
            texel[c] = static_cast<float>(value);
            norm.add(points.solid_angle[t], value);
        }
    }
}

} // namespace

PrefilterResult emptyResult(const PrefilterRequest& request) {
    PrefilterResult result;
    const V2i extent = layoutExtent(request.layout, request.size);
    result.map = {request.layout, Image(extent.x, extent.y)};
    return result;
}

void fillMap(const PrefilterRequest& request, const Footprint& footprint, const Ingredients& parts,
             int threads, Panorama& map, MapNorm& norm, Progress* progress) {
    std::vector<MapNorm> rows(map.image.height);
    parallelFor(rows.size(), threads, [&](std::size_t y) {
        fillRow(request, footprint, parts, static_cast<int>(y), map.image, rows[y]);
        if (progress) progress->step();
    });
    for (const MapNorm& row : rows)
        norm.add(row);
    mergeBorder(map);
}

} // namespace ibl
