#include "convolve/reading_error.h"

#include "convolve/analysis.h"
#include "convolve/probe_scale.h"
#include "convolve/texels.h"
#include "core/parallel.h"
#include "panorama/conventions.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

/// Degrees that a lobe leaves less of are not looked at: with the energy of all of them, which is a
/// tenth of the probe's at most, that is below what `high` asks for.
constexpr double kUnseen = 2e-6;
constexpr int kLeastDegree = 8;

/// Of half as many rows and columns (rounded up), the means of 2 x 2 pixels.
struct Halved {
    Image image;
    double lost = 0; ///< integral over the sphere of the squares of what pixels differ from it
};

Halved halve(const Image& latlong, double scale, int threads) {
    const int width = latlong.width, height = latlong.height;
    Halved halved{Image((width + 1) / 2, (height + 1) / 2), 0};
    std::vector<double> lost(halved.image.height);
    parallelFor(lost.size(), threads, [&](std::size_t y) {
        const int top = static_cast<int>(2 * y), rows = std::min(2, height - top);
        const std::array<double, 2> weights{latlongPixelSolidAngle(width, height, top),
                                            latlongPixelSolidAngle(width, height, top + 1)};
        float* out = halved.image.row(static_cast<int>(y));
        for (int left = 0; left < width; left += 2) {
            const int columns = std::min(2, width - left);
            std::array<double, 3> sum{}, squares{};
            double area = 0;
            for (int j = 0; j < rows; ++j) {
                const double weight = weights[j];
                const float* pixel = latlong.at(left, top + j);
                for (int k = 0; k < 3 * columns; ++k) {
                    const double value = pixel[k] * scale;
                    sum[k % 3] += weight * value;
                    squares[k % 3] += weight * value * value;
                }
                area += weight * columns;
            }
            for (int c = 0; c < 3; ++c) {
                *out++ = static_cast<float>(sum[c] / area / scale);
                lost[y] += std::max(0.0, squares[c] - sum[c] * sum[c] / area);
            }
        }
    });
    for (const double row : lost)
        halved.lost += row;
    return halved;
}

Harmonics harmonicsOf(const Image& image, double scale, int degree, int threads) {
    return analyse(analyseRows(image, scale, kNoThreshold, degree, threads), degree, threads);
}

/// How much of each degree a map shows.
struct Shown {
    /// Not exceeded: the lobe's coefficients times the envelope of the mean over a texel, of half
    /// the width that the map's have about, as the smallest of a cube's are.
    std::vector<double> most;
    int whole = 0; ///< up to this degree texels take nothing away: the map's norm is summed so far
};

Shown shownBy(const PrefilterRequest& request, int bands) {
    Shown shown{zonalCoefficients(request.lobe, bands)};
    const double texel = texelAngle(request);
    const double side = texel * footprintOf(request.lobe, texel, kAnyDegree).scale;
    for (int l = 1; l < bands; ++l)
        shown.most[l] = std::abs(shown.most[l]) * std::min(1.0, 4 / std::max(1e-300, l * side));
    shown.whole = side * bands < 1 ? bands : static_cast<int>(1 / side);
    return shown;
}

/// The last degree that is not unseen, or that there is.
int degreeOf(const std::vector<double>& shown) {
    int degree = static_cast<int>(shown.size()) - 1;
    while (degree > kLeastDegree && shown[degree] < kUnseen)
        --degree;
    return degree;
}

} // namespace

std::vector<ReadingError> readingErrors(const Image& latlong,
                                        std::span<const PrefilterRequest> requests, int threads) {
    const int bands = std::clamp(latlong.height, kLeastDegree + 1, 4096);
    std::vector<Shown> shown(requests.size());
    int degree = -1;
    for (std::size_t i = 0; i < requests.size(); ++i) {
        if (isMirror(requests[i].lobe)) continue;
        shown[i] = shownBy(requests[i], bands);
        degree = std::max(degree, degreeOf(shown[i].most));
    }
    std::vector<ReadingError> errors(requests.size());
    if (degree < 0) return errors;
    const double scale = probeScale(latlong, threads);
    const Halved halved = halve(latlong, scale, threads);
    Harmonics harmonics = harmonicsOf(latlong, scale, degree, threads);
    const std::vector<double> probe = powerSpectrum(harmonics);
    const Harmonics of_half = harmonicsOf(halved.image, scale, degree, threads);
    for (std::size_t i = 0; i < harmonics.coefficients.size(); ++i) {
        for (int part = 0; part < kParts; ++part)
            harmonics.coefficients[i][part] -= of_half.coefficients[i][part];
    }
    const std::vector<double> power = powerSpectrum(harmonics);
    double left = halved.lost;
    for (double s : power)
        left -= s;
    left = std::max(0.0, left);
    for (std::size_t i = 0; i < requests.size(); ++i) {
        const std::vector<double>& most = shown[i].most;
        if (most.empty()) continue;
        double norm = 0, sum = 0, at_point = 0;
        for (int l = 0; l <= std::min(degree, shown[i].whole); ++l)
            norm += most[l] * most[l] * probe[l];
        for (int l = 0; l <= degree; ++l) {
            const double square = most[l] * most[l] * power[l];
            sum += square;
            at_point += std::sqrt((2 * l + 1) / (4 * kPi) * square);
        }
        if (norm <= 0) continue;
        errors[i].bound = std::sqrt((sum + most[degree] * most[degree] * left) / norm);
        errors[i].worst = at_point / std::sqrt(probe[0] / (36 * kPi) + 1e-300);
        errors[i].estimate = errors[i].bound / 3;
    }
    return errors;
}

} // namespace ibl
