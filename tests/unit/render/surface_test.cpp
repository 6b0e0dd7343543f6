// How meshes are interpolated, and shaders of a user's own.
#include "scene_support.h"

#include "core/error.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace ibl {
namespace {

/// A shader of one expression.
Material own(const std::string& expression, const std::string& uniforms = {}) {
    Material material;
    material.own =
        ShaderText{"own.frag", uniforms + "vec3 shade(vec3 normal, vec3 incident) {\n    return " +
                                   expression + ";\n}\n"};
    return material;
}

/// A triangle in the plane z = 0 whose normals lean outwards.
Mesh leaningTriangle() {
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    mesh.indices = {0, 1, 2};
    for (const V3f& p : mesh.positions)
        mesh.normals.push_back((p + V3f(0, 0, 1)).normalized());
    return mesh;
}

const Camera kFront{{0.4, 0.3, 4}, {0, 0, 0}, {0, 1, 0}, 40};

/// The point of the plane z = 0 that a pixel's centre sees, and its barycentric coordinates.
struct PlaneHit {
    V3d point;
    std::array<double, 3> weight;
    bool inside = false;
};
PlaneHit hitAt(int x, int y, int size) {
    const CameraRays rays = cameraRays(kFront, size, size);
    const V3d d = rays.direction(x + 0.5, y + 0.5);
    PlaneHit hit;
    hit.point = rays.eye - d * (rays.eye.z / d.z);
    hit.weight[2] = (hit.point.y + 1) / 2;
    hit.weight[1] = (1 - hit.weight[2] + hit.point.x) / 2;
    hit.weight[0] = 1 - hit.weight[1] - hit.weight[2];
    hit.inside = *std::ranges::min_element(hit.weight) > 0.03;
    return hit;
}

Image drawTriangle(Interpolation interpolation, const std::string& expression) {
    Scene scene;
    scene.object.mesh = leaningTriangle();
    scene.material = own(expression);
    scene.interpolation = interpolation;
    scene.background = NoBackground{};
    return Renderer(softwareContext(), scene, {48, 48, 1, {}}).render(kFront);
}

// The square of the normal's x tells the three apart: interpolating commutes with what is linear.
TEST(Interpolation, OfNormalsColoursOrNothing) {
    const Mesh mesh = leaningTriangle();
    const std::string expression = "vec3(normal.x * normal.x, surface_point.xy)";
    const Image phong = drawTriangle(Interpolation::phong, expression);
    const Image gouraud = drawTriangle(Interpolation::gouraud, expression);
    const Image flat = drawTriangle(Interpolation::flat, "normal + vec3(0.0, 0.0, 1.0)");
    int compared = 0;
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 48; ++x) {
            const PlaneHit hit = hitAt(x, y, 48);
            if (!hit.inside) continue;
            V3d normal(0);
            double color = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const V3d n(mesh.normals[k]);
                normal += n * hit.weight[k];
                color += n.x * n.x * hit.weight[k];
            }
            normal.normalize();
            const V3d p = hit.point;
            EXPECT_LT((pixel(phong, x, y) - V3d(normal.x * normal.x, p.x, p.y)).length(), 1e-4);
            EXPECT_LT((pixel(gouraud, x, y) - V3d(color, p.x, p.y)).length(), 1e-4);
            EXPECT_LT((pixel(flat, x, y) - V3d(0, 0, 2)).length(), 1e-3);
            ++compared;
        }
    }
    EXPECT_GT(compared, 100);
}

// More lights than a batch holds, and what belongs to the first of them only.
TEST(Interpolation, OfColoursUnderLightsIsTheSumAtVertices) {
    const Mesh mesh = leaningTriangle();
    Scene scene;
    scene.object.mesh = mesh;
    Part part{0, mesh.indices.size(), {}};
    part.surface.emissive = V3f(0.125F, 0, 0);
    scene.object.parts = {part};
    scene.material = Material(Shader::lambert);
    scene.material[Parameter::ambient] = V3d(0, 0.25, 0);
    scene.interpolation = Interpolation::gouraud;
    scene.background = NoBackground{};
    for (int i = 0; i < 300; ++i) {
        const double turn = 0.1 * i;
        scene.lights.push_back({LightType::directional,
                                V3d(0.4 * std::cos(turn), 0.4 * std::sin(turn), 1).normalized(),
                                V3d(0.01, 0.002 * (i % 7), i < 256 ? 0.01 : 0.05), V3d(0), 0, 0});
    }
    std::array<V3d, 3> colors;
    for (std::size_t k = 0; k < 3; ++k) {
        colors[k] = V3d(0.125, 0.25, 0);
        for (const SceneLight& light : scene.lights) {
            const double cosine = std::max(V3d(mesh.normals[k]).dot(light.direction), 0.0);
            colors[k] += light.strength * (cosine / kPi);
        }
    }
    const Image drawn = Renderer(softwareContext(), scene, {48, 48, 1, {}}).render(kFront);
    int compared = 0;
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 48; ++x) {
            const PlaneHit hit = hitAt(x, y, 48);
            if (!hit.inside) continue;
            V3d expected(0);
            for (std::size_t k = 0; k < 3; ++k)
                expected += colors[k] * hit.weight[k];
            EXPECT_LT((pixel(drawn, x, y) - expected).length(), 1e-5) << x << " " << y;
            EXPECT_EQ(drawn.at(x, y)[3], 1);
            ++compared;
        }
    }
    EXPECT_GT(compared, 100);
}

