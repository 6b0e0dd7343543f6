// What readers of mesh files share. Internal to the render layer.
#pragma once

#include "render/mesh.h"

#include <span>
#include <string>

namespace ibl {

/// Cuts a polygon into triangles: a fan where it is convex, otherwise ears (Meisters 1975), so many
/// corners squared. Throws Error (input), naming `file`, for a polygon that is not convex and of
/// more than 10000 corners.
void addPolygon(const std::string& file, std::span<const V3f> positions,
                std::span<const std::uint32_t> corners, std::vector<std::uint32_t>& indices);

/// Drops triangles without area, and makes normals: unit ones where they are given, and the mean of
/// the faces about a vertex where there are none or they are 0. Vertices with the same number in
/// `places`, if it is given, are one vertex in that, whatever else tells them apart. Where all
/// three normals of a triangle are given and it is wound against them, it is turned over. Throws
/// Error (input), naming `file`, for coordinates that are not finite and indices of no vertex, and
/// when no triangle is left.
void finishMesh(const std::string& file, Mesh& mesh, std::vector<Part>& parts,
                std::span<const std::uint32_t> places = {});

} // namespace ibl
