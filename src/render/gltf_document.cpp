#include "render/gltf_document.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace ibl {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are read as they are");

constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

std::uint32_t word(std::span<const char> bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

// The JSON and the bytes of a binary container.
struct Container {
    std::string_view json;
    std::span<const char> binary;
};

Container openContainer(const GltfDocument& document, std::span<const char> bytes) {
    if (bytes.size() < 20 || word(bytes, 8) > bytes.size()) {
        throw gltfDamaged(document, "it ends too early");
    }
    if (word(bytes, 4) != 2) throw gltfDamaged(document, "its version is not 2");
    Container container;
    for (std::size_t at = 12; at + 8 <= word(bytes, 8);) {
        const std::size_t length = word(bytes, at);
        if (length > bytes.size() - at - 8) throw gltfDamaged(document, "a chunk is cut off");
        const std::span<const char> data = bytes.subspan(at + 8, length);
        if (word(bytes, at + 4) == kJsonChunk && container.json.empty()) {
            container.json = {data.data(), data.size()};
        } else if (word(bytes, at + 4) == kBinaryChunk && container.binary.empty()) {
            container.binary = data;
        }
        at += 8 + (length + 3) / 4 * 4;
    }
    return container;
}

void requireUnderstood(const GltfDocument& document) {
    const GltfJson& asset = gltfObject(document, document.json, "asset");
    if (!gltfString(document, asset, "version").starts_with("2.")) {
        throw gltfDamaged(document, "its version is not 2.0");
    }
    for (const GltfJson& name : gltfArray(document, document.json, "extensionsRequired")) {
        if (name == "KHR_mesh_quantization") continue; // integers are read as such anywhere
        throw inputError(document.path, "requires the glTF extension " +
                                            (name.is_string() ? name.get<std::string>() : "?") +
                                            ", which is not known here; export it without");
    }
}

std::vector<std::uint8_t> readFile(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (!file || error) throw inputError(path, "cannot be read; check name and permissions");
    std::vector<std::uint8_t> bytes(size);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (!file) throw inputError(path, "cannot be read to its end; try again");
    return bytes;
}

void readBuffers(GltfDocument& document, std::span<const char> binary) {
    for (const GltfJson& buffer : gltfArray(document, document.json, "buffers")) {
        const std::string uri = gltfString(document, buffer, "uri");
        std::vector<std::uint8_t> bytes;
        if (uri.empty()) {
            const auto* data = reinterpret_cast<const std::uint8_t*>(binary.data());
            bytes.assign(data, data + binary.size());
        } else if (auto embedded = gltfDataUri(document, uri)) {
            bytes = std::move(*embedded);
        } else {
            const std::string file = gltfFile(document, uri);
            bytes = readFile(file);
            document.files.push_back(file);
        }
        if (gltfNumber(document, buffer, "byteLength", 0) > static_cast<double>(bytes.size())) {
            throw gltfDamaged(document, "a buffer is shorter than it says");
        }
        document.buffers.push_back(std::move(bytes));
    }
}

// Whole numbers from 0 that are no place in an array.
std::size_t sizeOf(const GltfDocument& document, const GltfJson& object, const char* key,
                   std::size_t otherwise) {
    const double value = gltfNumber(document, object, key, static_cast<double>(otherwise));
    if (!(value >= 0 && value < 9e15) || value != std::floor(value)) {
        throw gltfDamaged(document, std::string(key) + " is no whole number");
    }
    return static_cast<std::size_t>(value);
}

struct ComponentType {
    std::size_t code, bytes;
};
constexpr std::array<ComponentType, 6> kComponentTypes{
    {{5120, 1}, {5121, 1}, {5122, 2}, {5123, 2}, {5125, 4}, {5126, 4}}};

// Rows of `components` values of a type at equal distances.
struct Rows {
    const std::uint8_t* first = nullptr;
    std::size_t count = 0, stride = 0, type = 0, bytes = 0;

    template <class T>
    T at(std::size_t row, std::size_t component) const {
        T value;
        std::memcpy(&value, first + row * stride + component * sizeof(T), sizeof(T));
        return value;
    }
};

Rows rowsOf(const GltfDocument& document, const GltfJson& from, std::size_t count, std::size_t type,
            std::size_t components, bool strided) {
    const auto row = std::ranges::find(kComponentTypes, type, &ComponentType::code);
    if (row == kComponentTypes.end()) throw gltfDamaged(document, "a componentType is unknown");
    const GltfJson& views = gltfArray(document, document.json, "bufferViews");
    const auto view = gltfIndex(document, from, "bufferView", views.size());
    if (!view) throw gltfDamaged(document, "an accessor has no bufferView");
    const std::span<const std::uint8_t> bytes = gltfView(document, *view);
    const std::size_t packed = row->bytes * components;
    Rows rows{bytes.data(), count, packed, type, row->bytes};
    if (strided) rows.stride = sizeOf(document, views[*view], "byteStride", packed);
    const std::size_t offset = sizeOf(document, from, "byteOffset", 0);
    const bool fits =
        rows.stride >= packed && offset <= bytes.size() &&
        (count == 0 || (bytes.size() - offset >= packed &&
                        (count - 1) <= (bytes.size() - offset - packed) / rows.stride));
    if (!fits) throw gltfDamaged(document, "an accessor reaches beyond its bufferView");
    rows.first += offset;
    return rows;
}

float valueAt(const Rows& rows, std::size_t row, std::size_t component, bool normalized) {
    const auto scaled = [&](auto value, float largest) {
        const auto v = static_cast<float>(value);
        return normalized ? std::max(v / largest, -1.0F) : v;
    };
    switch (rows.type) {
    case 5120:
        return scaled(rows.at<std::int8_t>(row, component), 127);
    case 5121:
        return scaled(rows.at<std::uint8_t>(row, component), 255);
    case 5122:
        return scaled(rows.at<std::int16_t>(row, component), 32767);
    case 5123:
        return scaled(rows.at<std::uint16_t>(row, component), 65535);
    case 5125:
        return scaled(rows.at<std::uint32_t>(row, component), 4294967295.0F);
    default:
        return rows.at<float>(row, component);
    }
}

std::uint32_t indexAt(const GltfDocument& document, const Rows& rows, std::size_t row) {
    switch (rows.type) {
    case 5121:
        return rows.at<std::uint8_t>(row, 0);
    case 5123:
        return rows.at<std::uint16_t>(row, 0);
    case 5125:
        return rows.at<std::uint32_t>(row, 0);
    default:
        throw gltfDamaged(document, "indices are no unsigned integers");
    }
}

// The rows of an accessor of so many values. One without a bufferView is of zeros, none of which
// are there, for a sparse one to replace.
Rows baseRows(const GltfDocument& document, const GltfJson& accessor, std::size_t count,
              std::size_t type, std::size_t components) {
    if (accessor.contains("bufferView") || !accessor.contains("sparse"))
        return rowsOf(document, accessor, count, type, components, true);
    constexpr std::size_t kMostZeros = std::size_t{1} << 27; // no file's size bounds them
    if (count > kMostZeros) throw gltfDamaged(document, "an accessor has too many values");
    return {};
}

// Calls replace(place, rows, row) for each of the accessor's `count` values that a row replaces.
template <typename Replace>
void forEachSparse(const GltfDocument& document, const GltfJson& accessor, std::size_t count,
                   std::size_t type, std::size_t components, const Replace& replace) {
    if (!accessor.contains("sparse")) return;
    const GltfJson& sparse = gltfObject(document, accessor, "sparse");
    const std::size_t replaced = sizeOf(document, sparse, "count", 0);
    const GltfJson& indices = gltfObject(document, sparse, "indices");
    const Rows places = rowsOf(document, indices, replaced,
                               sizeOf(document, indices, "componentType", 0), 1, false);
    const Rows rows =
        rowsOf(document, gltfObject(document, sparse, "values"), replaced, type, components, false);
    for (std::size_t i = 0; i < replaced; ++i) {
        const std::size_t place = indexAt(document, places, i);
        if (place >= count)
            throw gltfDamaged(document, "a sparse accessor replaces what is not there");
        replace(place, rows, i);
    }
}

int base64Value(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

} // namespace

Error gltfDamaged(const GltfDocument& document, const std::string& problem) {
    return inputError(document.path, "is a damaged glTF file (" + problem + "); export it again");
}

GltfDocument openGltf(const std::string& path, std::span<const char> bytes) {
    GltfDocument document{path, {}, {}, {}};
    Container container{{bytes.data(), bytes.size()}, {}};
    if (container.json.starts_with("glTF")) container = openContainer(document, bytes);
    document.json = GltfJson::parse(container.json, nullptr, false);
    if (!document.json.is_object()) throw gltfDamaged(document, "its JSON cannot be read");
    requireUnderstood(document);
    readBuffers(document, container.binary);
    return document;
}

const GltfJson& gltfArray(const GltfDocument& document, const GltfJson& object, const char* key) {
    static const GltfJson none = GltfJson::array();
    const auto found = object.find(key);
    if (found == object.end()) return none;
    if (!found->is_array()) throw gltfDamaged(document, std::string(key) + " is no array");
    return *found;
}

const GltfJson& gltfObject(const GltfDocument& document, const GltfJson& object, const char* key) {
    static const GltfJson none = GltfJson::object();
    const auto found = object.find(key);
    if (found == object.end()) return none;
    if (!found->is_object()) throw gltfDamaged(document, std::string(key) + " is no object");
    return *found;
}

double gltfNumber(const GltfDocument& document, const GltfJson& object, const char* key,
                  double otherwise) {
    const auto found = object.find(key);
    if (found == object.end()) return otherwise;
    if (!found->is_number()) throw gltfDamaged(document, std::string(key) + " is no number");
    return found->get<double>();
}

std::vector<double> gltfNumbers(const GltfDocument& document, const GltfJson& object,
                                const char* key, std::size_t count) {
    std::vector<double> numbers;
    for (const GltfJson& value : gltfArray(document, object, key)) {
        if (!value.is_number()) throw gltfDamaged(document, std::string(key) + " holds no numbers");
        numbers.push_back(value.get<double>());
    }
    if (!numbers.empty() && numbers.size() != count) {
        throw gltfDamaged(document,
                          std::string(key) + " is not of " + std::to_string(count) + " numbers");
    }
    return numbers;
}

std::string gltfString(const GltfDocument& document, const GltfJson& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end()) return {};
    if (!found->is_string()) throw gltfDamaged(document, std::string(key) + " is no text");
    return found->get<std::string>();
}

