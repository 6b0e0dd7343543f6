#include "convolve/row_geometry.h"

#include "core/simd.h"

#include <cmath>

// glibc has vectors of these (libmvec), off by 4 ulp at most, which its headers offer to fast-math
// alone. An azimuth and a colatitude take 10 ns in place of 88.
#if defined(__GLIBC__) && defined(__x86_64__) && !defined(__clang__)
extern "C" {
__attribute__((simd("notinbranch"))) double atan2(double, double) noexcept;
__attribute__((simd("notinbranch"))) double hypot(double, double) noexcept;
}
#endif

namespace ibl {

IBL_MULTIVERSION
void latlongPoints(const V3d* direction, std::size_t n, double* u, double* v) {
    for (std::size_t i = 0; i < n; ++i) {
        // Y up; at the poles -0 would turn the azimuth.
        const V3d d(direction[i].y, direction[i].z, 0.0 - direction[i].x);
        const V2d point = latlongPoint(d);
        u[i] = point.x;
        v[i] = point.y;
    }
}

IBL_MULTIVERSION
void faceRowSolidAngles(int edge, int j, double* solid_angle) {
    const double step = 2.0 / edge, t0 = j * step - 1, t1 = (j + 1) * step - 1;
    for (int i = 0; i < edge; ++i) // i + 1 would be seen as the next i: no loop for vectors
        solid_angle[i] = cubeRectangleSolidAngle(i * step - 1, (i + 1.0) * step - 1, t0, t1);
}

} // namespace ibl
