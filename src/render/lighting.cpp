#include "render/lighting.h"

#include "core/error.h"
#include "render/light_choice.h"
#include "render/shader_program.h"
#include "render/uniforms.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ibl {
namespace {

// Lights of a batch, and its maps: as many as uniform blocks of 64 KiB hold.
constexpr std::size_t kBatch = 256;
// Memory of a batch's maps, unless they are smaller than that already.
constexpr std::size_t kMapBytes = std::size_t{256} << 20;
constexpr GLuint kMapUnit = 8;
// Directional lights' maps up to that size are of 16 bits, in which a depth is 1/32 of such a map's
// texel where the object is as deep as wide; comparisons allow for a whole one. So a batch has
// twice as many maps.
constexpr int kLargest16BitMap = 2048;
// What a light adds to a pixel in one sample, as a share of all light. A code of 8 bits on the
// ground. A surface's outline has but some of a pixel's samples, and so needs more of the lights in
// each. Lobes make much of few lights: without more of them outlines sparkle.
constexpr double kGroundStep = 1.0 / 256, kSurfaceStep = 1.0 / 1024, kLobeStep = 1.0 / 2048;

// As shaders/lights.glsl has them.
struct LightRecord {
    std::array<float, 4> place, strength, axis, maps;
};
struct ViewRecord {
    std::array<float, 16> map_from_world, world_from_map;
    std::array<float, 4> light; // whose: its place in the batch
};

std::array<float, 4> floats(const V3d& v, double w) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z),
            static_cast<float>(w)};
}

double stepOf(Shader shader) {
    if (!shaderInfo(shader).lit) return kGroundStep;
    const bool lobe =
        hasParameter(shader, Parameter::reflectivity) || hasParameter(shader, Parameter::f0);
    return lobe ? kLobeStep : kSurfaceStep;
}

bool isLocal(const SceneLight& light) {
    return light.type != LightType::directional;
}

LightRecord recordOf(const SceneLight& light, double weight) {
    LightRecord record{};
    record.place = isLocal(light) ? floats(light.position, 1) : floats(light.direction, 0);
    record.strength = floats(light.strength * weight, 0);
    // The cone's factor is clamp(scale c + offset, 0, 1)^2; for a point light 1.
    record.axis = floats(V3d(0), 0);
    record.maps = {0, 0, 0, 1};
    if (light.type == LightType::spot) {
        const double outer = std::cos(light.outer_cone);
        const double scale = 1 / std::max(std::cos(light.inner_cone) - outer, 1e-6);
        record.axis = floats(light.direction, scale);
        record.maps[3] = static_cast<float>(-scale * outer);
    }
    return record;
}

ViewRecord recordOf(const ShadowView& view, std::size_t light) {
    ViewRecord record{};
    const M44d& m = view.map_from_world;
    const auto texels = [&](int c) { return V3d(m[0][c], m[1][c], m[2][c]).length(); };
    const double u = texels(0), v = texels(1), z = texels(2);
    record.light = floats(V3d(static_cast<double>(light), z / (u * u), z / (v * v)), 0);
    for (std::size_t row = 0; row < 4; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
            const int r = static_cast<int>(row), c = static_cast<int>(column);
            record.map_from_world[4 * row + column] = static_cast<float>(view.map_from_world[r][c]);
            record.world_from_map[4 * row + column] = static_cast<float>(view.world_from_map[r][c]);
        }
    }
    return record;
}

template <typename Record>
void uploadRecords(const Buffer& buffer, const std::vector<Record>& records) {
    if (records.empty()) return;
    glNamedBufferSubData(buffer.id(), 0, static_cast<GLsizeiptr>(records.size() * sizeof(Record)),
                         records.data());
}

} // namespace