std::optional<std::size_t> gltfIndex(const GltfDocument& document, const GltfJson& object,
                                     const char* key, std::size_t count) {
    const auto found = object.find(key);
    if (found == object.end()) return std::nullopt;
    if (!found->is_number_unsigned() || found->get<std::uint64_t>() >= count) {
        throw gltfDamaged(document, std::string(key) + " refers to what it does not have");
    }
    return static_cast<std::size_t>(found->get<std::uint64_t>());
}

std::span<const std::uint8_t> gltfView(const GltfDocument& document, std::size_t view) {
    const GltfJson& json = gltfArray(document, document.json, "bufferViews")[view];
    const auto buffer = gltfIndex(document, json, "buffer", document.buffers.size());
    if (!buffer) throw gltfDamaged(document, "a bufferView has no buffer");
    const std::span<const std::uint8_t> bytes = document.buffers[*buffer];
    const std::size_t offset = sizeOf(document, json, "byteOffset", 0);
    const std::size_t length = sizeOf(document, json, "byteLength", 0);
    if (offset > bytes.size() || length > bytes.size() - offset) {
        throw gltfDamaged(document, "a bufferView reaches beyond its buffer");
    }
    return bytes.subspan(offset, length);
}

std::vector<float> gltfFloats(const GltfDocument& document, std::size_t index,
                              std::size_t components) {
    const GltfJson& accessor = gltfArray(document, document.json, "accessors")[index];
    constexpr std::array<const char*, 5> kTypes{"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    if (gltfString(document, accessor, "type") != kTypes[components]) {
        throw gltfDamaged(document, "an accessor is not of the type that its use has");
    }
    const std::size_t count = sizeOf(document, accessor, "count", 0);
    const std::size_t type = sizeOf(document, accessor, "componentType", 0);
    const auto found = accessor.find("normalized");
    const bool normalized = found != accessor.end() && found->is_boolean() && found->get<bool>();
    const Rows base = baseRows(document, accessor, count, type, components);
    std::vector<float> values(count * components);
    const auto set = [&](std::size_t place, const Rows& rows, std::size_t row) {
        for (std::size_t c = 0; c < components; ++c)
            values[place * components + c] = valueAt(rows, row, c, normalized);
    };
    for (std::size_t i = 0; i < base.count; ++i)
        set(i, base, i);
    forEachSparse(document, accessor, count, type, components, set);
    return values;
}

