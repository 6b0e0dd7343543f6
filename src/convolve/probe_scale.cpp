#include "convolve/probe_scale.h"

#include "core/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace ibl {

Error notFinite() {
    return {ExitCode::input, "probe: has pixels that are not finite; repair them first"};
}

double scaleFor(float most) {
    return most > 0 ? std::ldexp(1.0, -std::ilogb(most)) : 1;
}

double probeScale(const Image& probe, int threads) {
    std::vector<float> rows(probe.height, 0.0f);
    parallelFor(probe.height, threads, [&](std::size_t j) {
        const float* p = probe.row(static_cast<int>(j));
        float most = 0, finite = 0;
        for (std::size_t i = 0; i < probe.rowFloats(); ++i) {
            most = std::max(most, std::abs(p[i]));
            finite += 0 * p[i]; // NaN unless every value is finite
        }
        rows[j] = finite == 0 ? most : std::numeric_limits<float>::quiet_NaN();
    });
    float most = 0;
    for (const float row : rows) {
        if (!std::isfinite(row)) throw notFinite();
        most = std::max(most, row);
    }
    return scaleFor(most);
}

} // namespace ibl
