#include "image/exr_chunks.h"

#include "core/parallel.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/openexr.h>

#include <algorithm>
#include <atomic>
#include <cstring>

namespace ibl {
namespace {

bool isDecoded(const Imf::Header& header, const ExrPixels& pixels) {
    if (header.hasTileDescription()) return false;
    bool halves = true;
    for (const std::string& name : pixels.channels) {
        const Imf::PixelType type = header.channels()[name].type;
        if (type == Imf::UINT) return false;
        halves = halves && type == Imf::HALF;
    }
    if (halves && pixels.channels.size() == 4) return false; // OpenEXR 3.1 exchanges them
    const Imf::Compression c = header.compression();
    return c == Imf::NO_COMPRESSION || c == Imf::RLE_COMPRESSION || c == Imf::ZIPS_COMPRESSION ||
           c == Imf::ZIP_COMPRESSION;
}

std::int64_t readBytes(exr_const_context_t, void* source, void* to, std::uint64_t count,
                       std::uint64_t from, exr_stream_error_func_ptr_t) {
    const auto& bytes = static_cast<const Source*>(source)->bytes;
    if (from >= bytes.size()) return 0;
    const std::uint64_t read = std::min<std::uint64_t>(count, bytes.size() - from);
    std::memcpy(to, bytes.data() + from, read);
    return static_cast<std::int64_t>(read);
}

std::int64_t countBytes(exr_const_context_t, void* source) {
    return static_cast<std::int64_t>(static_cast<const Source*>(source)->bytes.size());
}

/// An opened file.
class Context {
public:
    explicit Context(const Source& source) {
        exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
        how.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};
        if (source.whole) {
            how.user_data = const_cast<Source*>(&source); // handed back to readBytes
            how.read_fn = readBytes;
            how.size_fn = countBytes;
        }
        const std::string& name = source.whole ? source.name : source.path;
        if (exr_start_read(&context_, name.c_str(), &how) != EXR_ERR_SUCCESS) context_ = nullptr;
    }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    ~Context() {
        if (context_) exr_finish(&context_);
    }
    exr_const_context_t get() const { return context_; }

private:
    exr_context_t context_ = nullptr;
};

/// What a thread decodes chunks with.
class Decoder {
public:
    Decoder(exr_const_context_t context, int part, const Imf::Header& header,
            const ExrPixels& pixels)
        : context_(context), part_(part), first_row_(header.dataWindow().min.y), pixels_(pixels) {}
    Decoder(const Decoder&) = delete;
    Decoder& operator=(const Decoder&) = delete;
    ~Decoder() {
        if (begun_) exr_decoding_destroy(context_, &decode_);
    }

    /// The chunk of row y; whether it could be read.
    bool read(int y) {
        exr_chunk_info_t chunk;
        if (exr_read_scanline_chunk_info(context_, part_, y, &chunk) != EXR_ERR_SUCCESS)
            return false;
        const bool first = !begun_;
        const exr_result_t opened = first
                                        ? exr_decoding_initialize(context_, part_, &chunk, &decode_)
                                        : exr_decoding_update(context_, part_, &chunk, &decode_);
        if (opened != EXR_ERR_SUCCESS) return false;
        begun_ = true;
        direct(y);
        if (first &&
            exr_decoding_choose_default_routines(context_, part_, &decode_) != EXR_ERR_SUCCESS)
            return false;
        return exr_decoding_run(context_, part_, &decode_) == EXR_ERR_SUCCESS;
    }

private:
    void direct(int y) {
        float* row = pixels_.first + static_cast<std::size_t>(y - first_row_) * pixels_.row_floats;
        for (int c = 0; c < decode_.channel_count; ++c) {
            exr_coding_channel_info_t& channel = decode_.channels[c];
            const auto found = std::ranges::find(pixels_.channels, channel.channel_name);
            channel.decode_to_ptr = nullptr;
            if (found == pixels_.channels.end()) continue;
            const auto which = static_cast<std::size_t>(found - pixels_.channels.begin());
            channel.decode_to_ptr = reinterpret_cast<std::uint8_t*>(row + pixels_.place[which]);
            channel.user_bytes_per_element = sizeof(float);
            channel.user_data_type = EXR_PIXEL_FLOAT;
            channel.user_pixel_stride =
                static_cast<std::int32_t>(pixels_.pixel_floats * sizeof(float));
            channel.user_line_stride =
                static_cast<std::int32_t>(pixels_.row_floats * sizeof(float));
        }
    }

    exr_const_context_t context_;
    int part_;
    int first_row_;
    const ExrPixels& pixels_;
    exr_decode_pipeline_t decode_ = EXR_DECODE_PIPELINE_INITIALIZER;
    bool begun_ = false;
};

} // namespace

bool readExrChunks(const Source& source, const Imf::Header& header, int part,
                   const ExrPixels& pixels, int threads) {
    if (!isDecoded(header, pixels)) return false;
    const Context context(source);
    std::int32_t rows = 0;
    if (!context.get() ||
        exr_get_scanlines_per_chunk(context.get(), part, &rows) != EXR_ERR_SUCCESS || rows < 1)
        return false;
    const Imath::Box2i window = header.dataWindow();
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    const auto chunks = static_cast<std::size_t>((height + rows - 1) / rows);
    std::atomic<bool> read = true;
    constexpr std::size_t kAtOnce = 4;
    parallelForRuns(chunks, kAtOnce, threads, [&](std::size_t begin, std::size_t end) {
        Decoder decoder(context.get(), part, header, pixels);
        for (std::size_t i = begin; i < end && read; ++i) {
            if (!decoder.read(window.min.y + static_cast<int>(i) * rows)) read = false;
        }
    });
    return read;
}

} // namespace ibl
