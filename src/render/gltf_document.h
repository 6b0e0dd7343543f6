// A glTF 2.0 file's JSON and bytes, read with every reference checked. Internal to the render
// layer.
#pragma once

#include "core/error.h"

#include <Imath/ImathVec.h>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace ibl {

using GltfJson = nlohmann::json;

struct GltfDocument {
    std::string path;
    GltfJson json;
    std::vector<std::vector<std::uint8_t>> buffers;
    std::vector<std::string> files; ///< beside `path`: buffers
};

/// Reads JSON, or a binary container, and all buffers: from data URIs, files beside it and the
/// container. Throws Error (input) for what is damaged, not of version 2, or requires an extension.
GltfDocument openGltf(const std::string& path, std::span<const char> bytes);

/// An error of the document: "PATH: is a damaged glTF file (PROBLEM); export it again".
Error gltfDamaged(const GltfDocument& document, const std::string& problem);

/// `object[key]` as an array; an empty one where there is none.
const GltfJson& gltfArray(const GltfDocument& document, const GltfJson& object, const char* key);
/// `object[key]` as an object; an empty one where there is none.
const GltfJson& gltfObject(const GltfDocument& document, const GltfJson& object, const char* key);
/// `object[key]` as a finite number, or `otherwise`.
double gltfNumber(const GltfDocument& document, const GltfJson& object, const char* key,
                  double otherwise);
/// The same as an array of `count` numbers; empty where there is none.
std::vector<double> gltfNumbers(const GltfDocument& document, const GltfJson& object,
                                const char* key, std::size_t count);
/// The same as a string; "" where there is none.
std::string gltfString(const GltfDocument& document, const GltfJson& object, const char* key);
/// `object[key]` as a place in an array of `count`; nothing where there is none.
std::optional<std::size_t> gltfIndex(const GltfDocument& document, const GltfJson& object,
                                     const char* key, std::size_t count);

/// The bytes of a buffer view.
std::span<const std::uint8_t> gltfView(const GltfDocument& document, std::size_t view);

/// An accessor's numbers, `components` a row, which must be its type's. Integers are brought to
/// [0, 1] or [-1, 1] where the accessor says so.
std::vector<float> gltfFloats(const GltfDocument& document, std::size_t accessor,
                              std::size_t components);
/// A scalar accessor of unsigned integers.
std::vector<std::uint32_t> gltfIndices(const GltfDocument& document, std::size_t accessor);

/// The bytes of a data URI; nothing if it is none.
std::optional<std::vector<std::uint8_t>> gltfDataUri(const GltfDocument& document,
                                                     const std::string& uri);
/// The file that a relative URI means.
std::string gltfFile(const GltfDocument& document, const std::string& uri);

} // namespace ibl
