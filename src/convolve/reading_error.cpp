#include "convolve/reading_error.h"

#include "convolve/analysis.h"
#include "convolve/narrow.h"
#include "convolve/near_own_texels.h"
#include "convolve/plan.h"
#include "convolve/probe_scale.h"
#include "convolve/texels.h"
#include "core/parallel.h"
#include "panorama/conventions.h"
#include "panorama/latlong_moments.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace ibl {
namespace {

/// Degrees that a lobe leaves less of are not looked at: with the energy of all of them, which is a
/// tenth of the probe's at most, that is below what `high` asks for.
constexpr double kUnseen = 2e-6;
constexpr int kLeastDegree = 8;
/// By how much less the error of a lat-long is than what is between it and one of half as many
/// rows: at least (3 were it to fall with their square), and about.
constexpr double kLeastFall = 2, kFall = 9;
/// At least where no more than kDegreeOfTails are read, whose waves are long beside all pixels: 7
/// for the third power (measured from octahedral maps of 512, 256 rows to 1024: 13).
constexpr double kLeastFallOfTails = 4;

/// The integral over the sphere of the squares of what the lat-long's pixels differ from the halved
/// one's.
double energyBetween(const Image& latlong, const Image& halved, double scale, int threads) {
    std::vector<double> rows(latlong.height);
    parallelFor(rows.size(), threads, [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < latlong.width; ++x) {
            const float *p = latlong.at(x, y), *q = halved.at(x / 2, y / 2);
            for (int c = 0; c < 3; ++c)
                rows[row] += std::pow((static_cast<double>(p[c]) - q[c]) * scale, 2);
        }
        rows[row] *= latlongPixelSolidAngle(latlong.width, latlong.height, y);
    });
    return std::accumulate(rows.begin(), rows.end(), 0.0);
}

Harmonics harmonicsOf(const Image& image, double scale, int degree, int threads) {
    return analyse(analyseRows(image, scale, kNoThreshold, degree, threads), degree, threads);
}

/// How much of each degree a map shows, not exceeded: the lobe's coefficients times the envelope of
/// the mean over a texel, of half the width that the map's have about, as the smallest of a cube's
/// are.
struct Shown {
    std::vector<double> all;
    std::vector<double> read; ///< of what comes from the lat-long, perhaps of fewer degrees
    bool ends = false;        ///< with the last of them; else all beyond show that at most
    int whole = 0; ///< up to this degree texels take nothing away: the map's norm is summed so far
};

Shown shownBy(const PrefilterRequest& request, int bands, bool own_texels) {
    Shown shown{zonalCoefficients(request.lobe, bands), {}, own_texels};
    shown.read = shown.all;
    if (own_texels) {
        // The tail alone, at its largest.
        const int degree = std::min(kDegreeOfTails, bands - 1);
        shown.read =
            splitLobe(request.lobe, shown.all, degree, std::numeric_limits<double>::infinity()).k;
        shown.read.resize(static_cast<std::size_t>(degree) + 1);
    }
    const double texel = texelAngle(request);
    const double side = texel * footprintOf(request.lobe, texel, kAnyDegree).scale;
    for (std::vector<double>* k : {&shown.all, &shown.read}) {
        for (std::size_t l = 1; l < k->size(); ++l) {
            (*k)[l] = std::abs((*k)[l]) *
                      std::min(1.0, 4 / std::max(1e-300, static_cast<double>(l) * side));
        }
    }
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

std::vector<ReadingError> readingErrors(const Image& latlong, const Panorama& source,
                                        std::span<const PrefilterRequest> requests, bool reference,
                                        int threads) {
    const int bands = std::clamp(latlong.height, kLeastDegree + 1, 4096);
    std::vector<Shown> shown(requests.size());
    int degree = -1;
    for (std::size_t i = 0; i < requests.size(); ++i) {
        const Lobe& lobe = requests[i].lobe;
        if (isMirror(lobe)) continue;
        const bool own = seesOwnTexels(source, lobe);
        if (own && (reference || lobe.kernel != Kernel::ggx)) continue; // no harmonics
        shown[i] = shownBy(requests[i], bands, own);
        degree = std::max(degree, degreeOf(shown[i].read));
    }
    std::vector<ReadingError> errors(requests.size());
    if (degree < 0) return errors;
    const double scale = probeScale(latlong, threads);
    const Image halved = halveKeepingMoments(latlong, threads);
    Harmonics harmonics = harmonicsOf(latlong, scale, degree, threads);
    const std::vector<double> probe = powerSpectrum(harmonics);
    const Harmonics of_half = harmonicsOf(halved, scale, degree, threads);
    for (std::size_t i = 0; i < harmonics.coefficients.size(); ++i) {
        for (int part = 0; part < kParts; ++part)
            harmonics.coefficients[i][part] -= of_half.coefficients[i][part];
    }
    const std::vector<double> power = powerSpectrum(harmonics);
    double left = energyBetween(latlong, halved, scale, threads);
    for (double s : power)
        left -= s;
    left = std::max(0.0, left);
    for (std::size_t i = 0; i < requests.size(); ++i) {
        const std::vector<double>&all = shown[i].all, &read = shown[i].read;
        if (read.empty()) continue;
        double norm = 0, sum = 0, at_point = 0;
        for (int l = 0; l <= std::min(degree, shown[i].whole); ++l)
            norm += all[l] * all[l] * probe[l];
        const int last = std::min(degree, static_cast<int>(read.size()) - 1);
        for (int l = 0; l <= last; ++l) {
            const double square = read[l] * read[l] * power[l];
            sum += square;
            at_point += std::sqrt((2 * l + 1) / (4 * kPi) * square);
        }
        if (norm <= 0) continue;
        const double beyond = shown[i].ends ? 0 : read[last];
        const double between = std::sqrt((sum + beyond * beyond * left) / norm);
        const double fall = shown[i].ends ? kLeastFallOfTails : kLeastFall;
        errors[i].bound = between / fall;
        errors[i].worst = at_point / std::sqrt(probe[0] / (36 * kPi) + 1e-300) / fall;
        errors[i].estimate = between / kFall;
    }
    return errors;
}

} // namespace ibl
