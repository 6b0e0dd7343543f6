#include "render/display_chain.h"

#include "core/error.h"
#include "core/parallel.h"
#include "image/finite.h"
#include "render/blur_pyramid.h"
#include "render/display_lut.h"
#include "render/uniforms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace ibl {
namespace {

Error usage(const std::string& problem) {
    return {ExitCode::usage, "display: " + problem};
}

bool within(double value, double least, double most) {
    return value >= least && value <= most; // not of NaN
}

void requireSound(const DisplayOptions& o) {
    for (const double weight : {o.bloom, o.streaks, o.glare, o.vignette}) {
        if (!within(weight, 0, 1)) throw usage("a weight is not from 0 to 1; correct it");
    }
    if (o.bloom + o.streaks + o.glare > 1) {
        throw usage("bloom, streaks and glare scatter more light than there is; keep the sum of "
                    "their weights to 1");
    }
    const bool sound = within(o.threshold, 0, 1e30) && within(o.bloom_radius, 1e-4, 1) &&
                       within(o.streak_count, 1, 64) && within(o.streak_length, 1e-3, 2) &&
                       within(o.streak_attenuation, 1e-6, 0.99) &&
                       within(o.streak_angle, -360, 360) && within(o.key, 1e-6, 1e6);
    if (!sound) throw usage("a parameter of an effect is out of its range; correct it");
    std::size_t i = 0;
    for (const ToneParameter& p : toneMapInfo(o.tone_map).parameters) {
        const double value = o.parameters[i++];
        if (!within(value, p.least, p.most) || (p.whole && value != std::floor(value))) {
            throw usage(std::string(p.name) + " is out of its range; correct it");
        }
    }
    if (o.tone_map == ToneMap::display && !o.transform)
        throw usage("no display transform is given");
}

// As much of each octave of widths from level 1 to `level`, the last one in part; 1 in all times
// `weight`.
std::vector<double> octaveWeights(double level, std::size_t most, double weight) {
    const auto whole = static_cast<std::size_t>(level);
    const double part = level - static_cast<double>(whole);
    std::vector<double> weights(std::min(whole, most), weight / level);
    if (whole < most && part > 0) weights.push_back(weight * part / level);
    double sum = 0;
    for (const double w : weights)
        sum += w;
    for (double& w : weights)
        w *= weight / sum; // what levels that do not exist would have had
    return weights;
}

std::size_t levelsOf(const Target& base) {
    return static_cast<std::size_t>(std::log2(std::max(base.size.x, base.size.y))) + 1;
}

/// Exposure alone: not worth the way to the device and back. As exposed() of exposure.glsl.
void expose(Image& picture, double exposure, int threads) {
    constexpr float kLargest = std::numeric_limits<float>::max();
    const auto factor = static_cast<float>(exposure);
    const std::size_t row = picture.rowFloats();
    parallelForRuns(static_cast<std::size_t>(picture.height), 16, threads,
                    [&](std::size_t first, std::size_t last) {
                        float* values = picture.pixels.data();
                        if (factor == 1 && allFinite({values + first * row, values + last * row}))
                            return;
                        for (std::size_t i = first * row; i < last * row; ++i) {
                            const float v = values[i] * factor;
                            values[i] =
                                std::isnan(values[i]) ? 0 : std::clamp(v, -kLargest, kLargest);
                        }
                    });
}

// Texture units of the last pass; look-up tables of a display transform follow.
constexpr GLuint kGlowUnit = 1, kSurroundUnit = 2, kLutUnit = 3;

} // namespace

struct DisplayChain::State {
    DisplayOptions options;
    Passes passes;
    int tile_edge;
    std::vector<DisplayLut> luts;

    bool glows() const { return options.bloom + options.streaks + options.glare > 0; }
    Target glow(FrameTiles& tiles, double exposure);
    Target streaksOf(const Target& bright, int frame_height);
    Target retinexSurrounds(FrameTiles& tiles, double exposure);
    Texture localLevels(FrameTiles& tiles, double exposure);
    void run(Image& picture, double exposure, ToneMap tone_map, bool with_lens, int threads);
    const Program& lastProgram(ToneMap tone_map, bool straight, bool with_lens, bool even);
};

