#include "panorama/layouts.h"

#include "panorama/square_maps.h"

#include "core/error.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace ibl {
namespace {

struct NamedLayout {
    Layout layout;
    std::string_view name;
};

constexpr std::array<NamedLayout, 11> kNames{{
    {Layout::latlong, "latlong"},
    {Layout::faces, "faces"},
    {Layout::vcross, "vcross"},
    {Layout::hcross, "hcross"},
    {Layout::strip, "strip"},
    {Layout::vstrip, "vstrip"},
    {Layout::angular, "angular"},
    {Layout::mirrorBall, "mirrorball"},
    {Layout::octahedral, "octahedral"},
    {Layout::exrLatlong, "exr-latlong"},
    {Layout::exrCube, "exr-cube"},
}};

/// Extent of a cube layout in faces; {0, 0} for others.
V2i extentInFaces(Layout layout) {
    switch (layout) {
    case Layout::vcross:
        return {3, 4};
    case Layout::hcross:
        return {4, 3};
    case Layout::strip:
        return {6, 1};
    case Layout::faces:
    case Layout::vstrip:
    case Layout::exrCube:
        return {1, 6};
    default:
        return {0, 0};
    }
}

/// Cell of a face in a cross, in faces.
V2i crossCell(Layout layout, int face) {
    constexpr std::array<std::array<int, 2>, 6> kCells{
        {{0, 1}, {2, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}};
    if (layout == Layout::vcross && face == 5) return {1, 3};
    return {kCells[face][0], kCells[face][1]};
}

/// Top left pixel of a face's cell.
V2i faceCorner(Layout layout, int edge, int face) {
    if (layout == Layout::strip) return {face * edge, 0};
    if (layout == Layout::hcross || layout == Layout::vcross) {
        return crossCell(layout, face) * edge;
    }
    return {0, face * edge};
}

/// Whether face `face` stands in the image turned over left to right, or top to bottom.
struct Turned {
    bool left_right;
    bool top_bottom;
};

/// Cells of crosses are seen from inside, OpenGL's faces from outside: with a to the right and b
/// up, front is (-a, b, 1), hence OpenGL's +Z with s = -a; the other cells likewise. The vertical
/// cross's -Z is turned 180 degrees on top of that, which leaves it turned over top to bottom.
/// OpenEXR draws +-X and +-Z left to right and +-Y top to bottom.
Turned turned(Layout layout, int face) {
    switch (layout) {
    case Layout::hcross:
        return {true, false};
    case Layout::vcross:
        return face == 5 ? Turned{false, true} : Turned{true, false};
    case Layout::exrCube:
        return face / 2 == 1 ? Turned{false, true} : Turned{true, false};
    default:
        return {false, false};
    }
}

/// The face whose cell holds that point of the image, or -1.
int faceAt(Layout layout, int edge, double x, double y) {
    const V2i faces = extentInFaces(layout);
    const int column = std::clamp(static_cast<int>(x / edge), 0, faces.x - 1);
    const int row = std::clamp(static_cast<int>(y / edge), 0, faces.y - 1);
    if (layout == Layout::strip) return column;
    if (faces.x == 1) return row;
    for (int face = 0; face < 6; ++face) {
        if (crossCell(layout, face) == V2i(column, row)) return face;
    }
    return -1;
}

/// Centre-at-half pixel coordinate to [-1, 1] over n pixels, and back, by OpenEXR's border rule.
double borderToUnit(double x, int n) {
    return n == 1 ? 2 * x - 1 : std::clamp(2 * (x - 0.5) / (n - 1) - 1, -1.0, 1.0);
}
double unitToBorder(double s, int n) {
    return n == 1 ? 0.5 * (s + 1) : 0.5 * (s + 1) * (n - 1) + 0.5;
}

/// The part of [-1, 1] nearest to pixel x of n by the border rule.
V2d borderInterval(int x, int n) {
    if (n == 1) return {-1, 1};
    return {std::max(-1.0, (2.0 * x - 1) / (n - 1) - 1),
            std::min(1.0, (2.0 * x + 1) / (n - 1) - 1)};
}

std::string extentText(int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

std::string shapeText(Layout layout) {
    switch (layout) {
    case Layout::vcross:
        return "3N x 4N";
    case Layout::hcross:
        return "4N x 3N";
    case Layout::strip:
        return "6N x N";
    case Layout::angular:
    case Layout::mirrorBall:
    case Layout::octahedral:
        return "N x N";
    default:
        return "N x 6N";
    }
}

} // namespace

std::string_view layoutName(Layout layout) {
    return kNames[static_cast<std::size_t>(layout)].name;
}

std::optional<Layout> layoutFromName(std::string_view name) {
    for (const NamedLayout& n : kNames) {
        if (n.name == name) return n.layout;
    }
    return std::nullopt;
}

std::vector<std::string> layoutNames() {
    std::vector<std::string> names;
    for (const NamedLayout& n : kNames)
        names.emplace_back(n.name);
    return names;
}

bool isCubeFamily(Layout layout) {
    return extentInFaces(layout).x > 0 && layout != Layout::exrCube;
}

V2i layoutExtent(Layout layout, int size) {
    if (isSquareMap(layout)) return V2i(size);
    const V2i faces = extentInFaces(layout);
    return faces.x > 0 ? faces * size : V2i(2 * size, size);
}

std::optional<int> layoutSize(Layout layout, int width, int height) {
    if (width < 1 || height < 1) return std::nullopt;
    if (isSquareMap(layout)) return width == height ? std::optional(width) : std::nullopt;
    const V2i faces = extentInFaces(layout);
    if (faces.x == 0) return height;
    const int edge = width / faces.x;
    if (edge < 1 || faces * edge != V2i(width, height)) return std::nullopt;
    return edge;
}

bool isLatlongShape(int width, int height) {
    const long long w = width, h = height;
    return std::abs(w - 2 * h) <= 2 && w > h;
}

Layout detectLayout(std::string_view subject, int width, int height, std::string_view envmap) {
    if (envmap == "latlong") return Layout::exrLatlong;
    if (envmap == "cube") {
        requireLayoutExtent(subject, Layout::exrCube, width, height);
        return Layout::exrCube;
    }
    if (isLatlongShape(width, height)) return Layout::latlong;
    for (Layout layout : {Layout::vcross, Layout::hcross, Layout::strip, Layout::vstrip}) {
        if (layoutSize(layout, width, height)) return layout;
    }
    throw inputError(subject, "no layout has the shape " + extentText(width, height) +
                                  "; a lat-long is twice as wide as high, and square maps are "
                                  "taken when named; name the layout "
                                  "(--from) if it is one");
}

void requireLayoutExtent(std::string_view subject, Layout layout, int width, int height) {
    if (layoutSize(layout, width, height)) return;
    throw inputError(subject, extentText(width, height) + " cannot be " +
                                  std::string(layoutName(layout)) + ", which is " +
                                  shapeText(layout) + "; name another layout");
}

bool crossCellsBlank(const Panorama& panorama) {
    const Image& image = panorama.image;
    if (panorama.layout != Layout::vcross && panorama.layout != Layout::hcross) return true;
    const int edge = image.width / extentInFaces(panorama.layout).x;
    const float* blank = nullptr;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; x += edge) {
            if (faceAt(panorama.layout, edge, x + 0.5, y + 0.5) >= 0) continue;
            for (int i = 0; i < edge; ++i) {
                const float* pixel = image.at(x + i, y);
                if (!blank) blank = pixel;
                if (std::memcmp(pixel, blank, sizeof(float) * image.channels) != 0) return false;
            }
        }
    }
    return true;
}