std::vector<std::uint32_t> gltfIndices(const GltfDocument& document, std::size_t index) {
    const GltfJson& accessor = gltfArray(document, document.json, "accessors")[index];
    const std::size_t count = sizeOf(document, accessor, "count", 0);
    const std::size_t type = sizeOf(document, accessor, "componentType", 0);
    const Rows base = baseRows(document, accessor, count, type, 1);
    std::vector<std::uint32_t> values(count);
    const auto set = [&](std::size_t place, const Rows& rows, std::size_t row) {
        values[place] = indexAt(document, rows, row);
    };
    for (std::size_t i = 0; i < base.count; ++i)
        set(i, base, i);
    forEachSparse(document, accessor, count, type, 1, set);
    return values;
}

std::optional<std::vector<std::uint8_t>> gltfDataUri(const GltfDocument& document,
                                                     const std::string& uri) {
    if (!uri.starts_with("data:")) return std::nullopt;
    const std::size_t comma = uri.find(',');
    if (comma == uri.npos || uri.find(";base64") > comma) {
        throw gltfDamaged(document, "a data URI is not in base64");
    }
    std::vector<std::uint8_t> bytes;
    bytes.reserve((uri.size() - comma) / 4 * 3);
    std::uint32_t bits = 0;
    int held = 0;
    for (std::size_t i = comma + 1; i < uri.size() && uri[i] != '='; ++i) {
        const int value = base64Value(uri[i]);
        if (value < 0) throw gltfDamaged(document, "a data URI is not in base64");
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        held += 6;
        if (held >= 8) bytes.push_back(static_cast<std::uint8_t>(bits >> (held -= 8)));
    }
    return bytes;
}

std::string gltfFile(const GltfDocument& document, const std::string& uri) {
    std::string name;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        unsigned code = 0;
        const bool escaped = uri[i] == '%' && i + 2 < uri.size() &&
                             std::sscanf(uri.c_str() + i + 1, "%2x", &code) == 1;
        name += escaped ? static_cast<char>(code) : uri[i];
        if (escaped) i += 2;
    }
    if (name.find("://") != name.npos || name.find('\0') != name.npos) {
        throw inputError(document.path, "refers to " + uri + ", which is no file beside it");
    }
    return (std::filesystem::path(document.path).parent_path() / name).string();
}

} // namespace ibl
