// Wavefront OBJ through tinyobjloader.
#include "render/object_readers.h"

#include "core/error.h"
#include "image/read.h"
#include "render/mesh_finish.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string_view>
#include <utility>

namespace ibl {
namespace {

namespace fs = std::filesystem;

struct Parsed {
    tinyobj::attrib_t attributes;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
};

// Material files from the folder of the OBJ, noting which were read.
class MaterialFiles : public tinyobj::MaterialReader {
public:
    MaterialFiles(fs::path folder, ObjectFile& result)
        : folder_(std::move(folder)), result_(result) {}

    bool operator()(const std::string& name, std::vector<tinyobj::material_t>* materials,
                    std::map<std::string, int>* places, std::string* warning,
                    std::string* error) override {
        const fs::path path = folder_ / name;
        std::ifstream file(path);
        if (!file || fs::is_directory(path)) {
            result_.notes.push_back("its materials, " + name +
                                    ", cannot be read; all is of one plain material");
            return true;
        }
        result_.files.push_back(path.string());
        tinyobj::LoadMtl(places, materials, &file, warning, error);
        return true;
    }

private:
    fs::path folder_;
    ObjectFile& result_;
};

void requireIndex(const std::string& path, int index, std::size_t values, std::size_t components,
                  const char* what, bool optional) {
    const bool absent = index < 0 && optional;
    if (absent || (index >= 0 && static_cast<std::size_t>(index) < values / components)) return;
    throw inputError(path, std::string("a face refers to a ") + what +
                               " that the file does not have; export it again");
}

// How many numbers follow in a line before its end or a comment; none if a word is no number, or
// not a finite one.
std::optional<std::size_t> countNumbers(const char* at, const char* end) {
    const auto isSpace = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    for (std::size_t count = 0;; ++count) {
        at = std::find_if_not(at, end, isSpace);
        if (at == end || *at == '#') return count;
        if (*at == '+') ++at;
        double value = 0;
        const auto [next, problem] = std::from_chars(at, end, value);
        if (problem != std::errc() || !std::isfinite(value)) return std::nullopt;
        if (next != end && !isSpace(*next)) return std::nullopt;
        at = next;
    }
}

// The loader takes words that are no numbers for 0, and leaves what is missing 0.
void requireNumbers(const std::string& path, std::istream& file) {
    std::string line;
    for (std::size_t number = 1; std::getline(file, line); ++number) {
        const std::size_t begin = line.find_first_not_of(" \t");
        if (begin == line.npos || line[begin] != 'v') continue;
        const std::size_t space = line.find_first_of(" \t", begin);
        if (space == line.npos) continue;
        const std::string_view kind = std::string_view(line).substr(begin, space - begin);
        if (kind != "v" && kind != "vn" && kind != "vt") continue;
        const auto count = countNumbers(line.data() + space, line.data() + line.size());
        if (!count || *count < (kind == "vt" ? 1 : 3)) {
            throw inputError(
                path, "line " + std::to_string(number) + ": " + std::string(kind) +
                          (count ? " has too few numbers" : " has a word that is no number") +
                          "; export it again");
        }
    }
    file.clear();
    file.seekg(0);
}

Parsed parse(const std::string& path, ObjectFile& result) {
    std::ifstream file(path);
    requireNumbers(path, file);
    Parsed obj;
    std::string warning, error;
    MaterialFiles reader(fs::path(path).parent_path(), result);
    const bool loaded = tinyobj::LoadObj(&obj.attributes, &obj.shapes, &obj.materials, &warning,
                                         &error, &file, &reader, true, false);
    if (!loaded || file.bad()) {
        throw inputError(path,
                         (error.empty() ? "is no OBJ file" : error.substr(0, error.find('\n'))) +
                             "; export it again");
    }
    // The loader checks the corners of polygons, which it cuts, and leaves those of triangles to
    // us.
    if (warning.find("invalid vertex index") != warning.npos)
        requireIndex(path, -1, 0, 3, "vertex", false);
    const tinyobj::attrib_t& a = obj.attributes;
    for (const tinyobj::shape_t& shape : obj.shapes) {
        for (const tinyobj::index_t& corner : shape.mesh.indices) {
            requireIndex(path, corner.vertex_index, a.vertices.size(), 3, "vertex", false);
            requireIndex(path, corner.normal_index, a.normals.size(), 3, "normal", true);
            requireIndex(path, corner.texcoord_index, a.texcoords.size(), 2, "texture coordinate",
                         true);
        }
    }
    return obj;
}

// Corners with the same position, normal and texture coordinate become one vertex. Those of a
// position are a chain.
class Vertices {
public:
    Vertices(const tinyobj::attrib_t& attributes, Mesh& mesh)
        : a_(attributes), mesh_(mesh), newest_(attributes.vertices.size() / 3, kNone) {}