// What bloom, streaks and glare lay over the picture, at half its size.
Target DisplayChain::State::glow(FrameTiles& tiles, double exposure) {
    const DisplayOptions& o = options;
    const int height = tiles.frameSize().y;
    Target sum;
    if (o.bloom > 0 || o.streaks > 0) {
        Target bright = reduceFrame(passes, tiles, exposure, o.threshold);
        if (o.streaks > 0) sum = streaksOf(bright, height);
        if (o.bloom > 0) {
            const double level = levelOfDeviation(o.bloom_radius * height);
            const auto weights = octaveWeights(level, levelsOf(bright), o.bloom);
            addLevels(passes, std::move(bright), weights, sum);
        }
    }
    if (o.glare > 0) {
        Target all = reduceFrame(passes, tiles, exposure, std::nullopt);
        const std::size_t levels = levelsOf(all);
        const auto weights = octaveWeights(static_cast<double>(levels), levels, o.glare);
        addLevels(passes, std::move(all), weights, sum);
    }
    return sum;
}

// A ray's light fades by the same factor every pixel, to `streak_attenuation` at its length, and is
// summed in steps of four, each over the last one's result.
Target DisplayChain::State::streaksOf(const Target& bright, int frame_height) {
    const Program& program = passes.program({"streak.frag"});
    const double ratio = static_cast<double>(bright.size.y) / frame_height;
    const double length = std::max(1.0, options.streak_length * frame_height * ratio);
    setUniform(program, "fading", std::pow(options.streak_attenuation, 1 / length));
    const int steps = std::max(1, static_cast<int>(std::ceil(std::log2(length) / 2)));
    Target targets[2] = {makeTarget(bright.size, GL_RGBA32F), makeTarget(bright.size, GL_RGBA32F)};
    Target sum = makeTarget(bright.size, GL_RGBA32F);
    for (int ray = 0; ray < options.streak_count; ++ray) {
        const double turn =
            options.streak_angle / 360 + static_cast<double>(ray) / options.streak_count;
        const double angle = 2 * std::numbers::pi * turn;
        setUniform(program, "direction", V2d(std::cos(angle), -std::sin(angle)));
        const Texture* from = &bright.texture;
        for (int step = 0; step < steps; ++step) {
            const bool last = step + 1 == steps;
            setUniform(program, "stride", std::exp2(2 * step));
            setUniform(program, "weight", last ? options.streaks / options.streak_count : 1.0);
            glBindTextureUnit(0, from->id());
            const Target& to = last ? sum : targets[step % 2];
            const bool adds = last && ray > 0;
            adds ? passes.add(program, to) : passes.draw(program, to);
            from = &to.texture;
        }
    }
    return sum;
}

// The sum over the surrounds of w_n ln(blur_n + eps), at half the size.
Target DisplayChain::State::retinexSurrounds(FrameTiles& tiles, double exposure) {
    const auto [k, f, eps, scale_count, narrow, wide] = options.parameters;
    const int scales = static_cast<int>(scale_count);
    const Target base = reduceFrame(passes, tiles, exposure, std::nullopt);
    Target sum = makeTarget(base.size, GL_RGBA32F);
    double weights = 0;
    for (int n = 0; n < scales; ++n)
        weights += std::pow(scales - n, f);
    const Program& program = passes.program({"resize.glsl", "retinex_surround.frag"});
    setUniform(program, "size", base.size);
    setUniform(program, "eps", eps);
    for (int n = 0; n < scales; ++n) {
        // Widths in a geometric series.
        const double share = scales > 1 ? static_cast<double>(n) / (scales - 1) : 0;
        const double deviation = narrow * std::pow(wide / narrow, share) * tiles.frameSize().y;
        const Target surround = blurred(passes, base, tiles.frameSize(), deviation);
        setUniform(program, "weight", std::pow(scales - n, f) / weights);
        glBindTextureUnit(0, surround.texture.id());
        n > 0 ? passes.add(program, sum) : passes.draw(program, sum);
    }
    return sum;
}

