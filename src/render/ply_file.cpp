// The Stanford PLY format 1.0.
#include "render/object_readers.h"

#include "core/error.h"
#include "render/mesh_finish.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <optional>
#include <string_view>

namespace ibl {
namespace {

enum class Scalar { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct ScalarName {
    std::string_view name, other_name;
    Scalar scalar;
    std::size_t bytes;
};
constexpr std::array<ScalarName, 8> kScalars{{
    {"char", "int8", Scalar::int8, 1},
    {"uchar", "uint8", Scalar::uint8, 1},
    {"short", "int16", Scalar::int16, 2},
    {"ushort", "uint16", Scalar::uint16, 2},
    {"int", "int32", Scalar::int32, 4},
    {"uint", "uint32", Scalar::uint32, 4},
    {"float", "float32", Scalar::float32, 4},
    {"double", "float64", Scalar::float64, 8},
}};

struct Property {
    std::string_view name;
    Scalar type;
    std::optional<Scalar> list_count; ///< of lists: the type of their length
};

struct Element {
    std::string_view name;
    std::size_t count = 0;
    std::vector<Property> properties;
};

enum class Encoding { ascii, little, big };

struct Header {
    Encoding encoding = Encoding::ascii;
    std::vector<Element> elements;
};

std::size_t bytesOf(Scalar scalar) {
    return std::ranges::find(kScalars, scalar, &ScalarName::scalar)->bytes;
}

// A file's bytes, and how far it is read.
struct Reader {
    const std::string& path;
    const char* at;
    const char* end;
    Encoding encoding = Encoding::ascii;

    std::size_t left() const { return static_cast<std::size_t>(end - at); }
    Error damaged(const std::string& problem) const {
        return inputError(path, "is a damaged PLY file (" + problem + "); export it again");
    }

    std::string_view line() {
        const char* stop = std::find(at, end, '\n');
        if (stop == end) throw damaged("it ends in its header");
        std::string_view text(at, static_cast<std::size_t>(stop - at));
        at = stop + 1;
        if (text.ends_with('\r')) text.remove_suffix(1);
        return text;
    }

    double text() {
        while (at < end && static_cast<unsigned char>(*at) <= ' ')
            ++at;
        if (at < end && *at == '+') ++at;
        double value = 0;
        const auto [next, problem] = std::from_chars(at, end, value);
        if (at == end) throw damaged("it ends too early");
        if (problem != std::errc()) throw damaged("what should be a number is none");
        at = next;
        return value;
    }

    template <class T>
    double binary() {
        std::array<char, sizeof(T)> raw;
        std::memcpy(raw.data(), at, sizeof(T));
        at += sizeof(T);
        const bool is_big = encoding == Encoding::big;
        if (is_big != (std::endian::native == std::endian::big)) std::ranges::reverse(raw);
        return static_cast<double>(std::bit_cast<T>(raw));
    }

    double value(Scalar scalar) {
        if (encoding == Encoding::ascii) return text();
        if (left() < bytesOf(scalar)) throw damaged("it ends too early");
        switch (scalar) {
        case Scalar::int8:
            return binary<std::int8_t>();
        case Scalar::uint8:
            return binary<std::uint8_t>();
        case Scalar::int16:
            return binary<std::int16_t>();
        case Scalar::uint16:
            return binary<std::uint16_t>();
        case Scalar::int32:
            return binary<std::int32_t>();
        case Scalar::uint32:
            return binary<std::uint32_t>();
        case Scalar::float32:
            return binary<float>();
        default:
            return binary<double>();
        }
    }

