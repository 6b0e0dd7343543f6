// Turns of probes, cameras and objects.
#pragma once

#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

namespace ibl {

using Imath::M33d;

/// d' = Ry(yaw) Rx(pitch) Rz(roll) d, right-handed about the axes, in degrees: yaw 90 takes +Z to
/// +X. `mirror` negates x ahead of all.
struct Turn {
    double yaw = 0;
    double pitch = 0;
    double roll = 0;
    bool mirror = false;

    bool operator==(const Turn&) const = default;
};

/// The turn as a matrix for row vectors, as Imath has them: d' = d * turnMatrix(turn). Exact for
/// multiples of 90 degrees. Orthogonal: the transpose is the way back.
M33d turnMatrix(const Turn& turn);

} // namespace ibl