// The pyramid of reinhard_local.glsl, seven levels as a texture's mip levels. The picture goes on
// outside, as far as the last level's samples about it look: sample i reads 2 i - 2 to 2 i + 2 of
// the level below, so in level 1 that is 126 ahead of the first and behind the last.
Texture DisplayChain::State::localLevels(FrameTiles& tiles, double exposure) {
    constexpr int kLevels = 7, kCoarsest = 1 << (kLevels - 1), kMargin = 2 * kCoarsest;
    const V2i frame = tiles.frameSize();
    const auto widened = [](int n) {
        const int last = (n - 1) / (2 * kCoarsest) + 1; // level 7's, at the pixels' right
        return kMargin + last * kCoarsest + kMargin;
    };
    const V2i size{widened(frame.x), widened(frame.y)};
    const int limit = getInteger(GL_MAX_TEXTURE_SIZE);
    if (std::max(size.x, size.y) > limit) {
        throw usage("reinhard-local takes pictures of up to " +
                    std::to_string(2 * (limit - 2 * kMargin - kCoarsest)) +
                    " pixels a side on this device; shrink it first");
    }
    GLuint id = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &id);
    Texture levels(id);
    glTextureStorage2D(id, kLevels, GL_R32F, size.x, size.y);
    glTextureParameteri(id, GL_TEXTURE_MIN_FILTER, GL_NEAREST_MIPMAP_NEAREST);
    glTextureParameteri(id, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    const Program& first = passes.program({"exposure.glsl", "local_level.frag"}, {"PICTURE 1"});
    setUniform(first, "exposure", exposure);
    setUniform(first, "fine_size", frame);
    setUniform(first, "margin", kMargin);
    const Framebuffer to = makeFramebuffer(levels);
    const auto partOf = [](int most, int n, int made) {
        return most >= n ? made : std::max(1, (most - 4) / 2);
    };
    const V2i step(partOf(tiles.most().x, frame.x, size.x),
                   partOf(tiles.most().y, frame.y, size.y));
    for (int y = 0; y < size.y; y += step.y) {
        for (int x = 0; x < size.x; x += step.x) {
            const V2i end(std::min(size.x, x + step.x), std::min(size.y, y + step.y));
            const auto range = [](int begin, int past, int n) {
                return std::pair(std::clamp(2 * (begin - kMargin) - 2, 0, n - 1),
                                 std::clamp(2 * (past - kMargin) + 1, 1, n));
            };
            const auto [left, right] = range(x, end.x, frame.x);
            const auto [top, bottom] = range(y, end.y, frame.y);
            tiles.hold({{left, top}, {right, bottom}});
            setUniform(first, "fine_origin", tiles.origin());
            glBindTextureUnit(0, tiles.texture().id());
            passes.draw(first, to, {{x, y}, end});
        }
    }
    const Program& next = passes.program({"local_level.frag"}, {"PICTURE 0"});
    setUniform(next, "margin", 0);
    glBindTextureUnit(0, levels.id());
    for (int level = 1; level < kLevels; ++level) {
        setUniform(next, "fine_size", V2i(size.x >> (level - 1), size.y >> (level - 1)));
        glNamedFramebufferTexture(to.id(), GL_COLOR_ATTACHMENT0, levels.id(), level);
        // Mesa and others allow a level to be read while another is drawn, told which it is.
        glTextureParameteri(levels.id(), GL_TEXTURE_BASE_LEVEL, level - 1);
        glTextureParameteri(levels.id(), GL_TEXTURE_MAX_LEVEL, level - 1);
        passes.draw(next, to, {{0, 0}, {size.x >> level, size.y >> level}});
    }
    glTextureParameteri(levels.id(), GL_TEXTURE_BASE_LEVEL, 0);
    glTextureParameteri(levels.id(), GL_TEXTURE_MAX_LEVEL, kLevels - 1);
    return levels;
}

const Program& DisplayChain::State::lastProgram(ToneMap tone_map, bool straight, bool with_lens,
                                                bool even) {
    const ToneMapInfo& info = toneMapInfo(tone_map);
    const auto flag = [](const char* name, bool on) {
        return std::string(name) + (on ? " 1" : " 0");
    };
    std::vector<std::string> definitions{flag("STRAIGHT", straight),
                                         flag("GLOW", with_lens && glows()), flag("EVEN", even),
                                         flag("VIGNETTE", with_lens && options.vignette > 0)};
    std::string function(info.function);
    if (!info.curve.empty()) {
        definitions.push_back("CURVE " + std::string(info.curve));
        function = options.per == Per::luminance ? "perLuminance" : "perChannel";
    }
    definitions.push_back("TONE " + function);
    std::vector<std::string_view> files{"exposure.glsl", "frame.glsl", "resize.glsl",
                                        "tone_maps.glsl"};
    if (!info.file.empty()) files.push_back(info.file);
    files.push_back("display.frag");
    const Program& program = passes.program(
        files, definitions, tone_map == ToneMap::display ? options.transform->glsl : "");
    std::array<float, kToneParameters> parameters{};
    std::copy(options.parameters.begin(), options.parameters.end(), parameters.begin());
    setUniform(program, "parameters", std::span<const float>(parameters));
    setUniform(program, "threshold", options.threshold);
    setUniform(program, "bright_weight", options.bloom + options.streaks);
    setUniform(program, "glare_weight", options.glare);
    setUniform(program, "vignette", options.vignette);
    setUniform(program, "key", options.key);
    return program;
}