Lighting::Lighting(const Scene& scene, const std::vector<std::string>& surfaces, int map_size,
                   int samples, const std::optional<std::filesystem::path>& shader_folder)
    : local_(std::ranges::any_of(scene.lights, isLocal)),
      maps_needed_(scene.object.mesh),
      map_size_(map_size),
      samples_(samples) {
    if (maps_needed_) {
        draw_depth_ = makeProgram({{"shadow_map.vert"},
                                   {"coverage.glsl", "surface.glsl", "shadow_map.frag"},
                                   surfaces,
                                   {}},
                                  shader_folder);
        GLuint id = 0;
        glCreateFramebuffers(1, &id);
        to_layer_ = Framebuffer(id);
    }
    const auto block = [](std::size_t bytes) {
        GLuint id = 0;
        glCreateBuffers(1, &id);
        Buffer buffer(id);
        glNamedBufferStorage(id, static_cast<GLsizeiptr>(bytes), nullptr, GL_DYNAMIC_STORAGE_BIT);
        return buffer;
    };
    light_block_ = block(kBatch * sizeof(LightRecord));
    view_block_ = block(kBatch * sizeof(ViewRecord));
}

std::vector<std::string> Lighting::definitions() const {
    return {"LIGHT_CAPACITY " + std::to_string(kBatch),
            "LOCAL_LIGHTS " + std::to_string(local_ ? 1 : 0),
            "SHADOW_MAPS " + std::to_string(maps_needed_ ? 1 : 0)};
}

void Lighting::place(const Scene& scene, const Turn& turn, const Similarity& similarity) {
    const M33d probe_turn = turnMatrix(turn);
    if (placed_ && probe_turn == probe_turn_ && similarity == similarity_) return;
    placed_ = true;
    probe_turn_ = probe_turn;
    batches_.clear(); // their views are of another place
    turned_ = turnedLights(scene.lights, turn);
    similarity_ = similarity;
    caster_ = {similarity.shift, similarity.scale, {}};
    if (!maps_needed_) return;
    points_.clear();
    for (const V3f& p : scene.object.mesh->positions)
        points_.emplace_back(similarity.point(V3d(p)));
    caster_ = casterOf(points_);
}

void Lighting::chooseLights(const Scene& scene, const V3d& eye) {
    std::vector<SceneLight> shown = lightsThatShow(scene, turned_, similarity_, eye, counts_);
    if (!batches_.empty() && shown == lights_) return;
    lights_ = std::move(shown);
    of_samples_ = spreadLights(lights_, samples_, stepOf(scene.material.shader));
    ground_irradiance_ = V3d(0);
    for (const SceneLight& light : lights_) {
        if (!isLocal(light)) {
            ground_irradiance_ += light.strength * std::max(light.direction.y, 0.0);
        }
    }
    views_.clear();
    starts_.assign(1, 0);
    for (const SceneLight& light : lights_) {
        const std::vector<ShadowView> views = shadowViews(light, caster_, map_size_);
        views_.insert(views_.end(), views.begin(), views.end());
        starts_.push_back(views_.size());
    }
    makeBatches();
    in_use_ = -1;
}

std::size_t Lighting::mapsAtOnce(int map_size) {
    const std::size_t texel = map_size <= kLargest16BitMap ? 2 : 4;
    const auto bytes = static_cast<std::size_t>(map_size) * map_size * texel;
    return std::clamp(kMapBytes / bytes, std::size_t{1}, kBatch);
}

// A picture without lights has one batch, of none.
void Lighting::makeBatches() {
    const std::size_t most_views = maps_needed_ && !local_ ? mapsAtOnce(map_size_) : kBatch;
    batches_.clear();
    std::size_t light = 0;
    do {
        Batch batch{light, 0, starts_[light], 0};
        while (light < lights_.size() && batch.lights < kBatch &&
               starts_[light + 1] - batch.first_view <= most_views) {
            ++light;
            ++batch.lights;
            batch.views = starts_[light] - batch.first_view;
        }
        batches_.push_back(batch);
    } while (light < lights_.size());
    if (local_ && batches_.size() > 1) {
        throw inputError("render", "lights with more than " + std::to_string(kBatch) +
                                       " shadow maps, point or spot lights among them (one inside "
                                       "the object has six); give fewer");
    }
}

