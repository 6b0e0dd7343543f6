// What glTF 2.0 says of materials and textures, on a square with an image.
#include "gltf_support.h"
#include "scene_support.h"

#include "render/object_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace ibl {
namespace {

// 16 x 8 pixels, by cjpeg -quality 100 -optimize -sample 1x1: on the left R G B 204 102 51, on the
// right 0 128 255.
const std::string kColorJpeg =
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEB"
    "AQEBAQEBAQEBAQEBAQEBAQEBAQH/2wBDAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEB"
    "AQEBAQEBAQEBAQEBAQEBAQEBAQH/wAARCAAIABADAREAAhEBAxEB/8QAFQABAQAAAAAAAAAAAAAAAAAABAj/xAAUEAEA"
    "AAAAAAAAAAAAAAAAAAAA/8QAFQEBAQAAAAAAAAAAAAAAAAAACQv/xAAUEQEAAAAAAAAAAAAAAAAAAAAA/9oADAMBAAIR"
    "AxEAPwA4pzcJHUAE/d//2Q==";
// The same of grey: on the left 188, on the right 64.
const std::string kGreyJpeg =
    "/9j/4AAQSkZJRgABAQAAAQABAAD/2wBDAAEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEBAQEB"
    "AQEBAQEBAQEBAQEBAQEBAQEBAQH/wAALCAAIABABAREA/8QAFQABAQAAAAAAAAAAAAAAAAAACQr/xAAUEAEAAAAAAAAA"
    "AAAAAAAAAAAA/9oACAEBAAA/AHgQPv/Z";
// PNG files: a row of (10, 51, 204) and (250, 153, 102); one pixel (204, 128, 230); rows of red,
// green and of blue, white.
const std::string kPairPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAIAAAB7QOjdAAAAD0lEQVR42mPgMj7za2YaAAj4"
    "AwPYcjsnAAAAAElFTkSuQmCC";
const std::string kNormalPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR42mM40/AMAAROAjPJ"
    "ncPXAAAAAElFTkSuQmCC";
const std::string kFourPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAIAAAD91JpzAAAAEklEQVR42mP4z8DAAMIM/4EA"
    "AB/uBfvxq7p3AAAAAElFTkSuQmCC";

std::string fromBase64(const std::string& text) {
    static const std::string digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    unsigned bits = 0, count = 0;
    for (const char c : text.substr(0, text.find('='))) {
        bits = bits << 6 | static_cast<unsigned>(digits.find(c));
        if (++count % 4 != 1) bytes += static_cast<char>(bits >> (6 - 2 * ((count - 1) % 4)));
    }
    return bytes;
}

std::string image(const std::string& kind, const std::string& base64, const char* sampler = "") {
    return R"(,"images":[{"uri":"data:image/)" + kind + ";base64," + base64 +
           R"("}],"textures":[{"source":0)" + sampler + "}]";
}