TEST(Interpolation, BothSidesTurnTheirNormalsToTheEye) {
    for (const Interpolation interpolation :
         {Interpolation::phong, Interpolation::gouraud, Interpolation::flat}) {
        for (const bool turned : {false, true}) {
            Scene scene;
            scene.object.mesh = leaningTriangle();
            if (turned) {
                std::swap(scene.object.mesh->indices[0], scene.object.mesh->indices[1]);
                for (V3f& n : scene.object.mesh->normals)
                    n = -n;
            }
            scene.material = own("vec3(normal.z, surface_outside ? 1.0 : 0.0, -incident.z)");
            scene.interpolation = interpolation;
            scene.background = NoBackground{};
            const Image frame = Renderer(softwareContext(), scene, {33, 33, 1, {}}).render(kFront);
            const V3d seen = pixel(frame, 16, 18);
            EXPECT_GT(seen.x, 0.5) << turned;
            EXPECT_EQ(seen.y, turned ? 0 : 1);
            EXPECT_GT(seen.z, 0.9);
        }
    }
}

TEST(Interpolation, TheSphereHasNoTriangles) {
    Scene scene;
    scene.material = own("normal");
    scene.interpolation = Interpolation::flat;
    scene.background = NoBackground{};
    EXPECT_THROW(Renderer(softwareContext(), scene, {9, 9, 1, {}}), Error);
}

TEST(OwnShader, ReadsTheMapsAndParametersThatItNames) {
    const Panorama probe = constantProbe(3), diffuse = constantProbe(5);
    Scene scene;
    scene.probe = &probe;
    scene.diffuse = &diffuse;
    scene.background = NoBackground{};
    scene.material =
        own("baseColor() * probeRadiance(normal) + roughness * diffuseRadiance(normal)",
            "uniform float roughness;\n");
    scene.material[Parameter::baseColor] = {1, 2, 4};
    scene.material[Parameter::roughness] = V3d(0.25);
    EXPECT_TRUE(hasParameter(scene.material, Parameter::roughness));
    EXPECT_TRUE(hasParameter(scene.material, Parameter::baseColor));
    EXPECT_FALSE(hasParameter(scene.material, Parameter::metallic));
    const MapNeeds needs = mapNeeds(scene.material);
    EXPECT_TRUE(needs.probe && needs.diffuse);
    EXPECT_FALSE(needs.specular || needs.split_sum || needs.probe_levels || needs.far_side);
    const Image frame = Renderer(softwareContext(), scene, {9, 9, 1, {}}).render({});
    EXPECT_EQ(pixel(frame, 4, 4), V3d(4.25, 7.25, 13.25));
}

TEST(OwnShader, HasFresnelAndRefraction) {
    const Panorama probe = constantProbe(1);
    Scene scene;
    scene.probe = &probe;
    scene.background = NoBackground{};
    scene.material =
        own("vec3(surfaceReflectance(1.0, ior), throughObject(normal, incident, ior).xy)",
            "uniform float ior;\n");
    const Image frame = Renderer(softwareContext(), scene, {9, 9, 1, {}}).render({});
    EXPECT_NEAR(pixel(frame, 4, 4).x, 0.04, 1e-6); // ((1.5 - 1) / (1.5 + 1))^2
    EXPECT_NEAR(pixel(frame, 4, 4).y, 0, 1e-5);    // straight on
}

TEST(Materials, AllMapsTurnWithTheProbe) {
    const Panorama probe = noiseProbe(Layout::faces, 4, 24);
    SpecularMaps maps;
    maps.levels.push_back(probe);
    Scene scene;
    scene.probe = &probe;
    scene.specular = &maps;
    scene.probe_levels = &maps.levels;
    scene.turn = {70, 20, 10, false};
    scene.background = NoBackground{};
    scene.material = own("vec3(1.0) + specularRadiance(normal, 0.0) - probeRadiance(normal)");
    const auto expectOne = [&](const char* what) {
        const Image frame = Renderer(softwareContext(), scene, {24, 24, 1, {}}).render(kFront);
        for (int i = 0; i < 24 * 24; ++i) {
            const float* p = frame.pixels.data() + 4 * i;
            if (p[3] != 1) continue;
            EXPECT_NEAR(p[0], 1, 1e-3) << what;
        }
    };
    expectOne("specular");
    scene.material = own("mirrored(normal, incident)",
                         "vec3 mirrored(vec3 normal, vec3 incident) {\n    vec2 albedo;\n"
                         "    vec3 bias, total;\n"
                         "    ggxIntegrals(normal, incident, 0.0, albedo, bias, total);\n"
                         "    return total / probeRadiance(reflect(incident, normal));\n}\n");
    scene.material.specular.samples = 4;
    expectOne("sampled");
}

