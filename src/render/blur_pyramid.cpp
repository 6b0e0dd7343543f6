#include "render/blur_pyramid.h"

#include "render/uniforms.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ibl {
namespace {

V2i halfOf(const V2i& size) {
    return {(size.x + 1) / 2, (size.y + 1) / 2};
}

const Program& reduction(Passes& passes, bool of_frame, const V2i& fine, const V2i& made) {
    return passes.program({"exposure.glsl", "resize.glsl", "reduce.frag"},
                          {of_frame ? "SOURCE_IS_FRAME 1" : "SOURCE_IS_FRAME 0",
                           fine == 2 * made ? "EVEN 1" : "EVEN 0"});
}

void reduce(Passes& passes, const Program& program, const Texture& fine, const V2i& fine_size,
            const V2i& fine_origin, const Target& to, const PixelRect& part) {
    setUniform(program, "n", fine_size);
    setUniform(program, "m", to.size);
    setUniform(program, "fine_origin", fine_origin);
    glBindTextureUnit(0, fine.id());
    passes.draw(program, to.framebuffer, part);
}

Target halved(Passes& passes, const Target& fine) {
    Target made = makeTarget(halfOf(fine.size), GL_RGBA32F);
    const Program& program = reduction(passes, false, fine.size, made.size);
    reduce(passes, program, fine.texture, fine.size, {0, 0}, made, {{0, 0}, made.size});
    return made;
}

// The fine pixels that pixels [begin, end) of a reduction from n to m read, and one to spare.
std::pair<int, int> readRange(int begin, int end, int n, int m) {
    const double ratio = static_cast<double>(n) / m;
    return {std::max(0, static_cast<int>(std::floor((begin - 0.5) * ratio)) - 1),
            std::min(n, static_cast<int>(std::ceil((end + 0.5) * ratio)) + 1)};
}

Target gauss(Passes& passes, const Target& picture, const V2d& deviation) {
    const Program& program = passes.program({"resize.glsl", "gauss.frag"});
    setUniform(program, "deviation", deviation.x);
    Target across = makeTarget(picture.size, GL_RGBA32F);
    setUniform(program, "axis", V2i(1, 0));
    glBindTextureUnit(0, picture.texture.id());
    passes.draw(program, across);
    Target made = makeTarget(picture.size, GL_RGBA32F);
    setUniform(program, "deviation", deviation.y);
    setUniform(program, "axis", V2i(0, 1));
    glBindTextureUnit(0, across.texture.id());
    passes.draw(program, made);
    return made;
}

// How far a pyramid has come, along each axis: the size of a pixel and the variance of the way down
// and back up, both in the picture's pixels. By a ratio r, a tent has the variance r^2 / 6 + 1/12
// each way, the 1/12 for the pixels that it is integrated over.
struct Progress {
    V2d cell{1, 1};
    V2d variance{0, 0};

    Progress then(const V2i& fine, const V2i& made) const {
        const V2d ratio(static_cast<double>(fine.x) / made.x, static_cast<double>(fine.y) / made.y);
        const V2d tent = ratio * ratio / 6 + V2d(1.0 / 12);
        return {cell * ratio, variance + cell * cell * tent * 2};
    }
    /// What remains to be blurred by, in pixels of the level, squared.
    V2d rest(double deviation) const {
        return (V2d(deviation * deviation) - variance) / (cell * cell);
    }
};

} // namespace

double levelOfDeviation(double deviation) {
    return std::max(1.0, 0.5 * std::log2((deviation * deviation + 0.5) / 1.5));
}

Target reduceFrame(Passes& passes, FrameTiles& tiles, double exposure,
                   std::optional<double> threshold) {
    const V2i frame = tiles.frameSize();
    const int limit = getInteger(GL_MAX_TEXTURE_SIZE);
    const V2i size{std::min((frame.x + 1) / 2, limit), std::min((frame.y + 1) / 2, limit)};
    const Program& program = reduction(passes, true, frame, size);
    setUniform(program, "exposure", exposure);
    setUniform(program, "threshold", threshold.value_or(0));
    Target made = makeTarget(size, GL_RGBA32F);
    // Parts so large that what they read fits into a tile.
    const auto partOf = [&](int n, int m) {
        return std::max(1, static_cast<int>((tiles.edge() - 4.0) * m / n) - 2);
    };
    const bool whole = frame.x <= tiles.edge() && frame.y <= tiles.edge();
    const V2i step = whole ? size : V2i(partOf(frame.x, size.x), partOf(frame.y, size.y));
    for (int y = 0; y < size.y; y += step.y) {
        for (int x = 0; x < size.x; x += step.x) {
            const V2i begin{x, y}, end{std::min(size.x, x + step.x), std::min(size.y, y + step.y)};
            const auto [left, right] = readRange(begin.x, end.x, frame.x, size.x);
            const auto [top, bottom] = readRange(begin.y, end.y, frame.y, size.y);
            tiles.hold({{left, top}, {right, bottom}});
            reduce(passes, program, tiles.texture(), frame, tiles.origin(), made, {begin, end});
        }
    }
    return made;
}

void addLevels(Passes& passes, const Target& base, std::span<const double> weights,
               const Target& sum) {
    std::vector<Target> levels;
    for (std::size_t l = 1; l < weights.size(); ++l) {
        levels.push_back(halved(passes, l == 1 ? base : levels.back()));
    }
    Target carried;
    for (std::size_t l = weights.size(); l-- > 0;) {
        const Target& own = l == 0 ? base : levels[l - 1];
        const Program& program = passes.program(
            {"resize.glsl", "enlarge.frag"}, {carried.texture ? "COARSEST 0" : "COARSEST 1",
                                              own.size == 2 * carried.size ? "EVEN 1" : "EVEN 0"});
        setUniform(program, "own_weight", weights[l]);
        glBindTextureUnit(0, own.texture.id());
        if (carried.texture) glBindTextureUnit(1, carried.texture.id());
        if (l == 0) {
            passes.add(program, sum);
        } else {
            Target made = makeTarget(own.size, GL_RGBA32F);
            passes.draw(program, made);
            carried = std::move(made);
        }
    }
}

Target blurred(Passes& passes, const Target& base, const V2i& frame, double deviation) {
    Progress progress = Progress().then(frame, base.size);
    const Target* picture = &base;
    Target level;
    while (std::max(picture->size.x, picture->size.y) > 1) {
        const V2i next = halfOf(picture->size);
        const Progress further = progress.then(picture->size, next);
        const V2d rest = further.rest(deviation);
        if (std::min(rest.x, rest.y) < 4) break; // a Gaussian needs some pixels to be one
        level = halved(passes, *picture);
        picture = &level;
        progress = further;
    }
    const V2d rest = progress.rest(deviation);
    const auto root = [](double square) { return std::sqrt(std::max(square, 1e-6)); };
    return gauss(passes, *picture, {root(rest.x), root(rest.y)});
}

} // namespace ibl
