// A picture of all directions: pixels and the layout that says which pixel looks where.
#pragma once

#include "image/image.h"

#include <optional>
#include <string_view>

namespace ibl {

/// How directions are laid out in an image (panorama/conventions.h gives the formulas).
enum class Layout {
    latlong,    ///< W x H, any; row 0 at +Y, the centre along +Z
    faces,      ///< six N x N faces +X -X +Y -Y +Z -Z as OpenGL samples them; in memory one under
                ///< the other, N x 6N; in files six images _px _nx _py _ny _pz _nz
    vcross,     ///< 3N x 4N
    hcross,     ///< 4N x 3N
    strip,      ///< 6N x N, the faces side by side
    vstrip,     ///< N x 6N, the faces one under the other, in one file
    angular,    ///< N x N; a disc, +Z in the middle, the angle from it grows with the radius
    mirrorBall, ///< N x N; a disc, the photograph of a mirror ball seen along -Z
    octahedral, ///< N x N; +Y in the middle, -Y in the corners
    exrLatlong, ///< OpenEXR's ENVMAP_LATLONG: outer pixel centres on the poles and the seam
    exrCube,    ///< OpenEXR's ENVMAP_CUBE, N x 6N: outer pixel centres on the face edges
};

struct Panorama {
    Layout layout = Layout::latlong;
    Image image; ///< 3 channels, radiance
};

} // namespace ibl
