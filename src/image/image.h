// Pixels in memory: float, scene-linear, interleaved, row 0 at the top.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace ibl {

/// Memory for pixels, in huge pages where it is large and the system has them: touching memory for
/// the first time costs more, page by page, than most of what is done to a pixel.
void* allocatePixels(std::size_t bytes);
void freePixels(void* memory);

/// An allocator whose vectors leave new elements uninitialised, so that a large image that is
/// about to be filled is not written twice.
template <class T>
struct UninitialisedAllocator : std::allocator<T> {
    T* allocate(std::size_t count) { return static_cast<T*>(allocatePixels(count * sizeof(T))); }
    void deallocate(T* memory, std::size_t) { freePixels(memory); }
    template <class U>
    struct rebind {
        using other = UninitialisedAllocator<U>;
    };
    template <class U>
    void construct(U* p) {
        ::new (static_cast<void*>(p)) U;
    }
    template <class U, class... Args>
    void construct(U* p, Args&&... args) {
        ::new (static_cast<void*>(p)) U(std::forward<Args>(args)...);
    }
};

/// An image of `channels` floats a pixel (3: RGB; 4: RGB and alpha, colours premultiplied).
/// Copying copies the pixels.
struct Image {
    int width = 0;
    int height = 0;
    int channels = 3;
    std::vector<float, UninitialisedAllocator<float>> pixels; ///< height * width * channels

    Image() = default;
    /// Pixels are left uninitialised.
    Image(int w, int h, int c = 3)
        : width(w),
          height(h),
          channels(c),
          pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) *
                 static_cast<std::size_t>(c)) {}

    std::size_t rowFloats() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
    }
    float* row(int y) { return pixels.data() + static_cast<std::size_t>(y) * rowFloats(); }
    const float* row(int y) const {
        return pixels.data() + static_cast<std::size_t>(y) * rowFloats();
    }
    float* at(int x, int y) { return row(y) + static_cast<std::size_t>(x) * channels; }
    const float* at(int x, int y) const { return row(y) + static_cast<std::size_t>(x) * channels; }
};

} // namespace ibl
