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

/// Uploads parts of a picture of 3 or 4 channels, which must outlive it, as RGBA floats. A part is
/// uploaded as it is when it is first wanted.
class FrameTiles {
public:
    /// No texture gets larger than `edge` in either direction.
    FrameTiles(const Image& frame, int edge, int threads);

    V2i frameSize() const { return {frame_.width, frame_.height}; }
    int edge() const { return edge_; }

    /// Sees to it that the texture holds `part`, of at most edge() a side: the whole picture if
    /// that fits, otherwise just the part. What it held before is gone.
    void hold(const PixelRect& part);
    const Texture& texture() const { return texture_; }
    /// Where the texture's first pixel stands in the picture.
    const V2i& origin() const { return held_.min; }

private:
    const Image& frame_;
    int edge_;
    int threads_;
    PixelRect held_{{0, 0}, {0, 0}};
    Texture texture_;
    std::vector<float, UninitialisedAllocator<float>> rgba_;
};

} // namespace ibl
