#include "render/frame_tiles.h"

#include "core/parallel.h"

#include <algorithm>

namespace ibl {
namespace {

void fillRow(const float* from, int channels, int width, float* to) {
    for (int x = 0; x < width; ++x, from += channels, to += 4) {
        to[0] = from[0];
        to[1] = from[1];
        to[2] = from[2];
        to[3] = channels == 4 ? from[3] : 1;
    }
}

} // namespace

Target makeTarget(const V2i& size, GLenum format) {
    Target target{size, makeTexture(GL_TEXTURE_2D, format, size.x, size.y), {}};
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        glTextureParameteri(target.texture.id(), filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        glTextureParameteri(target.texture.id(), wrap, GL_CLAMP_TO_EDGE);
    target.framebuffer = makeFramebuffer(target.texture);
    return target;
}

V2i tileSize(const V2i& frame, int edge) {
    constexpr int kPixels = 1 << 18; // 4 MB
    const int width = std::min(frame.x, edge);
    return {width, std::min({frame.y, edge, kPixels / width})};
}

FrameTiles::FrameTiles(const Image& frame, const V2i& most, int threads)
    : frame_(frame), most_(most), threads_(threads) {}

void FrameTiles::hold(const PixelRect& part) {
    if (texture_ && part.min == held_.min && part.max == held_.max) return;
    const V2i size = part.max - part.min;
    if (!texture_) texture_ = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, most_.x, most_.y);
    held_ = part;
    // In bands, so that little memory is touched. The fourth channel is added here: drivers are
    // slow at it, and shaders at texels of three.
    constexpr int kRows = 64;
    const std::size_t row = static_cast<std::size_t>(size.x) * 4;
    rgba_.resize(row * static_cast<std::size_t>(std::min(kRows, size.y)));
    for (int first = 0; first < size.y; first += kRows) {
        const int rows = std::min(kRows, size.y - first);
        parallelForRuns(static_cast<std::size_t>(rows), 16, threads_,
                        [&](std::size_t begin, std::size_t end) {
                            for (std::size_t y = begin; y < end; ++y) {
                                const int down = held_.min.y + first + static_cast<int>(y);
                                fillRow(frame_.at(held_.min.x, down), frame_.channels, size.x,
                                        rgba_.data() + y * row);
                            }
                        });
        glTextureSubImage2D(texture_.id(), 0, 0, first, size.x, rows, GL_RGBA, GL_FLOAT,
                            rgba_.data());
    }
    checkGl("uploading the picture");
}

} // namespace ibl