double decoded(int code) { // IEC 61966-2-1
    const double v = code / 255.0;
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

// Codes up to one apart: what JPEG's conversion of colours rounds.
void expectCode(float value, int code, bool is_color, const std::string& what) {
    const auto linear = [&](int c) { return is_color ? decoded(c) : c / 255.0; };
    EXPECT_GE(value, linear(std::max(code - 1, 0)) - 1e-6) << what << code;
    EXPECT_LE(value, linear(code + 1) + 1e-6) << what << code;
}

// The square fills the frame: pixel i's centre is at x = (i + 0.5) / 9 - 1.
constexpr int kSide = 18;
Image pictureOf(const Scene& scene, int samples = 1) {
    const double fov = 2 * std::atan(0.25) * 180 / std::numbers::pi;
    const Camera camera{{0, 0, 4}, {0, 0, 0}, {0, 1, 0}, fov};
    return Renderer(softwareContext(), scene, {kSide, kSide, samples, {}}).render(camera);
}

TEST_F(Gltf, JpegImagesByViewDataAndFile) {
    const std::string material = R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0},)"
                                 R"("metallicRoughnessTexture":{"index":0}}})";
    for (const bool grey : {false, true}) {
        const std::string& base64 = grey ? kGreyJpeg : kColorJpeg;
        const std::string bytes = fromBase64(base64);
        ASSERT_EQ(bytes.size(), grey ? 162u : 292u);
        write("colour map.jpg", bytes);
        Square by_data{material, image("jpeg", base64)};
        Square by_view = by_data, by_file = by_data;
        by_view.extra = bytes;
        by_view.views = R"(,{"buffer":0,"byteOffset":)" + std::to_string(kExtraAt) +
                        R"(,"byteLength":)" + std::to_string(bytes.size()) + "}";
        by_view.more = R"(,"images":[{"bufferView":4,"mimeType":"image/jpeg"}],)"
                       R"("textures":[{"source":0}])";
        by_file.more = R"(,"images":[{"uri":"colour%20map.jpg"}],"textures":[{"source":0}])";
        for (const Square* square : {&by_data, &by_view, &by_file}) {
            const ObjectFile file = read(*square);
            ASSERT_EQ(file.object.textures.size(), 2u); // once as colours, once as numbers
            const Surface& surface = file.object.parts.at(0).surface;
            for (const bool is_color : {true, false}) {
                const auto index =
                    is_color ? surface.base_texture : surface.metallic_roughness_texture;
                const Image& texture = file.object.textures.at(index.value()).image;
                ASSERT_EQ(texture.width, 16);
                ASSERT_EQ(texture.height, 8);
                for (int c = 0; c < 3; ++c) {
                    const int left = grey ? 188 : std::array{204, 102, 51}[c];
                    const int right = grey ? 64 : std::array{0, 128, 255}[c];
                    expectCode(texture.at(0, 0)[c], left, is_color, "left ");
                    expectCode(texture.at(7, 7)[c], left, is_color, "left ");
                    expectCode(texture.at(8, 0)[c], right, is_color, "right ");
                    expectCode(texture.at(15, 7)[c], right, is_color, "right ");
                }
            }
            std::vector<std::string> files{folder_ + "/a.gltf", folder_ + "/square.bin"};
            if (square == &by_file) {
                files.push_back(folder_ + "/colour map.jpg");
                files.push_back(files.back());
            }
            EXPECT_EQ(file.files, files);
        }
    }
}

TEST_F(Gltf, EmissiveTextureAddsExactlyInAFurnace) {
    const Panorama furnace = constantProbe(3);
    Scene scene;
    scene.diffuse = &furnace;
    scene.background = NoBackground{};
    scene.material = Material(Shader::diffuse);
    scene.material[Parameter::baseColor] = V3d(1);
    const std::string color =
        R"({"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1]},"emissiveTexture":{"index":0})";
    // Without the factor, which is 0 then, the texture does nothing.
    scene.object = read({color + "}", image("png", kPairPng)}).object;
    const Image dark = pictureOf(scene);
    scene.object =
        read({color + R"(,"emissiveFactor":[0.5,1,0.25]})", image("png", kPairPng)}).object;
    const Image bright = pictureOf(scene);
    const V3d reflected(1.5, 0.75, 3), factor(0.5, 1, 0.25);
    const V3d left(decoded(10), decoded(51), decoded(204));
    const V3d right(decoded(250), decoded(153), decoded(102));
    for (int y = 0; y < kSide; ++y) { // texel centres: u = 1/4 and 3/4
        EXPECT_LT((pixel(dark, 4, y) - reflected).length(), 1e-6);
        EXPECT_LT((pixel(bright, 4, y) - reflected - factor * left).length(), 1e-6);
        EXPECT_LT((pixel(bright, 13, y) - reflected - factor * right).length(), 1e-6);
    }
}

