#include "panorama/turn.h"

#include <cmath>
#include <numbers>

namespace ibl {
namespace {

/// Cosine and sine of an angle in degrees; of quarter turns without the rounding of pi.
struct Angle {
    double cosine, sine;

    explicit Angle(double degrees) {
        const double quarter = std::remainder(degrees, 360) / 90; // -2 to 2
        if (quarter == std::floor(quarter)) {
            cosine = quarter == 0 ? 1 : std::abs(quarter) == 2 ? -1 : 0;
            sine = std::abs(quarter) == 1 ? quarter : 0;
            return;
        }
        const double radians = quarter * std::numbers::pi / 2;
        cosine = std::cos(radians);
        sine = std::sin(radians);
    }
};

} // namespace

M33d turnMatrix(const Turn& turn) {
    const Angle y(turn.yaw), x(turn.pitch), z(turn.roll);
    // Row i is what becomes of axis i.
    const M33d about_y(y.cosine, 0, -y.sine, 0, 1, 0, y.sine, 0, y.cosine);
    const M33d about_x(1, 0, 0, 0, x.cosine, x.sine, 0, -x.sine, x.cosine);
    const M33d about_z(z.cosine, z.sine, 0, -z.sine, z.cosine, 0, 0, 0, 1);
    M33d matrix = about_z * about_x * about_y;
    if (turn.mirror) {
        for (int i = 0; i < 3; ++i)
            matrix[0][i] = -matrix[0][i];
    }
    return matrix;
}

} // namespace ibl