    std::uint32_t of(const tinyobj::index_t& corner) {
        const auto position = static_cast<std::size_t>(corner.vertex_index);
        for (std::uint32_t v = newest_[position]; v != kNone; v = known_[v].older) {
            if (known_[v].normal == corner.normal_index &&
                known_[v].texcoord == corner.texcoord_index)
                return v;
        }
        const auto made = static_cast<std::uint32_t>(mesh_.positions.size());
        known_.push_back({corner.normal_index, corner.texcoord_index, newest_[position]});
        newest_[position] = made;
        mesh_.positions.push_back(triple(a_.vertices, corner.vertex_index));
        mesh_.normals.push_back(corner.normal_index < 0 ? V3f(0)
                                                        : triple(a_.normals, corner.normal_index));
        if (!a_.texcoords.empty()) {
            const auto t = 2 * static_cast<std::size_t>(std::max(corner.texcoord_index, 0));
            // v runs up in OBJ files.
            mesh_.texcoords.emplace_back(a_.texcoords[t], 1 - a_.texcoords[t + 1]);
        }
        return made;
    }

private:
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;
    struct Known {
        int normal, texcoord;
        std::uint32_t older;
    };

    static V3f triple(const std::vector<float>& values, int index) {
        const auto i = 3 * static_cast<std::size_t>(index);
        return {values[i], values[i + 1], values[i + 2]};
    }

    const tinyobj::attrib_t& a_;
    Mesh& mesh_;
    std::vector<std::uint32_t> newest_; ///< by position
    std::vector<Known> known_;          ///< by vertex
};

enum class Reading { color, alpha };
using KnownTextures = std::map<std::pair<std::string, Reading>, std::size_t>;

// Alpha, or of an image without, its first channel.
Image alphaOf(const Image& image) {
    Image alpha(image.width, image.height);
    const auto channels = static_cast<std::size_t>(image.channels);
    const std::size_t from = image.channels == 4 ? 3 : 0;
    for (std::size_t i = 0; i < alpha.pixels.size(); ++i)
        alpha.pixels[i] = image.pixels[i / 3 * channels + from];
    return alpha;
}

std::optional<std::size_t> addTexture(const std::string& path, const std::string& name,
                                      Reading reading, int threads, ObjectFile& result,
                                      KnownTextures& known) {
    if (name.empty()) return std::nullopt;
    std::string portable = name;
    std::ranges::replace(portable, '\\', '/');
    const std::string file = (fs::path(path).parent_path() / portable).string();
    const auto [place, is_new] = known.try_emplace({file, reading}, result.object.textures.size());
    if (is_new) {
        const bool is_alpha = reading == Reading::alpha;
        ReadOptions how;
        how.threads = threads;
        how.finite = true;
        how.keep_alpha = how.undecoded = is_alpha;
        Image image = readImage(file, how).image;
        if (is_alpha) image = alphaOf(image);
        result.object.textures.push_back({std::move(image), Wrap::repeat, Wrap::repeat});
        const bool read_before = std::ranges::count(result.files, file) > 0;
        if (!read_before) result.files.push_back(file);
    }
    return place->second;
}

} // namespace

ObjectFile readObj(const std::string& path, int threads) {
    ObjectFile result;
    result.files.push_back(path);
    const Parsed obj = parse(path, result);
    Mesh mesh;
    Vertices vertices(obj.attributes, mesh);
    std::vector<std::uint32_t> position_of;
    std::vector<std::vector<std::uint32_t>> indices(obj.materials.size() + 1); // none, and each
    for (const tinyobj::shape_t& shape : obj.shapes) {
        for (std::size_t i = 0; i < shape.mesh.indices.size(); ++i) {
            const tinyobj::index_t& corner = shape.mesh.indices[i];
            const int material = shape.mesh.material_ids[i / 3];
            indices[static_cast<std::size_t>(material + 1)].push_back(vertices.of(corner));
            if (position_of.size() < mesh.positions.size())
                position_of.push_back(static_cast<std::uint32_t>(corner.vertex_index));
        }
    }
    KnownTextures textures;
    for (std::size_t id = 0; id < indices.size(); ++id) {
        if (indices[id].empty()) continue;
        Part part{mesh.indices.size(), indices[id].size(), {}};
        mesh.indices.insert(mesh.indices.end(), indices[id].begin(), indices[id].end());
        if (id > 0) {
            const tinyobj::material_t& m = obj.materials[id - 1];
            part.surface.base_color = {m.diffuse[0], m.diffuse[1], m.diffuse[2]};
            part.surface.emissive = {m.emission[0], m.emission[1], m.emission[2]};
            part.surface.base_texture =
                addTexture(path, m.diffuse_texname, Reading::color, threads, result, textures);
            part.surface.alpha = m.dissolve;
            part.surface.alpha_texture =
                addTexture(path, m.alpha_texname, Reading::alpha, threads, result, textures);
            if (m.dissolve < 1 || part.surface.alpha_texture) part.surface.alpha_cutoff = kBlended;
            if (m.dissolve <= 0) // some programs write Tr the other way round
                result.notes.push_back("its material " + m.name +
                                       " is not seen, having d 0 or Tr 1");
        }
        result.object.parts.push_back(std::move(part));
    }
    finishMesh(path, mesh, result.object.parts, position_of);
    result.object.mesh = std::move(mesh);
    return result;
}

} // namespace ibl
