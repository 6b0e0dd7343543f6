// The readers behind readObject(). Internal to the render layer.
#pragma once

#include "render/object_file.h"

#include <cstdint>
#include <span>

namespace ibl {

/// Wavefront OBJ with the materials' Kd, map_Kd and Ke, a part a material.
ObjectFile readObj(const std::string& path, int threads);

/// PLY 1.0, ascii or binary, from its bytes: x y z, nx ny nz, texture coordinates (u v, s t or
/// texture_u texture_v) of vertices, and vertex_indices (or vertex_index) of faces.
ObjectFile readPly(const std::string& path, std::span<const char> bytes);

/// glTF 2.0, JSON or binary, from its bytes: the triangles of the default scene's nodes, brought
/// into the world, a part a primitive; metallic-roughness materials; cameras.
ObjectFile readGltf(const std::string& path, std::span<const char> bytes, int threads);

} // namespace ibl
