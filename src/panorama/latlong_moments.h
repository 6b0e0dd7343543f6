// A probe of another layout as a lat-long to convolve.
//
// Means over pixels alone move light: where the edge of a probe's pixel crosses one of the
// lat-long's, what is bright spreads to the pixel's other side, and to lobes all edges together are
// a blur, whose error falls with the square of the pixels' width alone. So the first moment of each
// pixel is measured as well, about its middle in the equal-area chart (phi, z), and light is moved
// between its neighbours until that moment is kept: it falls with the third power, without bias.
#pragma once

#include "panorama/conventions.h"
#include "panorama/panorama.h"

#include <vector>

namespace ibl {

/// The probe, of any layout, as a lat-long of `rows` >= 1 and twice as many columns, whose pixels
/// keep its energy and first moments. Beside bright pixels some are below zero, by up to a quarter
/// of them. `threads` 0: the machine's; the result does not depend on it.
Panorama latlongOfMoments(const Panorama& probe, int rows, int threads);

/// The same of a lat-long of half as many rows and columns (rounded up).
Image halveKeepingMoments(const Image& latlong, int threads);

/// What a pixel is made of. Moments are areas times the way to them from the pixel's middle, to the
/// right in columns, and down in parts of the row's height in z.
struct MomentSum {
    V3d radiance{0, 0, 0}; ///< times area
    double area = 0;
    V3d right{0, 0, 0}, down{0, 0, 0};
    double area_right = 0, area_down = 0;

    void add(const V3d& pixel, double part, double part_right, double part_down) {
        radiance += pixel * part;
        area += part;
        right += pixel * part_right;
        down += pixel * part_down;
        area_right += part_right;
        area_down += part_down;
    }
    void add(const float* pixel, double part, double part_right, double part_down) {
        add(V3d(pixel[0], pixel[1], pixel[2]), part, part_right, part_down);
    }
};

/// Writes row y: means, with the moments to the right kept along the row, and the moments down to
/// `down`.
void storeRow(const std::vector<MomentSum>& sums, int y, Image& result, Image& down);

} // namespace ibl