// The picture through the lens, if asked, and through a tone map. What the last pass reads of the
// picture is the pixel that it makes, so the result may take its place band by band.
void DisplayChain::State::run(Image& picture, double exposure, ToneMap tone_map, bool with_lens,
                              int threads) {
    const V2i frame{picture.width, picture.height}, step = tileSize(frame, tile_edge);
    FrameTiles tiles(picture, step, threads);
    const bool straight = picture.channels == 4;
    Target overlay, surrounds;
    Texture levels;
    if (with_lens && glows()) overlay = glow(tiles, exposure);
    if (tone_map == ToneMap::retinex) surrounds = retinexSurrounds(tiles, exposure);
    if (tone_map == ToneMap::reinhardLocal) levels = localLevels(tiles, exposure);

    const bool even = frame == 2 * overlay.size || frame == 2 * surrounds.size;
    const Program& last = lastProgram(tone_map, straight, with_lens, even);
    setUniform(last, "exposure", exposure);
    setUniform(last, "frame_size", frame);
    glBindTextureUnit(kGlowUnit, overlay.texture.id());
    glBindTextureUnit(kSurroundUnit, levels ? levels.id() : surrounds.texture.id());
    bindLuts(luts, last, kLutUnit);

    const Target target = makeTarget(step, GL_RGBA32F);
    glPixelStorei(GL_PACK_ROW_LENGTH, frame.x);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    for (int y = 0; y < frame.y; y += step.y) {
        for (int x = 0; x < frame.x; x += step.x) {
            const V2i end{std::min(frame.x, x + step.x), std::min(frame.y, y + step.y)};
            const V2i size = end - V2i(x, y);
            tiles.hold({{x, y}, end});
            setUniform(last, "tile_origin", V2i(x, y));
            setUniform(last, "texture_origin", tiles.origin());
            glBindTextureUnit(0, tiles.texture().id());
            passes.draw(last, target.framebuffer, {{0, 0}, size});
            glReadPixels(0, 0, size.x, size.y, straight ? GL_RGBA : GL_RGB, GL_FLOAT,
                         picture.at(x, y));
        }
    }
    glPixelStorei(GL_PACK_ROW_LENGTH, 0);
    checkGl("applying the display chain");
}

DisplayChain::DisplayChain(const EglContext&, const DisplayOptions& options,
                           std::optional<std::filesystem::path> shader_folder, int tile_edge) {
    requireSound(options);
    state_ =
        std::make_unique<State>(State{options, Passes(std::move(shader_folder)), tile_edge, {}});
    if (options.transform) state_->luts = uploadLuts(*options.transform);
}

DisplayChain::~DisplayChain() = default;
DisplayChain::DisplayChain(DisplayChain&&) noexcept = default;
DisplayChain& DisplayChain::operator=(DisplayChain&&) noexcept = default;

void DisplayChain::apply(Image& picture, double exposure_stops, int threads) {
    const double exposure = std::exp2(exposure_stops);
    if (!(exposure > 0 && exposure < std::numeric_limits<float>::max())) {
        throw usage("the exposure is beyond what floats hold; stay within 120 stops");
    }
    if (picture.channels == 4 && state_->glows()) {
        throw usage("bloom, streaks and glare need a picture without alpha; give it a background");
    }
    const DisplayOptions& o = state_->options;
    const bool lens = state_->glows() || o.vignette > 0;
    const bool local = o.tone_map == ToneMap::retinex || o.tone_map == ToneMap::reinhardLocal;
    if (!lens && o.tone_map == ToneMap::none && picture.channels == 3) {
        expose(picture, exposure, threads);
        return;
    }
    if (!lens || !local) {
        state_->run(picture, exposure, o.tone_map, lens, threads);
        return;
    }
    // A map that looks at neighbours must see what the lens made of them.
    state_->run(picture, exposure, ToneMap::none, true, threads);
    state_->run(picture, 1, o.tone_map, false, threads);
}

void DisplayChain::warmUp(int threads) {
    // Halved it is even, then odd, and has levels enough for both ways up.
    Image small(256, 248);
    std::ranges::fill(small.pixels, 1.0f);
    apply(small, 0, threads);
}

} // namespace ibl
