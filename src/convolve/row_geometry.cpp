#include "convolve/row_geometry.h"

#include "core/simd.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ibl {
namespace {

/// atan2(y, x) in (-pi, pi], to 4e-16; 0 where both are 0. By Cephes's rational approximation of
/// the arc tangent up to tan(pi/8) (Moshier 1995, atan.c). glibc's own vectors of it are as quick,
/// but in a library of their own, which takes 0.35 ms to load.
IBL_INLINE Lanes arcTangent(const Lanes& y, const Lanes& x) {
    constexpr double kTanEighth = 0.41421356237309503;
    const Lanes ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
    const Lanes least = ay > ax ? ax : ay, most = ay > ax ? ay : ax;
    const auto turned = least > kTanEighth * most; // by pi/4, to be small
    const Lanes above = turned ? least - most : least, below = turned ? least + most : most;
    const Lanes t = above / (below > 0 ? below : Lanes{} + 1), z = t * t;
    Lanes p = -8.750608600031904122785e-1 * z - 1.615753718733365076637e1;
    p = p * z - 7.500855792314704667340e1;
    p = p * z - 1.228866684490136173410e2;
    p = p * z - 6.485021904942025371773e1;
    Lanes q = z + 2.485846490142306297962e1;
    q = q * z + 1.650270098316988542046e2;
    q = q * z + 4.328810604912902668951e2;
    q = q * z + 4.853903996359136964868e2;
    q = q * z + 1.945506571482613964425e2;
    Lanes angle = t + t * z * p / q;
    angle = turned ? angle + 0.25 * kPi : angle;
    angle = ay > ax ? 0.5 * kPi - angle : angle;
    angle = x < 0 ? kPi - angle : angle;
    return y < 0 ? -angle : angle;
}

/// Numbers, so many at once that vectors of them pay.
constexpr std::size_t kAtOnce = 64 * kLanes;
using Some = std::array<double, kAtOnce>;

/// Of the first `n` of each, and of what follows them in their vector.
IBL_INLINE void arcTangents(const Some& y, const Some& x, std::size_t n, Some& angle) {
    for (std::size_t i = 0; i < n; i += kLanes) {
        Lanes a, b;
        __builtin_memcpy(&a, &y[i], sizeof a);
        __builtin_memcpy(&b, &x[i], sizeof b);
        a = arcTangent(a, b);
        __builtin_memcpy(&angle[i], &a, sizeof a);
    }
}

} // namespace

IBL_MULTIVERSION
void latlongPoints(const V3d* direction, std::size_t n, double* u, double* v) {
    Some up{}, across{}, front{}, right{}, azimuth, colatitude;
    for (std::size_t begin = 0; begin < n; begin += kAtOnce) {
        const std::size_t count = std::min(kAtOnce, n - begin);
        for (std::size_t i = 0; i < count; ++i) { // Y up
            const V3d& d = direction[begin + i];
            right[i] = d.y;
            up[i] = d.z;
            front[i] = -d.x;
            across[i] = std::sqrt(d.x * d.x + d.y * d.y);
        }
        arcTangents(right, front, count, azimuth);
        arcTangents(across, up, count, colatitude);
        for (std::size_t i = 0; i < count; ++i) {
            u[begin + i] = 0.5 - azimuth[i] / (2 * kPi);
            v[begin + i] = colatitude[i] / kPi;
        }
    }
}

IBL_MULTIVERSION
void faceRowSolidAngles(int edge, int j, double* solid_angle) {
    const double step = 2.0 / edge, t0 = j * step - 1, t1 = (j + 1) * step - 1;
    Some re{}, im{}, angle;
    for (int begin = 0; begin < edge; begin += static_cast<int>(kAtOnce)) {
        const int count = std::min(static_cast<int>(kAtOnce), edge - begin);
        for (int i = 0; i < count; ++i) {
            const double s0 = (begin + i) * step - 1, s1 = (begin + i + 1.0) * step - 1;
            const V2d z = cubeRectangleProduct(s0, s1, t0, t1);
            re[i] = z.x;
            im[i] = z.y;
        }
        arcTangents(im, re, count, angle);
        std::copy_n(angle.begin(), count, solid_angle + begin);
    }
}

} // namespace ibl
