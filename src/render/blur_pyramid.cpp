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

const V2i kAcross{1, 0}, kDown{0, 1};

const Program& reduction(Passes& passes, bool of_frame, int n, int m) {
    return passes.program(
        {"exposure.glsl", "resize.glsl", "reduce.frag"},
        {of_frame ? "SOURCE_IS_FRAME 1" : "SOURCE_IS_FRAME 0", n == 2 * m ? "EVEN 1" : "EVEN 0"});
}

/// Reduces along an axis from n to m pixels, as far as `made` goes, which stands in the first
/// pixels of the target; the texture's first pixel is `fine_origin`.
void reduceAlong(Passes& passes, const Program& program, const V2i& axis, int n, int m,
                 const Texture& fine, const V2i& fine_origin, const Framebuffer& to,
                 const PixelRect& made, const V2i& made_at) {
    setUniform(program, "axis", axis);
    setUniform(program, "n", n);
    setUniform(program, "m", m);
    setUniform(program, "fine_origin", fine_origin);
    setUniform(program, "made_origin", made.min - made_at);
    glBindTextureUnit(0, fine.id());
    passes.draw(program, to, {made_at, made_at + made.max - made.min});
}

Target halved(Passes& passes, const Target& fine) {
    Target made = makeTarget(halfOf(fine.size), GL_RGBA32F);
    const V2i n = fine.size, m = made.size, between{m.x, n.y};
    const Target& scratch = passes.scratch(between);
    reduceAlong(passes, reduction(passes, false, n.x, m.x), kAcross, n.x, m.x, fine.texture, {0, 0},
                scratch.framebuffer, {{0, 0}, between}, {0, 0});
    reduceAlong(passes, reduction(passes, false, n.y, m.y), kDown, n.y, m.y, scratch.texture,
                {0, 0}, made.framebuffer, {{0, 0}, m}, {0, 0});
    return made;
}

// The fine pixels that pixels [begin, end) of a reduction from n to m read, and one to spare.
std::pair<int, int> readRange(int begin, int end, int n, int m) {
    const double ratio = static_cast<double>(n) / m;
    return {std::max(0, static_cast<int>(std::floor((begin - 0.5) * ratio)) - 1),
            std::min(n, static_cast<int>(std::ceil((end + 0.5) * ratio)) + 1)};
}

/// A Gaussian along an axis, times `weight`.
const Program& gaussAlong(Passes& passes, const V2i& axis, double deviation, double weight,
                          const Texture& picture) {
    const Program& program = passes.program({"resize.glsl", "gauss.frag"});
    setUniform(program, "axis", axis);
    setUniform(program, "deviation", deviation);
    setUniform(program, "weight", weight);
    glBindTextureUnit(0, picture.id());
    return program;
}

Target gaussAcross(Passes& passes, const Target& picture, double deviation) {
    Target made = makeTarget(picture.size, GL_RGBA32F);
    passes.draw(gaussAlong(passes, kAcross, deviation, 1, picture.texture), made);
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
    const Program& across = reduction(passes, true, frame.x, size.x);
    const Program& down = reduction(passes, false, frame.y, size.y);
    setUniform(across, "exposure", exposure);
    setUniform(across, "threshold", threshold.value_or(0));
    Target made = makeTarget(size, GL_RGBA32F);
    // Parts so large that what they read fits into a tile.
    const auto partOf = [](int most, int n, int m) {
        return most >= n ? m : std::max(1, static_cast<int>((most - 4.0) * m / n) - 2);
    };
    const V2i most = tiles.most();
    const V2i step(partOf(most.x, frame.x, size.x), partOf(most.y, frame.y, size.y));
    const Target& scratch = passes.scratch({step.x, most.y});
    for (int y = 0; y < size.y; y += step.y) {
        for (int x = 0; x < size.x; x += step.x) {
            const V2i begin{x, y}, end{std::min(size.x, x + step.x), std::min(size.y, y + step.y)};
            const auto [left, right] = readRange(begin.x, end.x, frame.x, size.x);
            const auto [top, bottom] = readRange(begin.y, end.y, frame.y, size.y);
            tiles.hold({{left, top}, {right, bottom}});
            reduceAlong(passes, across, kAcross, frame.x, size.x, tiles.texture(), tiles.origin(),
                        scratch.framebuffer, {{begin.x, top}, {end.x, bottom}}, {0, 0});
            reduceAlong(passes, down, kDown, frame.y, size.y, scratch.texture, {begin.x, top},
                        made.framebuffer, {begin, end}, begin);
        }
    }
    return made;
}

void addLevels(Passes& passes, Target base, std::span<const double> weights, Target& sum) {
    std::vector<Target> levels;
    levels.push_back(std::move(base));
    while (levels.size() < weights.size())
        levels.push_back(halved(passes, levels.back()));
    const auto lay = [&](const Program& program, std::size_t l) {
        l == 0 && sum.texture ? passes.add(program, sum) : passes.draw(program, levels[l]);
    };
    // The coarsest level's edge is seen, where nothing wider covers it.
    const std::size_t last = levels.size() - 1;
    const Target across = gaussAcross(passes, levels[last], 1);
    lay(gaussAlong(passes, kDown, 1, weights[last], across.texture), last);
    // A level, once smoothed across, makes room for what goes on upwards.
    const Program& smooth = passes.program({"resize.glsl", "smooth.glsl", "smooth.frag"});
    for (std::size_t l = last; l-- > 0;) {
        const Target &own = levels[l], &coarse = levels[l + 1];
        const Target& scratch = passes.scratch(own.size);
        glBindTextureUnit(0, own.texture.id());
        passes.draw(smooth, scratch.framebuffer, {{0, 0}, own.size});
        const bool even = own.size == 2 * coarse.size;
        const Program& enlarge = passes.program({"resize.glsl", "smooth.glsl", "enlarge.frag"},
                                                {even ? "EVEN 1" : "EVEN 0"});
        setUniform(enlarge, "size", own.size);
        setUniform(enlarge, "own_weight", weights[l]);
        glBindTextureUnit(0, scratch.texture.id());
        glBindTextureUnit(1, coarse.texture.id());
        lay(enlarge, l);
    }
    if (!sum.texture) sum = std::move(levels[0]);
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
    const Target across = gaussAcross(passes, *picture, root(rest.x));
    Target made = makeTarget(picture->size, GL_RGBA32F);
    passes.draw(gaussAlong(passes, kDown, root(rest.y), 1, across.texture), made);
    return made;
}

} // namespace ibl