TEST_F(Gltf, MetallicRoughnessTextureIsMultipliedByTheFactors) {
    // The lobe reflects 1 - roughness of a constant, all without Fresnel.
    Image table(1, 10);
    std::ranges::fill(table.pixels, 0.0F);
    for (int y = 0; y < 10; ++y)
        table.at(0, y)[1] = 1 - (static_cast<float>(y) + 0.5F) / 10;
    SpecularMaps maps{{noiseProbe(Layout::faces, 4, 24), noiseProbe(Layout::faces, 2, 12)}, 0, 1};
    for (Panorama& level : maps.levels)
        std::ranges::fill(level.image.pixels, 2.0F);
    const Panorama diffuse = constantProbe(3);
    Scene scene;
    scene.diffuse = &diffuse;
    scene.specular = &maps;
    scene.split_sum = &table;
    scene.background = NoBackground{};
    scene.material = Material(Shader::ggx);
    scene.material.specular.multiscatter = false;
    scene.material.fixed = false;
    scene.material[Parameter::baseColor] = V3d(1);
    scene.object = read({R"({"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1],)"
                         R"("metallicFactor":0.5,"roughnessFactor":0.75,)"
                         R"("metallicRoughnessTexture":{"index":0}}})",
                         image("png", kPairPng)})
                       .object;
    const Image frame = pictureOf(scene);
    const auto expected = [](double metallic, double roughness) {
        const double mirrored = 0.04 * (1 - roughness); // ((1.5 - 1) / (1.5 + 1))^2
        const V3d color(0.5, 0.25, 1);
        return (V3d(mirrored * 2) + color * (1 - mirrored) * 3) * (1 - metallic) +
               color * (1 - roughness) * 2 * metallic;
    };
    EXPECT_LT((pixel(frame, 4, 9) - expected(0.5 * 0.8, 0.75 * 0.2)).length(), 1e-5);
    EXPECT_LT((pixel(frame, 13, 9) - expected(0.5 * 0.4, 0.75 * 0.6)).length(), 1e-5);
}

TEST_F(Gltf, NormalTextureGoesAlongTheCoordinates) {
    Scene scene;
    scene.background = NoBackground{};
    scene.material.own =
        ShaderText{"own.frag", "vec3 shade(vec3 normal, vec3 incident) { return normal; }"};
    struct Case {
        std::vector<float> texcoords;
        V3d right, up; ///< of the image, on the square
    };
    const Case cases[] = {{{0, 1, 1, 1, 1, 0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                          {{0, 0, 0, 1, 1, 1, 1, 0}, {0, 1, 0}, {-1, 0, 0}}, // turned
                          {{1, 1, 0, 1, 0, 0, 1, 0}, {-1, 0, 0}, {0, 1, 0}}, // mirrored
                          {{0, 0, 1, 0, 1, 1, 0, 1}, {1, 0, 0}, {0, -1, 0}}};
    for (const Case& c : cases) {
        for (const double scale : {1.0, 0.5}) {
            const std::string use = scale == 1 ? "" : R"(,"scale":0.5)";
            scene.object = read({R"({"normalTexture":{"index":0)" + use + "}}",
                                 image("png", kNormalPng), c.texcoords})
                               .object;
            const V3d texel = V3d(204, 128, 230) * (2 / 255.0) - V3d(1);
            const V3d bent = (c.right * texel.x + c.up * texel.y) * scale + V3d(0, 0, texel.z);
            EXPECT_LT((pixel(pictureOf(scene), 9, 9) - bent.normalized()).length(), 1e-5)
                << c.right << c.up << scale;
        }
    }
}

// Of a texture with alpha 64 on the left and 191 on the right, and a factor of 0.8.
TEST_F(Gltf, AlphaMasksAndBlendsAsItsModeSays) {
    const std::string png = "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAAEElEQVR4nGP4"
                            "//+/AxDvBwAf6gb6AEyXwAAAAABJRU5ErkJggg==";
    Scene scene;
    scene.background = NoBackground{};
    scene.material.own =
        ShaderText{"own.frag", "vec3 shade(vec3 normal, vec3 incident) { return normal; }"};
    const auto alphas = [&](const std::string& mode, int samples) {
        ObjectFile file =
            read({R"({"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.8],)"
                  R"("baseColorTexture":{"index":0}})" +
                      mode + "}",
                  image("png", png, R"(,"sampler":0)") + R"(,"samplers":[{"wrapS":33071}])"});
        EXPECT_TRUE(file.notes.empty());
        scene.object = std::move(file.object);
        const Image drawn = pictureOf(scene, samples);
        Imath::V2d sum(0);
        for (int y = 0; y < kSide; ++y)
            sum += Imath::V2d(drawn.at(2, y)[3], drawn.at(kSide - 3, y)[3]);
        return sum / kSide;
    };
    const double left = 0.8 * 64 / 255, right = 0.8 * 191 / 255;
    EXPECT_EQ(alphas("", 1), Imath::V2d(1, 1));
    EXPECT_EQ(alphas(R"(,"alphaMode":"OPAQUE")", 1), Imath::V2d(1, 1));
    EXPECT_EQ(alphas(R"(,"alphaMode":"MASK")", 1), Imath::V2d(0, 1)); // standard cutoff 0.5
    EXPECT_EQ(alphas(R"(,"alphaMode":"MASK","alphaCutoff":0.1)", 1), Imath::V2d(1, 1));
    EXPECT_EQ(alphas(R"(,"alphaMode":"MASK","alphaCutoff":0.7)", 1), Imath::V2d(0, 0));
    const auto blended = alphas(R"(,"alphaMode":"BLEND")", 64);
    EXPECT_NEAR(blended.x, left, 0.01);
    EXPECT_NEAR(blended.y, right, 0.01);
}

