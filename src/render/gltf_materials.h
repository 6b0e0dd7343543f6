// Materials and textures of a glTF document. Internal to the render layer.
#pragma once

#include "render/gltf_document.h"
#include "render/object_file.h"

#include <map>
#include <utility>

namespace ibl {

/// Reads materials when they are first asked for, with the images that they need.
class GltfMaterials {
public:
    /// Textures, names of files and notes go into `result`.
    GltfMaterials(const GltfDocument& document, int threads, ObjectFile& result);

    /// The material of that place, or glTF's default one.
    Surface surface(const std::optional<std::size_t>& material);

private:
    std::optional<std::size_t> texture(const GltfJson& of, const char* key, bool is_color);
    Image image(std::size_t index, bool is_color);
    Surface read(const GltfJson& material);

    const GltfDocument& document_;
    int threads_;
    ObjectFile& result_;
    std::map<std::size_t, Surface> surfaces_;
    std::map<std::pair<std::size_t, bool>, std::size_t> textures_; ///< and whether it is a colour
};

} // namespace ibl
