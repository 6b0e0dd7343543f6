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
        glTextureParameteri(target.texture.id(), wrap, GL_MIRRORED_REPEAT);
    target.framebuffer = makeFramebuffer(target.texture);
    return target;
}

FrameTiles::FrameTiles(const Image& frame, int edge, int threads)
    : frame_(frame), edge_(edge), threads_(threads) {}

void FrameTiles::hold(const PixelRect& part) {
    const bool fits = frame_.width <= edge_ && frame_.height <= edge_;
    const PixelRect wanted = fits ? PixelRect{{0, 0}, frameSize()} : part;
    if (texture_ && wanted.min == held_.min && wanted.max == held_.max) return;
    const V2i size = wanted.max - wanted.min;
    if (!texture_ || held_.max - held_.min != size) {
        texture_ = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, size.x, size.y);
    }
    held_ = wanted;
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
