#include "image/exr_headers.h"

#include "core/error.h"

#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfTileDescription.h>
#include <OpenEXR/ImfVersion.h>
#include <OpenEXR/ImfXdr.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace ibl {
namespace {

using Imath::Box2i;

/// OpenEXR's stream over bytes in memory.
class MemoryStream : public Imf::IStream {
public:
    MemoryStream(const std::vector<std::uint8_t>& bytes, const std::string& name)
        : IStream(name.c_str()), bytes_(bytes) {}
    bool read(char out[], int count) override {
        if (count < 0 || position_ > bytes_.size() ||
            static_cast<std::size_t>(count) > bytes_.size() - position_) {
            throw Iex::InputExc("unexpected end of file");
        }
        std::memcpy(out, bytes_.data() + position_, static_cast<std::size_t>(count));
        position_ += static_cast<std::size_t>(count);
        return position_ < bytes_.size();
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }

private:
    const std::vector<std::uint8_t>& bytes_;
    std::size_t position_ = 0;
};

/// Refuses what OpenEXR would take memory for before it sees that the file cannot hold it: its
/// tables go by the height of the data window, its buffers by the tile size.
void checkHeader(const Imf::Header& header, const std::string& name) {
    const Box2i data = header.dataWindow(), display = header.displayWindow();
    const std::int64_t data_width = windowExtent(data.min.x, data.max.x);
    const std::int64_t data_height = windowExtent(data.min.y, data.max.y);
    const std::int64_t width = windowExtent(display.min.x, display.max.x);
    const std::int64_t height = windowExtent(display.min.y, display.max.y);
    checkSize(name, data_width, data_height);
    checkSize(name, width, height);
    // A few pixels in a vast black frame are a mistake or an attack.
    if (width * height > std::max(std::int64_t{1} << 24, 64 * data_width * data_height)) {
        throw inputError(name, "has a display window far larger than its pixels; crop it first");
    }
    if (header.hasTileDescription()) {
        const Imf::TileDescription& tiles = header.tileDescription();
        if (std::uint64_t{tiles.xSize} * tiles.ySize >
            static_cast<std::uint64_t>(std::max(std::int64_t{1} << 22, data_width * data_height))) {
            throw inputError(name, "has tiles larger than its image; the file is corrupt");
        }
    }
}

/// Characters up to a zero.
std::string readName(Imf::IStream& stream) {
    std::string name;
    char c = 0;
    for (stream.read(&c, 1); c != 0; stream.read(&c, 1))
        name += c;
    return name;
}

/// Types whose values OpenEXR reads without regard to the size that the file gives for them.
bool isSizeRight(const std::string& type, int size) {
    constexpr std::pair<const char*, int> kSizes[] = {
        {"compression", 1}, {"lineOrder", 1}, {"envmap", 1},   {"deepImageState", 1},
        {"box2i", 16},      {"box2f", 16},    {"int", 4},      {"float", 4},
        {"double", 8},      {"v2i", 8},       {"v2f", 8},      {"v2d", 16},
        {"v3i", 12},        {"v3f", 12},      {"v3d", 24},     {"m33f", 36},
        {"m44f", 64},       {"m33d", 72},     {"m44d", 128},   {"rational", 8},
        {"timecode", 8},    {"keycode", 28},  {"tiledesc", 9}, {"chromaticities", 32},
    };
    for (const auto& [name, right] : kSizes) {
        if (type == name) return size == right;
    }
    return true;
}

/// Throws unless the attributes of the header at the stream's place have sizes that are theirs and
/// lie within the file: OpenEXR takes memory by an attribute's size (up to 2 GiB) before it reads
/// it. The place is kept.
void checkAttributes(Imf::IStream& stream) {
    const std::uint64_t begin = stream.tellg();
    while (!readName(stream).empty()) {
        const std::string type = readName(stream);
        int size = 0;
        Imf::Xdr::read<Imf::StreamIO>(stream, size);
        const std::uint64_t end = stream.tellg() + static_cast<std::uint64_t>(std::max(size, 0));
        if (type == "chlist") { // names, 16 bytes after each, ended by an empty one
            while (!readName(stream).empty())
                stream.seekg(stream.tellg() + 16);
        }
        if (size < 0 || !isSizeRight(type, size) || (type == "chlist" && stream.tellg() != end)) {
            throw Iex::InputExc("an attribute of the wrong size");
        }
        if (size == 0) continue;
        char last = 0;
        stream.seekg(end - 1);
        stream.read(&last, 1);
    }
    stream.seekg(begin);
}

} // namespace

std::unique_ptr<Imf::IStream> openExrStream(const Source& source) {
    if (source.whole) return std::make_unique<MemoryStream>(source.bytes, source.name);
    return std::make_unique<Imf::StdIFStream>(source.path.c_str());
}

std::vector<Imf::Header> readExrHeaders(Imf::IStream& stream, const std::string& name) {
    int magic = 0, version = 0;
    Imf::Xdr::read<Imf::StreamIO>(stream, magic);
    Imf::Xdr::read<Imf::StreamIO>(stream, version);
    std::vector<Imf::Header> headers;
    while (true) {
        if (!headers.empty()) {
            if (!Imf::isMultiPart(version)) break;
            const std::uint64_t position = stream.tellg();
            char first = 0;
            Imf::Xdr::read<Imf::StreamIO>(stream, first);
            if (first == 0) break;
            stream.seekg(position);
        }
        checkAttributes(stream);
        Imf::Header& header = headers.emplace_back();
        header.readFrom(stream, version);
        checkHeader(header, name);
    }
    return headers;
}

} // namespace ibl