TEST(OwnShader, ErrorsNameItsLine) {
    Scene scene;
    scene.background = NoBackground{};
    scene.material = own("normal.xyzw");
    try {
        Renderer(softwareContext(), scene, {9, 9, 1, {}});
        ADD_FAILURE() << "compiled";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::input);
        EXPECT_EQ(std::string(error.what()).rfind("own.frag:2: ", 0), 0u) << error.what();
    }
}

TEST(Mentions, FindsWholeIdentifiers) {
    EXPECT_TRUE(mentions("a = roughness;", "roughness"));
    EXPECT_TRUE(mentions("roughness", "roughness"));
    EXPECT_FALSE(mentions("my_roughness roughness2", "roughness"));
    EXPECT_TRUE(mentions("my_roughness, roughness", "roughness"));
}

/// A square about the origin in the plane y = 0, of 2 x 2, looking up, whose half at negative x is
/// cut out by its texture's alpha.
Object halfSquare() {
    Mesh square;
    for (const V3f& p : {V3f(-1, 0, -1), V3f(-1, 0, 1), V3f(1, 0, 1), V3f(1, 0, -1)}) {
        square.positions.push_back(p);
        square.normals.emplace_back(0, 1, 0);
        square.texcoords.emplace_back(0.5F * (p.x + 1), 0.5F * (p.z + 1));
    }
    square.indices = {0, 1, 2, 0, 2, 3};
    SurfaceTexture texture{Image(2, 1, 4), Wrap::clamp, Wrap::clamp};
    for (int x = 0; x < 2; ++x)
        std::fill_n(texture.image.at(x, 0), 4, static_cast<float>(x));
    Part part{0, 6, {}};
    part.surface.base_texture = 0;
    part.surface.alpha_cutoff = 0.5;
    return {square, {part}, {texture}};
}

// The square under a whole one, seen from above: its far side, of which half is missing.
TEST(Surfaces, CutOutsAreNoFarSide) {
    Scene scene;
    scene.object = halfSquare();
    Mesh& mesh = *scene.object.mesh;
    for (std::size_t i = 0; i < 4; ++i) {
        mesh.positions[i].y = -0.5F;
        mesh.normals[i] = V3f(0, -1, 0);
        mesh.positions.push_back(mesh.positions[i] + V3f(0, 1, 0));
        mesh.normals.emplace_back(0, 1, 0);
        mesh.texcoords.emplace_back(0.0F, 0.0F);
    }
    mesh.indices = {0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7};
    scene.object.parts.push_back({6, 6, {}});
    scene.material = own("abs(texelFetch(far_side, ivec2(gl_FragCoord.xy), 0).xyz) + "
                         "0.0 * throughObject(normal, incident, 1.5)");
    scene.background = NoBackground{};
    const int size = 32;
    const Camera above{{0, 9, 0}, {0, 0, 0}, {0, 0, -1}, 10};
    const Image drawn = Renderer(softwareContext(), scene, {size, size, 1, {}}).render(above);
    EXPECT_EQ(pixel(drawn, size / 4, size / 2), V3d(0));
    EXPECT_EQ(pixel(drawn, 3 * size / 4, size / 2), V3d(0, 1, 0));
}

TEST(Surfaces, CutOutsCastNoShadow) {
    Scene scene;
    scene.object = halfSquare();
    for (V3f& p : scene.object.mesh->positions)
        p.y = 1;
    scene.material = Material(Shader::lambert);
    scene.background = ColorBackground(2, 2, 2);
    scene.ground = Ground{0, V3d(0.5)};
    scene.lights = {{LightType::directional, V3d(0, 1, 0), V3d(1), V3d(0), 0, 0}};
    const Camera camera{{0, 0.8, 3}, {0, 0, 0}, {0, 1, 0}, 40};
    const int size = 64;
    const Image drawn = Renderer(softwareContext(), scene, {size, size, 1, {}, 256}).render(camera);
    const CameraRays rays = cameraRays(camera, size, size);
    int dark = 0, bright = 0;
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const V3d d = rays.direction(x + 0.5, y + 0.5);
            if (d.y >= 0) continue;
            const V3d p = rays.eye - d * (rays.eye.y / d.y);
            if (std::abs(p.x) < 0.05 || std::abs(p.x) > 0.95 || std::abs(p.z) > 0.95) continue;
            ASSERT_NEAR(drawn.at(x, y)[0], p.x > 0 ? 2 - 0.5 / kPi : 2, 1e-5) << x << " " << y;
            ++(p.x > 0 ? dark : bright);
        }
    }
    EXPECT_GT(std::min(dark, bright), 100);
}

} // namespace
} // namespace ibl