std::optional<V3d> texelDirection(Layout layout, int width, int height, double x, double y) {
    if (layout == Layout::latlong) return latlongDirection(x / width, y / height);
    if (isSquareMap(layout)) return squareMapDirection(layout, x / width, y / height);
    if (layout == Layout::exrLatlong) {
        return latlongDirection(0.5 + 0.5 * borderToUnit(x, width),
                                0.5 + 0.5 * borderToUnit(y, height));
    }
    const int edge = width / extentInFaces(layout).x;
    const int face = faceAt(layout, edge, x, y);
    if (face < 0) return std::nullopt;
    const V2i corner = faceCorner(layout, edge, face);
    const bool border = layout == Layout::exrCube;
    const double a = x - corner.x, b = y - corner.y;
    const double s = border ? borderToUnit(a, edge) : 2 * a / edge - 1;
    const double t = border ? borderToUnit(b, edge) : 2 * b / edge - 1;
    const Turned turn = turned(layout, face);
    return cubeDirection({face, turn.left_right ? -s : s, turn.top_bottom ? -t : t}).normalized();
}

double solidAngleDensity(Layout layout, const V3d& d) {
    if (layout == Layout::latlong || layout == Layout::exrLatlong) return std::hypot(d.x, d.z);
    if (layout == Layout::mirrorBall) return 1;
    if (layout == Layout::angular) {
        const double across = std::hypot(d.x, d.y);
        const double theta = std::atan2(across, d.z);
        return theta < 1e-12 ? 1 : across / theta;
    }
    if (layout == Layout::octahedral) {
        // 1 / |p|^3 at p = d / |d|_1.
        const double sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
        return sum * sum * sum;
    }
    const double largest = std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)});
    return largest * largest * largest;
}

