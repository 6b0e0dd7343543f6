#include "render/far_side.h"

#include <algorithm>
#include <array>
#include <utility>

namespace ibl {

constexpr int kLongestSide = 2048;

FarSide makeFarSide(const V2i& frame, Program program) {
    FarSide result;
    result.size = {std::min(frame.x, kLongestSide), std::min(frame.y, kLongestSide)};
    result.texture = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, result.size.x, result.size.y);
    result.depth = makeRenderbuffer(GL_DEPTH_COMPONENT32F, result.size.x, result.size.y);
    result.target = makeFramebuffer(result.texture, result.depth.id());
    result.program = std::move(program);
    return result;
}

void beginFarSide(const FarSide& far_side) {
    glBindFramebuffer(GL_FRAMEBUFFER, far_side.target.id());
    glViewport(0, 0, far_side.size.x, far_side.size.y);
    const std::array<float, 4> nothing{};
    const float nearest = 0;
    glClearBufferfv(GL_COLOR, 0, nothing.data());
    glClearBufferfv(GL_DEPTH, 0, &nearest);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glEnable(GL_CULL_FACE);
    glCullFace(GL_FRONT);
}

void endFarSide(const FarSide& far_side) {
    glDisable(GL_CULL_FACE);
    glDepthFunc(GL_LEQUAL);
    glDisable(GL_DEPTH_TEST);
    glBindTextureUnit(19, far_side.texture.id());
}

} // namespace ibl