// The texel of 0, 1 that stands at place i.
int texelAt(int i, Wrap wrap) {
    if (wrap == Wrap::clamp) return std::clamp(i, 0, 1);
    const int four = ((i % 4) + 4) % 4;
    return wrap == Wrap::repeat ? four % 2 : four < 2 ? four : 3 - four;
}

TEST_F(Gltf, TexturesGoOnAsTheirSamplersSay) {
    struct Case {
        std::string sampler;
        Wrap across, down;
    };
    const Case cases[] = {{R"({"wrapS":10497,"wrapT":33648})", Wrap::repeat, Wrap::mirror},
                          {R"({"wrapS":33648,"wrapT":33071})", Wrap::mirror, Wrap::clamp},
                          {R"({"wrapS":33071})", Wrap::clamp, Wrap::repeat}};
    const Panorama one = constantProbe(1);
    Scene scene;
    scene.diffuse = &one;
    scene.background = NoBackground{};
    scene.material = Material(Shader::diffuse);
    scene.material[Parameter::baseColor] = V3d(1);
    for (const Case& c : cases) {
        // From -1 to 2 each way: six texels, three pixels each.
        scene.object =
            read({R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})",
                  image("png", kFourPng, R"(,"sampler":0)") + R"(,"samplers":[)" + c.sampler + "]",
                  {-1, 2, 2, 2, 2, -1, -1, -1}})
                .object;
        EXPECT_EQ(scene.object.textures.at(0).across, c.across);
        EXPECT_EQ(scene.object.textures.at(0).down, c.down);
        const Image frame = pictureOf(scene);
        for (int y = -2; y < 4; ++y) {
            for (int x = -2; x < 4; ++x) {
                const int right = texelAt(x, c.across), low = texelAt(y, c.down);
                const V3d color = low ? V3d(right, right, 1) : V3d(1 - right, right, 0);
                EXPECT_LT((pixel(frame, 3 * (x + 2) + 1, 3 * (y + 2) + 1) - color).length(), 1e-4)
                    << c.sampler << x << " " << y;
            }
        }
    }
    const Square plain{R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}})",
                       image("png", kFourPng)};
    EXPECT_EQ(read(plain).object.textures.at(0).across, Wrap::repeat);
    EXPECT_EQ(read(plain).object.textures.at(0).down, Wrap::repeat);
}

} // namespace
} // namespace ibl
