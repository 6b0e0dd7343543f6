#include "render/gltf_materials.h"

#include "core/error.h"
#include "image/read.h"
#include "image/srgb.h"

#include <algorithm>
#include <array>

namespace ibl {
namespace {

constexpr int kClampToEdge = 33071, kMirroredRepeat = 33648;

Wrap wrapOf(const GltfDocument& document, const GltfJson& sampler, const char* key) {
    const double code = gltfNumber(document, sampler, key, 0);
    return code == kClampToEdge      ? Wrap::clamp
           : code == kMirroredRepeat ? Wrap::mirror
                                     : Wrap::repeat;
}

// Colours from sRGB to linear light; alpha stays.
void decode(Image& image, bool bytes) {
    std::array<float, 256> table{};
    for (std::size_t code = 0; code < table.size(); ++code)
        table[code] = srgbToLinear(static_cast<float>(code) / 255);
    for (int y = 0; y < image.height; ++y) {
        float* p = image.row(y);
        for (int x = 0; x < image.width; ++x, p += image.channels) {
            for (int c = 0; c < 3; ++c) {
                p[c] =
                    bytes ? table[static_cast<std::size_t>(p[c] * 255 + 0.5F)] : srgbToLinear(p[c]);
            }
        }
    }
}

} // namespace

GltfMaterials::GltfMaterials(const GltfDocument& document, int threads, ObjectFile& result)
    : document_(document), threads_(threads), result_(result) {}

Image GltfMaterials::image(std::size_t index, bool is_color) {
    const GltfJson& json = gltfArray(document_, document_.json, "images")[index];
    const std::string name = document_.path + ": image " + std::to_string(index);
    ReadOptions how;
    how.keep_alpha = true;
    how.undecoded = true;
    how.threads = threads_;
    const std::string uri = gltfString(document_, json, "uri");
    const std::size_t views = gltfArray(document_, document_.json, "bufferViews").size();
    ImageFile file;
    if (const auto view = gltfIndex(document_, json, "bufferView", views)) {
        const auto bytes = gltfView(document_, *view);
        file = readImage(std::vector<std::uint8_t>(bytes.begin(), bytes.end()), name, how);
    } else if (auto embedded = gltfDataUri(document_, uri)) {
        file = readImage(std::move(*embedded), name, how);
    } else if (!uri.empty()) {
        const std::string path = gltfFile(document_, uri);
        file = readImage(path, how);
        result_.files.push_back(path);
    } else {
        throw gltfDamaged(document_, "an image has neither uri nor bufferView");
    }
    const bool bytes = file.pixel_type == "uint8";
    if (is_color && (bytes || file.pixel_type == "uint16")) decode(file.image, bytes);
    return std::move(file.image);
}

std::optional<std::size_t> GltfMaterials::texture(const GltfJson& of, const char* key,
                                                  bool is_color) {
    if (!of.contains(key)) return std::nullopt;
    const GltfJson& info = gltfObject(document_, of, key);
    const GltfJson& textures = gltfArray(document_, document_.json, "textures");
    const auto index = gltfIndex(document_, info, "index", textures.size());
    if (!index) throw gltfDamaged(document_, std::string(key) + " has no index");
    if (gltfNumber(document_, info, "texCoord", 0) != 0) {
        throw inputError(document_.path, std::string(key) +
                                             " uses another set of texture coordinates than the "
                                             "first, which alone is read; export it with one set");
    }
    const auto [place, is_new] =
        textures_.try_emplace({*index, is_color}, result_.object.textures.size());
    if (is_new) {
        const GltfJson& json = textures[*index];
        const std::size_t images = gltfArray(document_, document_.json, "images").size();
        const auto source = gltfIndex(document_, json, "source", images);
        if (!source) throw gltfDamaged(document_, "a texture has no source");
        const GltfJson& samplers = gltfArray(document_, document_.json, "samplers");
        const auto sampler = gltfIndex(document_, json, "sampler", samplers.size());
        const GltfJson& how = sampler ? samplers[*sampler] : GltfJson::object();
        result_.object.textures.push_back({image(*source, is_color),
                                           wrapOf(document_, how, "wrapS"),
                                           wrapOf(document_, how, "wrapT")});
    }
    return place->second;
}

Surface GltfMaterials::read(const GltfJson& material) {
    Surface surface;
    const GltfJson& pbr = gltfObject(document_, material, "pbrMetallicRoughness");
    if (const auto c = gltfNumbers(document_, pbr, "baseColorFactor", 4); !c.empty()) {
        surface.base_color = {c[0], c[1], c[2]};
        surface.alpha = c[3];
    }
    surface.metallic = gltfNumber(document_, pbr, "metallicFactor", 1);
    surface.roughness = gltfNumber(document_, pbr, "roughnessFactor", 1);
    surface.base_texture = texture(pbr, "baseColorTexture", true);
    surface.metallic_roughness_texture = texture(pbr, "metallicRoughnessTexture", false);
    surface.normal_texture = texture(material, "normalTexture", false);
    surface.normal_scale =
        gltfNumber(document_, gltfObject(document_, material, "normalTexture"), "scale", 1);
    if (const auto e = gltfNumbers(document_, material, "emissiveFactor", 3); !e.empty()) {
        surface.emissive = {e[0], e[1], e[2]};
        surface.emissive_texture = texture(material, "emissiveTexture", true);
    }
    const std::string mode = gltfString(document_, material, "alphaMode");
    if (mode == "MASK") surface.alpha_cutoff = gltfNumber(document_, material, "alphaCutoff", 0.5);
    if (mode == "BLEND") surface.alpha_cutoff = kBlended;
    return surface;
}

Surface GltfMaterials::surface(const std::optional<std::size_t>& material) {
    if (!material) return read(GltfJson::object());
    const auto known = surfaces_.find(*material);
    if (known != surfaces_.end()) return known->second;
    const GltfJson& json = gltfArray(document_, document_.json, "materials")[*material];
    return surfaces_[*material] = read(json);
}

} // namespace ibl
