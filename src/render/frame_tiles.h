// A picture on the graphics device, as much of it at a time as fits. Internal to the render layer.
#pragma once

#include "image/image.h"
#include "render/camera.h"
#include "render/gl_objects.h"

#include <vector>

namespace ibl {

/// A texture that passes draw into and read from.
struct Target {
    V2i size{0, 0};
    Texture texture;
    Framebuffer framebuffer;
};
Target makeTarget(const V2i& size, GLenum format);

/// Parts for passes that go over a picture of that size part by part: as wide as it, but at most
/// `edge` a side, and so low that all that is made of a part stays in the processor's caches. To
/// upload a part twice costs less there than fresh memory for the whole picture.
V2i tileSize(const V2i& frame, int edge);

/// Uploads parts of a picture of 3 or 4 channels, which must outlive it, as RGBA floats. A part is
/// uploaded as it is when it is first wanted.
class FrameTiles {
public:
    /// Parts are up to `most` pixels large.
    FrameTiles(const Image& frame, const V2i& most, int threads);

    V2i frameSize() const { return {frame_.width, frame_.height}; }
    const V2i& most() const { return most_; }

    /// Sees to it that the texture holds `part`. What it held before is gone.
    void hold(const PixelRect& part);
    const Texture& texture() const { return texture_; }
    /// Where the texture's first pixel stands in the picture.
    const V2i& origin() const { return held_.min; }

private:
    const Image& frame_;
    V2i most_;
    int threads_;
    PixelRect held_{{0, 0}, {0, 0}};
    Texture texture_;
    std::vector<float, UninitialisedAllocator<float>> rgba_;
};

} // namespace ibl