    std::size_t listLength(Scalar scalar) {
        const double length = value(scalar);
        // Every entry takes a byte at least.
        if (!(length >= 0) || length > static_cast<double>(left()) ||
            length != static_cast<double>(static_cast<std::size_t>(length))) {
            throw damaged("a list's length cannot be");
        }
        return static_cast<std::size_t>(length);
    }
};

std::vector<std::string_view> words(std::string_view line) {
    std::vector<std::string_view> result;
    while (!line.empty()) {
        const std::size_t begin = line.find_first_not_of(" \t");
        if (begin == line.npos) break;
        const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
        result.push_back(line.substr(begin, end - begin));
        line.remove_prefix(end);
    }
    return result;
}

Scalar scalarNamed(const Reader& reader, std::string_view name) {
    for (const ScalarName& row : kScalars) {
        if (name == row.name || name == row.other_name) return row.scalar;
    }
    throw reader.damaged("there is no type " + std::string(name));
}

Encoding encodingNamed(const Reader& reader, const std::vector<std::string_view>& w) {
    if (w.size() == 3 && w[2] == "1.0") {
        if (w[1] == "ascii") return Encoding::ascii;
        if (w[1] == "binary_little_endian") return Encoding::little;
        if (w[1] == "binary_big_endian") return Encoding::big;
    }
    throw reader.damaged("its format is not ascii, binary_little_endian or binary_big_endian 1.0");
}

// An entry of the file takes so many bytes at least.
std::size_t leastBytes(const Element& element, Encoding encoding) {
    std::size_t bytes = 0;
    for (const Property& p : element.properties) {
        bytes += encoding == Encoding::ascii ? 2 : bytesOf(p.list_count.value_or(p.type));
    }
    return bytes;
}

Header readHeader(Reader& reader) {
    Header header;
    bool has_format = false;
    reader.line(); // "ply"
    for (;;) {
        const std::vector<std::string_view> w = words(reader.line());
        if (w.empty() || w[0] == "comment" || w[0] == "obj_info") continue;
        if (w[0] == "end_header") break;
        if (w[0] == "format") {
            header.encoding = encodingNamed(reader, w);
            has_format = true;
        } else if (w[0] == "element" && w.size() == 3) {
            Element element{w[1], 0, {}};
            const char* stop = w[2].data() + w[2].size();
            const auto [last, problem] = std::from_chars(w[2].data(), stop, element.count);
            if (problem != std::errc() || last != stop) throw reader.damaged("a count is none");
            header.elements.push_back(std::move(element));
        } else if (w[0] == "property" && w.size() == 3 && !header.elements.empty()) {
            header.elements.back().properties.push_back(
                {w[2], scalarNamed(reader, w[1]), std::nullopt});
        } else if (w[0] == "property" && w.size() == 5 && w[1] == "list" &&
                   !header.elements.empty()) {
            header.elements.back().properties.push_back(
                {w[4], scalarNamed(reader, w[3]), scalarNamed(reader, w[2])});
        } else {
            throw reader.damaged("a line of its header cannot be understood");
        }
    }
    if (!has_format) throw reader.damaged("its header says no format");
    // Before anything is allocated. ASCII files may lack the last line's end.
    for (const Element& element : header.elements) {
        const std::size_t bytes = leastBytes(element, header.encoding);
        if (bytes > 0 && element.count > (reader.left() + 1) / bytes) {
            throw reader.damaged("it is too short for its " + std::string(element.name) +
                                 " elements");
        }
    }
    return header;
}

// Which number of a vertex a property is: 0 to 2 position, 3 to 5 normal, 6 and 7 texture
// coordinate.
std::optional<std::size_t> vertexSlot(std::string_view name) {
    constexpr std::array<std::pair<std::string_view, std::size_t>, 12> kSlots{{{"x", 0},
                                                                               {"y", 1},
                                                                               {"z", 2},
                                                                               {"nx", 3},
                                                                               {"ny", 4},
                                                                               {"nz", 5},
                                                                               {"u", 6},
                                                                               {"v", 7},
                                                                               {"s", 6},
                                                                               {"t", 7},
                                                                               {"texture_u", 6},
                                                                               {"texture_v", 7}}};
    for (const auto& [known, slot] : kSlots) {
        if (name == known) return slot;
    }
    return std::nullopt;
}

void readVertices(Reader& reader, const Element& element, Mesh& mesh) {
    std::vector<std::size_t> slots; // 8: passed over
    std::array<bool, 9> has{};
    for (const Property& p : element.properties) {
        slots.push_back(p.list_count ? 8 : vertexSlot(p.name).value_or(8));
        has[slots.back()] = true;
    }
    if (!(has[0] && has[1] && has[2])) throw reader.damaged("its vertices have no x, y and z");
    const bool normals = has[3] && has[4] && has[5], texcoords = has[6] && has[7];
    mesh.positions.reserve(element.count);
    if (normals) mesh.normals.reserve(element.count);
    if (texcoords) mesh.texcoords.reserve(element.count);
    std::array<float, 9> v{};
    for (std::size_t i = 0; i < element.count; ++i) {
        for (std::size_t k = 0; k < slots.size(); ++k) {
            const Property& p = element.properties[k];
            const std::size_t length = p.list_count ? reader.listLength(*p.list_count) : 1;
            for (std::size_t j = 0; j < length; ++j)
                v[slots[k]] = static_cast<float>(reader.value(p.type));
        }
        mesh.positions.emplace_back(v[0], v[1], v[2]);
        if (normals) mesh.normals.emplace_back(v[3], v[4], v[5]);
        if (texcoords) mesh.texcoords.emplace_back(v[6], 1 - v[7]); // v runs up in PLY files
    }
}

void readFaces(Reader& reader, const Element& element, Mesh& mesh) {
    mesh.indices.reserve(3 * element.count);
    std::vector<std::uint32_t> corners;
    bool has_corners = false;
    for (std::size_t i = 0; i < element.count; ++i) {
        for (const Property& p : element.properties) {
            const bool is_corners =
                p.list_count && (p.name == "vertex_indices" || p.name == "vertex_index");
            const std::size_t length = p.list_count ? reader.listLength(*p.list_count) : 1;
            if (!is_corners) {
                for (std::size_t j = 0; j < length; ++j)
                    reader.value(p.type);
                continue;
            }
            has_corners = true;
            corners.clear();
            for (std::size_t j = 0; j < length; ++j) {
                const double index = reader.value(p.type);
                if (!(index >= 0 && index < static_cast<double>(mesh.positions.size()))) {
                    throw inputError(reader.path, "a face refers to a vertex that the file does "
                                                  "not have; export it again");
                }
                corners.push_back(static_cast<std::uint32_t>(index));
            }
            addPolygon(reader.path, mesh.positions, corners, mesh.indices);
        }
    }
    if (element.count > 0 && !has_corners) throw reader.damaged("its faces have no vertex_indices");
}

void passOver(Reader& reader, const Element& element) {
    if (element.properties.empty()) return;
    for (std::size_t i = 0; i < element.count; ++i) {
        for (const Property& p : element.properties) {
            const std::size_t length = p.list_count ? reader.listLength(*p.list_count) : 1;
            for (std::size_t j = 0; j < length; ++j)
                reader.value(p.type);
        }
    }
}

} // namespace

ObjectFile readPly(const std::string& path, std::span<const char> bytes) {
    Reader reader{path, bytes.data(), bytes.data() + bytes.size()};
    const Header header = readHeader(reader);
    reader.encoding = header.encoding;
    Mesh mesh;
    for (const Element& element : header.elements) {
        if (element.name == "vertex") {
            readVertices(reader, element, mesh);
        } else if (element.name == "face") {
            readFaces(reader, element, mesh);
        } else {
            passOver(reader, element);
        }
    }
    ObjectFile result;
    result.files.push_back(path);
    result.object.parts = {{0, mesh.indices.size(), {}}};
    finishMesh(path, mesh, result.object.parts);
    result.object.mesh = std::move(mesh);
    return result;
}

} // namespace ibl
