#include "render/placement.h"

#include "core/error.h"

#include <cmath>

namespace ibl {

Similarity similarityOf(const Placement& placement, const Extent& extent) {
    const V3d& shift = placement.translate;
    const Turn& turn = placement.turn;
    const double sum = shift.x + shift.y + shift.z + turn.yaw + turn.pitch + turn.roll;
    if (!std::isfinite(sum) || !std::isfinite(placement.scale) || !(placement.scale > 0)) {
        throw Error(ExitCode::usage, "render: the object's scale is not above 0, or its place not "
                                     "finite; give finite numbers");
    }
    Similarity result{turnMatrix(turn), placement.scale, shift};
    if (placement.fit) {
        result.scale /= extent.radius;
        result.shift -= extent.centre * result.turn * result.scale;
    }
    return result;
}

M44d matrixOf(const Similarity& s) {
    M44d m;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j)
            m[i][j] = s.turn[i][j] * s.scale;
        m[3][i] = s.shift[i];
    }
    return m;
}

} // namespace ibl