V2d texelPoint(Layout layout, int width, int height, const V3d& direction) {
    if (layout == Layout::latlong || layout == Layout::exrLatlong) {
        const V2d p = latlongPoint(direction);
        if (layout == Layout::latlong) return {p.x * width, p.y * height};
        return {unitToBorder(2 * p.x - 1, width), unitToBorder(2 * p.y - 1, height)};
    }
    if (isSquareMap(layout)) {
        const V2d p = squareMapPoint(layout, direction);
        return {p.x * width, p.y * height};
    }
    const int edge = width / extentInFaces(layout).x;
    const CubePoint p = cubePoint(direction);
    const Turned turn = turned(layout, p.face);
    const double s = turn.left_right ? -p.s : p.s, t = turn.top_bottom ? -p.t : p.t;
    const V2i corner = faceCorner(layout, edge, p.face);
    if (layout == Layout::exrCube) {
        return {corner.x + unitToBorder(s, edge), corner.y + unitToBorder(t, edge)};
    }
    return {corner.x + 0.5 * (s + 1) * edge, corner.y + 0.5 * (t + 1) * edge};
}

double texelSolidAngle(Layout layout, int width, int height, int x, int y) {
    if (layout == Layout::latlong) return latlongPixelSolidAngle(width, height, y);
    if (isSquareMap(layout)) return squareMapSolidAngle(layout, width, x, y);
    if (layout == Layout::exrLatlong) {
        const V2d u = borderInterval(x, width), v = borderInterval(y, height);
        const double top = 0.5 * kPi * (v.x + 1), bottom = 0.5 * kPi * (v.y + 1);
        return kPi * (u.y - u.x) * 2 * std::sin(0.5 * (top + bottom)) *
               std::sin(0.5 * (bottom - top));
    }
    const int edge = width / extentInFaces(layout).x;
    if (faceAt(layout, edge, x + 0.5, y + 0.5) < 0) return 0;
    if (layout == Layout::exrCube) {
        const V2d s = borderInterval(x, edge), t = borderInterval(y % edge, edge);
        return cubeRectangleSolidAngle(s.x, s.y, t.x, t.y);
    }
    // A texel's solid angle does not change when its face is turned over.
    return cubeTexelSolidAngle(x % edge, y % edge, edge);
}

FacePlacement facePlacement(Layout layout, int edge, int face) {
    const V2i corner = faceCorner(layout, edge, face);
    const Turned turn = turned(layout, face);
    FacePlacement place{corner, V2i(1, 0), V2i(0, 1)};
    if (turn.left_right) {
        place.origin.x += edge - 1;
        place.step_i = V2i(-1, 0);
    }
    if (turn.top_bottom) {
        place.origin.y += edge - 1;
        place.step_j = V2i(0, -1);
    }
    return place;
}

} // namespace ibl
