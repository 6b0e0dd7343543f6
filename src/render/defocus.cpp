#include "render/defocus.h"

#include "core/error.h"
#include "render/passes.h"
#include "render/uniforms.h"

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

constexpr int kSteps = 16; // as in defocus.frag

/// Sums of cover(|o|, k / kSteps) over all pixel offsets o, from k = 0 on.
std::vector<float> coverSums(double most) {
    const int last = static_cast<int>(most * kSteps + 0.5);
    std::vector<float> sums;
    for (int k = 0; k <= last; ++k) {
        const double radius = static_cast<double>(k) / kSteps;
        const int reach = static_cast<int>(radius + 0.5);
        double sum = 0;
        for (int y = -reach; y <= reach; ++y) {
            for (int x = -reach; x <= reach; ++x)
                sum += std::clamp(radius + 0.5 - std::hypot(x, y), 0.0, 1.0);
        }
        sums.push_back(static_cast<float>(sum));
    }
    return sums;
}

Texture upload(GLenum internal, GLenum format, int width, int height, const float* values) {
    Texture texture = makeTexture(GL_TEXTURE_2D, internal, width, height);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    glTextureSubImage2D(texture.id(), 0, 0, 0, width, height, format, GL_FLOAT, values);
    return texture;
}

} // namespace

double blurRadius(const Lens& lens, double inverse_distance, double pixels_per_tangent) {
    return 0.5 * lens.aperture * std::abs(1 / lens.focus - inverse_distance) * pixels_per_tangent;
}

void defocus(const EglContext&, Image& picture, const Image& inverse_distance, const Lens& lens,
             double pixels_per_tangent, const std::optional<std::filesystem::path>& shader_folder,
             int threads) {
    if (!(lens.aperture >= 0 && lens.aperture < 1e9 && lens.focus > 0 && lens.focus < 1e9)) {
        throw Error(ExitCode::usage, "lens: the aperture is not from 0 or the focus not above 0; "
                                     "correct them");
    }
    const int width = picture.width, height = picture.height;
    const GLint edge = getInteger(GL_MAX_TEXTURE_SIZE);
    if (width > edge || height > edge) {
        throw Error(ExitCode::usage, "lens: the picture is larger than the device's textures, " +
                                         std::to_string(edge) + "; ask for a smaller one");
    }
    std::vector<float> circles;
    double most = 0;
    for (const float inverse : inverse_distance.pixels) {
        const double radius = blurRadius(lens, inverse, pixels_per_tangent);
        most = std::max(most, radius);
        circles.push_back(static_cast<float>(std::round(std::min(radius, 1e6) * kSteps) / kSteps));
        circles.push_back(inverse);
    }
    if (!(most <= kMostBlur)) {
        throw Error(ExitCode::usage, "lens: blurs over more than " + std::to_string(kMostBlur) +
                                         " pixels; take a smaller aperture");
    }
    const std::vector<float> sums = coverSums(most);
    FrameTiles tiles(picture, {width, height}, threads);
    tiles.hold({{0, 0}, {width, height}});
    const Texture circle_texture = upload(GL_RG32F, GL_RG, width, height, circles.data());
    const Texture sum_texture =
        upload(GL_R32F, GL_RED, static_cast<int>(sums.size()), 1, sums.data());
    Passes passes(shader_folder);
    const Program& program = passes.program({"resize.glsl", "defocus.frag"});
    setUniform(program, "reach", static_cast<int>(most + 0.5));
    const Target made = makeTarget({width, height}, GL_RGBA32F);
    glBindTextureUnit(0, tiles.texture().id());
    glBindTextureUnit(1, circle_texture.id());
    glBindTextureUnit(2, sum_texture.id());
    passes.draw(program, made);
    glPixelStorei(GL_PACK_ROW_LENGTH, 0); // frames may leave theirs
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, picture.channels == 4 ? GL_RGBA : GL_RGB, GL_FLOAT,
                 picture.pixels.data());
    checkGl("drawing the depth of field");
}

} // namespace ibl
