#include "render/builtin_objects.h"

#include <Imath/ImathBox.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace ibl {
namespace {

using Imath::Box3d;
using Imath::V2d;
using Patch = std::array<std::array<V3d, 4>, 4>;

// Newell's control points, Z up. Rim, lid, body and bottom are turned from a profile of (radius,
// height); a quarter turn's handles are 0.56 of the radius (the lid's upper ones were 0.5625).
// Handle and spout are given by the half at y <= 0, the other half mirrored.
struct ProfilePoint {
    double radius, height;
};
constexpr std::array<std::array<ProfilePoint, 4>, 6> kProfiles{{
    {{{1.4, 2.4}, {1.3375, 2.53125}, {1.4375, 2.53125}, {1.5, 2.4}}}, // rim
    {{{1.5, 2.4}, {1.75, 1.875}, {2, 1.35}, {2, 0.9}}},               // upper body
    {{{2, 0.9}, {2, 0.45}, {1.5, 0.225}, {1.5, 0.15}}},               // lower body
    {{{0, 3.15}, {0.8, 3.15}, {0, 2.85}, {0.2, 2.7}}},                // knob
    {{{0.2, 2.7}, {0.4, 2.55}, {1.3, 2.55}, {1.3, 2.4}}},             // lid
    {{{1.5, 0.15}, {1.5, 0.075}, {1.425, 0}, {0, 0}}},                // bottom
}};
constexpr double kQuarterTurnHandle = 0.56;

const std::array<Patch, 4> kHalves{{
    // Handle, upper and lower.
    {{{{{-1.6, 0, 2.025}, {-1.6, -0.3, 2.025}, {-1.5, -0.3, 2.25}, {-1.5, 0, 2.25}}},
      {{{-2.3, 0, 2.025}, {-2.3, -0.3, 2.025}, {-2.5, -0.3, 2.25}, {-2.5, 0, 2.25}}},
      {{{-2.7, 0, 2.025}, {-2.7, -0.3, 2.025}, {-3, -0.3, 2.25}, {-3, 0, 2.25}}},
      {{{-2.7, 0, 1.8}, {-2.7, -0.3, 1.8}, {-3, -0.3, 1.8}, {-3, 0, 1.8}}}}},
    {{{{{-2.7, 0, 1.8}, {-2.7, -0.3, 1.8}, {-3, -0.3, 1.8}, {-3, 0, 1.8}}},
      {{{-2.7, 0, 1.575}, {-2.7, -0.3, 1.575}, {-3, -0.3, 1.35}, {-3, 0, 1.35}}},
      {{{-2.5, 0, 1.125}, {-2.5, -0.3, 1.125}, {-2.65, -0.3, 0.9375}, {-2.65, 0, 0.9375}}},
      {{{-2, 0, 0.9}, {-2, -0.3, 0.9}, {-1.9, -0.3, 0.6}, {-1.9, 0, 0.6}}}}},
    // Spout and its lip.
    {{{{{1.7, 0, 1.425}, {1.7, -0.66, 1.425}, {1.7, -0.66, 0.6}, {1.7, 0, 0.6}}},
      {{{2.6, 0, 1.425}, {2.6, -0.66, 1.425}, {3.1, -0.66, 0.825}, {3.1, 0, 0.825}}},
      {{{2.3, 0, 2.1}, {2.3, -0.25, 2.1}, {2.4, -0.25, 2.025}, {2.4, 0, 2.025}}},
      {{{2.7, 0, 2.4}, {2.7, -0.25, 2.4}, {3.3, -0.25, 2.4}, {3.3, 0, 2.4}}}}},
    {{{{{2.7, 0, 2.4}, {2.7, -0.25, 2.4}, {3.3, -0.25, 2.4}, {3.3, 0, 2.4}}},
      {{{2.8, 0, 2.475}, {2.8, -0.25, 2.475}, {3.525, -0.25, 2.49375}, {3.525, 0, 2.49375}}},
      {{{2.9, 0, 2.475}, {2.9, -0.15, 2.475}, {3.45, -0.15, 2.5125}, {3.45, 0, 2.5125}}},
      {{{2.8, 0, 2.4}, {2.8, -0.15, 2.4}, {3.2, -0.15, 2.4}, {3.2, 0, 2.4}}}}},
}};

// Segments of a patch's side: at 1000 pixels a chord's sagitta is below a tenth of a pixel.
constexpr std::uint32_t kSegments = 24;

Patch turnedPatch(const std::array<ProfilePoint, 4>& profile, int quarter) {
    // Clockwise seen from above, as the halves go round their tubes: outside is on one side for
    // all.
    constexpr double k = kQuarterTurnHandle;
    const std::array<V2d, 4> arc{V2d(1, 0), V2d(1, -k), V2d(k, -1), V2d(0, -1)};
    Patch patch;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            V2d p = arc[j] * profile[i].radius;
            for (int q = 0; q < quarter; ++q)
                p = {p.y, -p.x};
            patch[i][j] = {p.x, p.y, profile[i].height};
        }
    }
    return patch;
}

