// Layouts: names, sizes, which pixel looks where, and how much of the sphere it covers.
#pragma once

#include "panorama/conventions.h"
#include "panorama/panorama.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ibl {

using Imath::V2i;

/// The name of a layout as users write it: latlong faces vcross hcross strip vstrip angular
/// mirrorball octahedral exr-latlong exr-cube.
std::string_view layoutName(Layout layout);

/// The layout of that name, if there is one.
std::optional<Layout> layoutFromName(std::string_view name);

/// All layout names in order, for help texts and messages.
std::vector<std::string> layoutNames();

/// Whether the layout holds the six OpenGL faces, texel for texel (faces, crosses, strips): between
/// two of these with the same face edge nothing but the place of a texel differs.
bool isCubeFamily(Layout layout);

/// Extent in pixels of a layout of face edge, lat-long height or edge of a square map `size` >= 1.
/// Lat-longs are 2 size wide.
V2i layoutExtent(Layout layout, int size);

/// Face edge, lat-long height or edge of a square map, of an image of that extent, or nothing when
/// the layout cannot have it.
std::optional<int> layoutSize(Layout layout, int width, int height);

/// Whether an image of that extent has a lat-long's shape: |W - 2H| <= 2 and W > H.
bool isLatlongShape(int width, int height);

/// The layout of an image of which nothing but shape and metadata is known. The square maps
/// are never told by their shape. `envmap` is the value
/// of OpenEXR's attribute (latlong or cube), or empty. Otherwise a lat-long's shape tells one, and
/// shapes 3:4, 4:3, 6:1 and 1:6 with whole faces are vcross, hcross, strip and vstrip
/// (whoever has the pixels should also see that a cross's cells outside its faces are blank:
/// `crossCellsBlank`).
/// Throws Error (input) naming `subject` when the shape tells nothing, or contradicts `envmap`.
Layout detectLayout(std::string_view subject, int width, int height, std::string_view envmap);

/// Throws Error (input) naming `subject` when an image of that extent cannot have the layout.
void requireLayoutExtent(std::string_view subject, Layout layout, int width, int height);

/// Whether the cells of a cross outside its faces all hold one value. True for other layouts.
bool crossCellsBlank(const Panorama& panorama);

/// Unit direction of a point of the image in continuous pixel coordinates (a pixel's centre is at
/// +0.5; x to the right, y down), or nothing where a cross has no face and
/// outside the disc of a ball map.
std::optional<V3d> texelDirection(Layout layout, int width, int height, double x, double y);

/// The inverse: the point of the image where a direction (any length but 0) is found.
V2d texelPoint(Layout layout, int width, int height, const V3d& direction);

/// Solid angle of pixel (x, y), steradians; 0 where a cross has no face and where a ball
/// map's texel has its centre outside the disc. They sum to 4 pi. A pixel
/// of the exr layouts covers what is nearest to its centre in longitude and latitude or on its
/// face.
double texelSolidAngle(Layout layout, int width, int height, int x, int y);

/// Solid angle per area of the image at a unit direction, up to a factor of the layout.
double solidAngleDensity(Layout layout, const V3d& direction);

/// Where a face lies in the image of a cube-family layout: texel (i, j) of face `face` (in OpenGL's
/// orientation) is pixel (origin + i * step_i + j * step_j).
struct FacePlacement {
    V2i origin;
    V2i step_i;
    V2i step_j;

    V2i pixel(int i, int j) const { return origin + step_i * i + step_j * j; }
};
FacePlacement facePlacement(Layout layout, int edge, int face);

} // namespace ibl
