#include "convolve/texels.h"

#include "core/parallel.h"
#include "panorama/layouts.h"

#include <optional>

namespace ibl {

TexelPoints texelPoints(const Panorama& map, int threads) {
    const int width = map.image.width, height = map.image.height;
    std::vector<TexelPoints> rows(height);
    parallelFor(height, threads, [&](std::size_t row) {
        const int y = static_cast<int>(row);
        TexelPoints& points = rows[row];
        for (int x = 0; x < width; ++x) {
            const std::optional<V3d> d =
                texelDirection(map.layout, width, height, x + 0.5, y + 0.5);
            if (!d) continue;
            const V2d p = latlongPoint(*d);
            points.pixel.push_back(static_cast<std::uint32_t>(y) * width + x);
            points.u.push_back(p.x);
            points.v.push_back(p.y);
            points.solid_angle.push_back(texelSolidAngle(map.layout, width, height, x, y));
        }
    });
    TexelPoints all;
    const auto append = [](auto& to, const auto& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    for (const TexelPoints& points : rows) {
        append(all.pixel, points.pixel);
        append(all.u, points.u);
        append(all.v, points.v);
        append(all.solid_angle, points.solid_angle);
    }
    return all;
}

} // namespace ibl
