#include "render/panorama_texture.h"

#include "core/error.h"
#include "panorama/layouts.h"
#include "panorama/lookup.h"

#include <algorithm>
#include <array>

namespace ibl {
namespace {

void requireSize(const std::string& name, GLenum limit_name, int side) {
    const GLint limit = getInteger(limit_name);
    if (side <= limit) return;
    throw inputError(name, "a side of " + std::to_string(side) +
                               " pixels is more than this graphics device takes, " +
                               std::to_string(limit) + "; convert it to a smaller one");
}

// Copies rows of RGB pixels, `stride` pixels apart, into a texture at `at`; face < 0: not a cube.
// The fourth channel is added here, since shaders read four-channel texels faster, and drivers are
// slow at adding it (Mesa 22: 25 ms for 1024x512, here 3).
void uploadRows(const Texture& texture, int face, const V2i& at, const V2i& size,
                const float* pixels, int stride, int level = 0) {
    constexpr int kStrip = 1 << 16; // texels at a time, which stay in the cache
    const int rows = std::max(1, kStrip / size.x);
    std::vector<float> rgba(static_cast<std::size_t>(size.x) * std::min(rows, size.y) * 4, 1.0f);
    for (int top = 0; top < size.y; top += rows) {
        const int count = std::min(rows, size.y - top);
        for (int y = 0; y < count; ++y) {
            const float* from = pixels + static_cast<std::size_t>(top + y) * stride * 3;
            float* to = rgba.data() + static_cast<std::size_t>(y) * size.x * 4;
            for (int x = 0; x < size.x; ++x)
                std::copy_n(from + 3 * x, 3, to + 4 * x);
        }
        if (face < 0) {
            glTextureSubImage2D(texture.id(), level, at.x, at.y + top, size.x, count, GL_RGBA,
                                GL_FLOAT, rgba.data());
        } else {
            glTextureSubImage3D(texture.id(), level, at.x, at.y + top, face, size.x, count, 1,
                                GL_RGBA, GL_FLOAT, rgba.data());
        }
    }
}

// Nodes of the interpolation: columns around, and rows from pole to pole. Plain lat-longs get their
// poles as two more rows; by the border rule the outer rows are the poles, and the last column,
// which is the first again, is left out.
Texture uploadLatlong(const Panorama& panorama, const std::string& name) {
    const Image& image = panorama.image;
    const bool border = panorama.layout == Layout::exrLatlong;
    const int columns = border ? std::max(1, image.width - 1) : image.width;
    const int rows = border ? image.height : image.height + 2;
    requireSize(name, GL_MAX_TEXTURE_SIZE, std::max(columns, rows));

    Texture texture = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, columns, rows);
    uploadRows(texture, -1, {0, border ? 0 : 1}, {columns, image.height}, image.pixels.data(),
               image.width);
    const Sampler sampler = makeSampler(panorama);
    if (border) {
        std::vector<float> seam;
        for (int y = 0; y < image.height; ++y) {
            const float *first = image.at(0, y), *last = image.at(image.width - 1, y);
            for (int c = 0; c < 3; ++c)
                seam.push_back(0.5f * first[c] + 0.5f * last[c]);
        }
        uploadRows(texture, -1, {0, 0}, {1, image.height}, seam.data(), 1);
    }
    const auto uploadPole = [&](int row, const V3d& color) {
        std::vector<Imath::V3f> pole(static_cast<std::size_t>(columns), Imath::V3f(color));
        uploadRows(texture, -1, {0, row}, {columns, 1}, &pole[0].x, columns);
    };
    uploadPole(rows - 1, sampler.south);
    uploadPole(0, sampler.north); // of a single row, the one that radianceAt() takes
    return texture;
}

Texture uploadCube(const Panorama& panorama, const std::string& name) {
    const Image& image = panorama.image;
    const int edge = *layoutSize(panorama.layout, image.width, image.height);
    requireSize(name, GL_MAX_CUBE_MAP_TEXTURE_SIZE, edge);

    Texture texture = makeTexture(GL_TEXTURE_CUBE_MAP, GL_RGBA32F, edge, edge);
    glTextureParameteri(texture.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTextureParameteri(texture.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    for (int face = 0; face < 6; ++face) {
        const FacePlacement place = facePlacement(panorama.layout, edge, face);
        if (place.step_i == V2i(1, 0) && place.step_j == V2i(0, 1)) {
            uploadRows(texture, face, {0, 0}, {edge, edge},
                       image.at(place.origin.x, place.origin.y), image.width);
            continue;
        }
        Image turned(edge, edge);
        for (int j = 0; j < edge; ++j) {
            for (int i = 0; i < edge; ++i) {
                const V2i pixel = place.pixel(i, j);
                std::copy_n(image.at(pixel.x, pixel.y), 3, turned.at(i, j));
            }
        }
        uploadRows(texture, face, {0, 0}, {edge, edge}, turned.pixels.data(), edge);
    }
    return texture;
}

} // namespace

std::vector<std::string> PanoramaTexture::definitions(const std::string& name) const {
    return {name + "_SAMPLER " + (is_cube ? "samplerCube" : "sampler2D"),
            name + "_BORDER " + (border ? "true" : "false")};
}

PanoramaTexture uploadPanorama(const Panorama& panorama, const std::string& name) {
    const Layout layout = panorama.layout;
    const bool is_cube = layout != Layout::latlong && layout != Layout::exrLatlong;
    PanoramaTexture result{is_cube ? uploadCube(panorama, name) : uploadLatlong(panorama, name),
                           is_cube, layout == Layout::exrLatlong || layout == Layout::exrCube};
    checkGl("uploading the " + name);
    return result;
}

Texture uploadCubeLevels(std::span<const Panorama> levels, const std::string& name) {
    const int edge = levels[0].image.width;
    requireSize(name, GL_MAX_CUBE_MAP_TEXTURE_SIZE, edge);
    Texture texture =
        makeTexture(GL_TEXTURE_CUBE_MAP, GL_RGBA32F, edge, edge, static_cast<int>(levels.size()));
    glTextureParameteri(texture.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
    glTextureParameteri(texture.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    for (std::size_t k = 0; k < levels.size(); ++k) {
        const Image& image = levels[k].image;
        for (int face = 0; face < 6; ++face) {
            uploadRows(texture, face, {0, 0}, {image.width, image.width},
                       image.at(0, face * image.width), image.width, static_cast<int>(k));
        }
    }
    checkGl("uploading the " + name);
    return texture;
}

Texture uploadImage(const Image& image, const std::string& name) {
    requireSize(name, GL_MAX_TEXTURE_SIZE, std::max(image.width, image.height));
    Texture texture = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, image.width, image.height);
    uploadRows(texture, -1, {0, 0}, {image.width, image.height}, image.pixels.data(), image.width);
    checkGl("uploading the " + name);
    return texture;
}

} // namespace ibl