Patch mirrored(const Patch& patch) {
    // The columns turn round as well, so that the patch keeps its outer side.
    Patch result;
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            const V3d& p = patch[i][3 - j];
            result[i][j] = {p.x, -p.y, p.z};
        }
    }
    return result;
}

struct SurfacePoint {
    V3d position, along_i, along_j;
};

SurfacePoint evaluate(const Patch& patch, double s, double t) {
    const auto weights = [](double x) {
        const double y = 1 - x;
        return std::array<double, 4>{y * y * y, 3 * x * y * y, 3 * x * x * y, x * x * x};
    };
    const auto slopes = [](double x) {
        const double y = 1 - x;
        return std::array<double, 4>{-3 * y * y, 3 * y * y - 6 * x * y, 6 * x * y - 3 * x * x,
                                     3 * x * x};
    };
    const auto ws = weights(s), wt = weights(t), ds = slopes(s), dt = slopes(t);
    SurfacePoint point{V3d(0), V3d(0), V3d(0)};
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            point.position += patch[i][j] * (ws[i] * wt[j]);
            point.along_i += patch[i][j] * (ds[i] * wt[j]);
            point.along_j += patch[i][j] * (ws[i] * dt[j]);
        }
    }
    return point;
}

// Where a row of control points has run together into one (the tips of knob and bottom), the patch
// has no tangent along it; both tips lie on the axis, whose direction is the normal there.
V3d normalAt(const Patch& patch, double s, double t) {
    const SurfacePoint point = evaluate(patch, s, t);
    const V3d normal = point.along_j.cross(point.along_i);
    if (normal.length() > 1e-9) return normal.normalized();
    const SurfacePoint beside = evaluate(patch, s < 0.5 ? s + 1e-3 : s - 1e-3, t);
    return {0, 0, beside.along_j.cross(beside.along_i).z > 0 ? 1.0 : -1.0};
}

// Where the patch's rows lead in its picture: from its upper edge to the lower, or back up.
enum class Rows { fall, rise };

void addPatch(Mesh& mesh, const Patch& patch, Rows rows) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    constexpr std::uint32_t side = kSegments + 1;
    for (std::uint32_t i = 0; i < side; ++i) {
        for (std::uint32_t j = 0; j < side; ++j) {
            const double s = double(i) / kSegments, t = double(j) / kSegments;
            const V3d p = evaluate(patch, s, t).position, n = normalAt(patch, s, t);
            mesh.positions.emplace_back(V3d(p.x, p.z, -p.y)); // Z up to Y up
            mesh.normals.emplace_back(V3d(n.x, n.z, -n.y));
            // Outside is along_j x along_i, and right x up of a picture.
            mesh.texcoords.emplace_back(rows == Rows::fall ? V2d(1 - t, s) : V2d(t, 1 - s));
        }
    }
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const auto& p = mesh.positions;
        if (p[a] == p[b] || p[b] == p[c] || p[c] == p[a]) return; // at the tips
        mesh.indices.insert(mesh.indices.end(), {a, b, c});
    };
    for (std::uint32_t i = 0; i < kSegments; ++i) {
        for (std::uint32_t j = 0; j < kSegments; ++j) {
            const std::uint32_t a = first + i * side + j, b = a + 1, c = b + side, d = a + side;
            add(a, b, c);
            add(a, c, d);
        }
    }
}

void fitUnitSphere(Mesh& mesh) {
    Box3d box;
    for (const V3f& p : mesh.positions)
        box.extendBy(V3d(p));
    double radius = 0;
    for (const V3f& p : mesh.positions)
        radius = std::max(radius, (V3d(p) - box.center()).length());
    for (V3f& p : mesh.positions)
        p = V3f((V3d(p) - box.center()) / radius);
}

} // namespace

Mesh makeTeapot() {
    Mesh mesh;
    for (const auto& profile : kProfiles) {
        for (int quarter = 0; quarter < 4; ++quarter)
            addPatch(mesh, turnedPatch(profile, quarter), Rows::fall);
    }
    for (std::size_t i = 0; i < kHalves.size(); ++i) {
        const Rows rows = i < 2 ? Rows::fall : Rows::rise; // the handle's, the spout's
        addPatch(mesh, kHalves[i], rows);
        addPatch(mesh, mirrored(kHalves[i]), rows);
    }
    fitUnitSphere(mesh);
    return mesh;
}

} // namespace ibl
