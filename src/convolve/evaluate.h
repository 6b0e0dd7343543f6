// Fields at points, without a grid: for maps of so few texels that a grid would be a waste.
#pragma once

#include "convolve/legendre.h"
#include "convolve/texels.h"
#include "image/image.h"

#include <cstddef>
#include <vector>

namespace ibl {

/// The field of synthesis.h at n lat-long points without a grid: a Legendre sum at each different
/// |cos theta|, a Fourier sum at each point. Exact but for rounding. out[3 i + channel].
void evaluateField(const Harmonics& harmonics, const std::vector<double>& scale, int degree,
                   const double* u, const double* v, std::size_t n, int threads, double* out);

/// Whether evaluateField takes less time than synthesise and sampleField, for the points of maps,
/// which share many an |cos theta|.
bool evaluationIsCheaper(int degree, std::size_t points);

/// Points of a map, about: its texels' places times those of a footprint, of ball maps at the rim.
std::size_t mapPoints(Layout layout, const Image& map, const Footprint& footprint);

/// A field at all points of a map.
struct MapValues {
    std::vector<RowPoints> rows;
    std::vector<std::size_t> first; ///< point of each row
    std::vector<double> values;     ///< [point][channel]
};

MapValues evaluateMap(const Harmonics& harmonics, const std::vector<double>& scale, int degree,
                      Layout layout, int width, int height, const Footprint& footprint,
                      int threads);

} // namespace ibl