void Lighting::use(int index, const DrawCaster& draw) {
    const Batch& batch = batches_[static_cast<std::size_t>(index)];
    if (index != in_use_) {
        uploadViews(batch);
        if (maps_needed_ && batch.views > 0) drawMaps(batch, draw);
    }
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, light_block_.id());
    glBindBufferBase(GL_UNIFORM_BUFFER, 1, view_block_.id());
    glBindTextureUnit(kMapUnit, maps_.id());
    in_use_ = index;
}

// Point and spot lights are in every sample, so that a view's light has the same place in the
// sample as in the batch.
void Lighting::uploadViews(const Batch& batch) {
    std::vector<ViewRecord> views;
    for (std::size_t i = batch.first_light; i < batch.first_light + batch.lights; ++i) {
        for (std::size_t k = starts_[i]; k < starts_[i + 1]; ++k)
            views.push_back(recordOf(views_[k], i - batch.first_light));
    }
    uploadRecords(view_block_, views);
}

bool Lighting::useSample(int sample) {
    const Batch& batch = batches_[static_cast<std::size_t>(in_use_)];
    std::vector<LightRecord> lights;
    views_in_use_ = 0;
    for (const auto& [i, weight] : of_samples_[static_cast<std::size_t>(sample)]) {
        if (i < batch.first_light || i >= batch.first_light + batch.lights) continue;
        lights.push_back(recordOf(lights_[i], weight));
        LightRecord& record = lights.back();
        const std::size_t count = starts_[i + 1] - starts_[i];
        record.maps[0] = static_cast<float>(starts_[i] - batch.first_view);
        record.maps[1] = static_cast<float>(count);
        record.maps[2] = static_cast<float>(views_[starts_[i]].texel);
        views_in_use_ += static_cast<int>(count);
    }
    lights_in_use_ = static_cast<int>(lights.size());
    uploadRecords(light_block_, lights);
    return !lights.empty();
}

void Lighting::drawMaps(const Batch& batch, const DrawCaster& draw) {
    const auto wanted = static_cast<GLsizei>(batch.views);
    if (layers_ < wanted) {
        GLuint id = 0;
        glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &id);
        maps_ = Texture(id);
        const GLenum format =
            local_ || map_size_ > kLargest16BitMap ? GL_DEPTH_COMPONENT32F : GL_DEPTH_COMPONENT16;
        glTextureStorage3D(id, 1, format, map_size_, map_size_, wanted);
        layers_ = wanted;
        const std::array<float, 4> empty{1, 1, 1, 1};
        glTextureParameteri(id, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        glTextureParameteri(id, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        glTextureParameteri(id, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
        glTextureParameteri(id, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
        glTextureParameterfv(id, GL_TEXTURE_BORDER_COLOR, empty.data());
        checkGl("making shadow maps");
    }
    glBindFramebuffer(GL_FRAMEBUFFER, to_layer_.id());
    glViewport(0, 0, map_size_, map_size_);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    for (GLint layer = 0; layer < wanted; ++layer) {
        glNamedFramebufferTextureLayer(to_layer_.id(), GL_DEPTH_ATTACHMENT, maps_.id(), 0, layer);
        const float farthest = 1;
        glClearBufferfv(GL_DEPTH, 0, &farthest);
        const ShadowView& view = views_[batch.first_view + static_cast<std::size_t>(layer)];
        setUniform(draw_depth_, "clip_from_object", matrixOf(similarity_) * view.clip_from_world);
        setUniform(draw_depth_, "sample_of", Imath::V2i(layer, wanted));
        draw(draw_depth_);
    }
    glDisable(GL_DEPTH_TEST);
    glDepthFunc(GL_LEQUAL);
    checkGl("drawing shadow maps");
}

void Lighting::setUniforms(const Program& program, const V2d& jitter) const {
    // Not the pixel's own jitter, which moves the surface's points across the maps as well.
    setUniform(program, "texel_jitter", V2d(jitter.y, -jitter.x));
    setUniform(program, "caster_centre", caster_.centre);
    setUniform(program, "caster_radius", caster_.radius);
    setUniform(program, "light_count", lights_in_use_);
    setUniform(program, "first_batch", in_use_ == 0 ? 1 : 0);
}

} // namespace ibl
