// PLY, glTF and the materials of OBJ: what is read, and what is refused.
#include "render/object_file.h"

#include "core/error.h"
#include "image/write.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace ibl {
namespace {

class ObjectFiles : public testing::Test {
protected:
    ObjectFiles()
        : folder_(testing::TempDir() + "ibl_objects_" +
                  testing::UnitTest::GetInstance()->current_test_info()->name()) {
        std::filesystem::create_directories(folder_);
    }
    ~ObjectFiles() override { std::filesystem::remove_all(folder_); }

    std::string write(const std::string& name, const std::string& bytes) const {
        const std::string path = folder_ + "/" + name;
        std::ofstream(path, std::ios::binary) << bytes;
        return path;
    }
    ObjectFile read(const std::string& name, const std::string& bytes) const {
        return readObject(write(name, bytes));
    }
    // The message; nothing when the file was taken.
    std::string refusal(const std::string& name, const std::string& bytes) const {
        try {
            read(name, bytes);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::input) << error.what();
            return error.what();
        }
        return "";
    }

    const std::string folder_;
};

double area(const Mesh& mesh) {
    double sum = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const V3d a(mesh.positions[mesh.indices[i]]), b(mesh.positions[mesh.indices[i + 1]]),
            c(mesh.positions[mesh.indices[i + 2]]);
        sum += (b - a).cross(c - a).length() / 2;
    }
    return sum;
}

template <class T>
void append(std::string& bytes, T value, bool big) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    if (big != (std::endian::native == std::endian::big)) std::reverse(raw, raw + sizeof(T));
    bytes.append(raw, sizeof(T));
}

// A concave quad, a dart of area 1, with an unknown property and element.
std::string dart(const std::string& format) {
    std::string bytes = "ply\nformat " + format +
                        " 1.0\ncomment a dart\nelement vertex 4\nproperty float x\n"
                        "property double y\nproperty float z\nproperty uchar red\n"
                        "property float s\nproperty float t\n"
                        "element spare 1\nproperty list uchar short things\n"
                        "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    constexpr double points[4][2] = {{0, 0}, {2, 1}, {0, 2}, {1, 1}};
    if (format == "ascii") {
        for (const auto& p : points) {
            bytes += std::to_string(p[0]) + " " + std::to_string(p[1]) + " 0 9 0.25 0.75\n";
        }
        return bytes + "2 7 8\n4 0 1 2 3";
    }
    const bool big = format == "binary_big_endian";
    for (const auto& p : points) {
        append(bytes, static_cast<float>(p[0]), big);
        append(bytes, p[1], big);
        append(bytes, 0.0F, big);
        bytes += '\x09';
        append(bytes, 0.25F, big);
        append(bytes, 0.75F, big);
    }
    bytes += '\x02';
    append(bytes, std::int16_t{7}, big);
    append(bytes, std::int16_t{8}, big);
    bytes += '\x04';
    for (const std::int32_t i : {0, 1, 2, 3})
        append(bytes, i, big);
    return bytes;
}

constexpr const char* kPlyFormats[] = {"ascii", "binary_little_endian", "binary_big_endian"};

TEST_F(ObjectFiles, PlyIsTheSameInAllItsEncodings) {
    for (const char* format : kPlyFormats) {
        const Mesh mesh = *read("dart.ply", dart(format)).object.mesh;
        EXPECT_EQ(mesh.positions.size(), 4u);
        EXPECT_EQ(mesh.positions[1], V3f(2, 1, 0));
        EXPECT_EQ(mesh.texcoords[0], V2f(0.25F, 0.25F)); // v down
        EXPECT_EQ(mesh.indices.size(), 6u);
        EXPECT_NEAR(area(mesh), 1, 1e-12) << format; // a fan from corner 0 would give 2
        for (const V3f& n : mesh.normals)
            EXPECT_EQ(n, V3f(0, 0, 1)) << format;
    }
}

TEST_F(ObjectFiles, PlyCutAtAnyLengthIsRefused) {
    for (const char* format : kPlyFormats) {
        const std::string whole = dart(format);
        for (std::size_t length = 5; length < whole.size(); ++length) {
            EXPECT_NE(refusal("cut.ply", whole.substr(0, length)), "") << format << " " << length;
        }
    }
}

TEST_F(ObjectFiles, PlyRefusals) {
    const auto face = [](const std::string& corners, const std::string& counts = "3 1") {
        return "ply\nformat ascii 1.0\nelement vertex " + counts.substr(0, counts.find(' ')) +
               "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
               counts.substr(counts.find(' ') + 1) +
               "\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n" +
               corners;
    };
    EXPECT_EQ(refusal("a.ply", face("3 0 1 2\n")), "");
    EXPECT_NE(refusal("a.ply", face("3 0 1 3\n")).find("vertex"), std::string::npos);
    EXPECT_NE(refusal("a.ply", face("3 0 1 -1\n")), "");
    EXPECT_NE(refusal("a.ply", face("3 0 0 1\n")).find("no triangle"), std::string::npos);
    EXPECT_NE(refusal("a.ply", face("3 0 1 2\n", "99999999999999 1")), "");
    EXPECT_NE(refusal("a.ply", face("3 0 1 2\n", "3 4000000000")), "");
    EXPECT_NE(refusal("a.ply", face("200 0 1 2\n")), "");
    std::string nan = face("3 0 1 2\n");
    nan.replace(nan.find("0 0 0"), 5, "nan 0 0");
    EXPECT_NE(refusal("a.ply", nan).find("finite"), std::string::npos);
    EXPECT_NE(refusal("a.ply", "ply\nformat utf8 1.0\nend_header\n"), "");
}

TEST_F(ObjectFiles, EmptyOnesAreCalledThat) {
    for (const char* name : {"a.obj", "a.ply", "a.gltf", "a.glb"})
        EXPECT_NE(refusal(name, "").find("is empty; export it again"), std::string::npos) << name;
}

// Three corners, without normals, as base64: (0,0,0) (1,0,0) (0,1,0).
constexpr const char* kCorners = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";

std::string gltf(const std::string& nodes, const std::string& more = "",
                 const std::string& accessor = R"("componentType":5126,"count":3,"type":"VEC3")") {
    return R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[)" + nodes +
           R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],)" +
           R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1],)"
           R"("metallicFactor":0.25,"roughnessFactor":0.75},"emissiveFactor":[1,2,3]}],)"
           R"("accessors":[{"bufferView":0,)" +
           accessor +
           R"(}],"bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,)" +
           R"("uri":"data:application/octet-stream;base64,)" + kCorners + "\"}]" + more + "}";
}

TEST_F(ObjectFiles, GltfNodesAreBroughtIntoTheWorld) {
    // The parent moves by (10, 0, 0); the child turns by 90 degrees about Y, +X to -Z, and doubles.
    const ObjectFile file = read(
        "a.gltf",
        gltf(
            R"({"children":[1,2],"translation":[10,0,0]},)"
            R"({"mesh":0,"rotation":[0,0.70710678118654752,0,0.70710678118654752],"scale":[2,2,2]},)"
            R"({"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]})"));
    const Mesh& mesh = *file.object.mesh;
    ASSERT_EQ(mesh.positions.size(), 6u);
    EXPECT_LT((mesh.positions[1] - V3f(10, 0, -2)).length(), 1e-5);
    EXPECT_LT((mesh.positions[2] - V3f(10, 2, 0)).length(), 1e-5);
    EXPECT_LT((mesh.normals[0] - V3f(1, 0, 0)).length(), 1e-6);
    // Mirrored: the winding is turned over, the normal stays outwards.
    EXPECT_LT((mesh.positions[4] - V3f(9, 0, 5)).length(), 1e-5);
    EXPECT_LT((mesh.normals[3] - V3f(0, 0, 1)).length(), 1e-6);
    ASSERT_EQ(file.object.parts.size(), 2u);
    const Surface& surface = file.object.parts[1].surface;
    EXPECT_EQ(surface.base_color, V3d(0.5, 0.25, 1));
    EXPECT_EQ(surface.emissive, V3d(1, 2, 3));
    EXPECT_EQ(surface.metallic, 0.25);
    EXPECT_EQ(surface.roughness, 0.75);
}

TEST_F(ObjectFiles, GltfCamerasStandWhereTheirNodesDo) {
    const ObjectFile file =
        read("a.gltf", gltf(R"({"children":[1,2]},{"mesh":0},)"
                            R"({"camera":0,"name":"shot","translation":[1,2,3],)"
                            R"("rotation":[0,0.70710678118654752,0,0.70710678118654752]})",
                            R"(,"cameras":[{"type":"perspective","perspective":{"yfov":1}}])"));
    ASSERT_EQ(file.cameras.size(), 1u);
    const auto& [number, name, camera] = file.cameras[0];
    EXPECT_EQ(number, 0u);
    EXPECT_EQ(name, "shot");
    EXPECT_EQ(camera.eye, V3d(1, 2, 3));
    EXPECT_LT((camera.target - V3d(0, 2, 3)).length(), 1e-12); // -Z turned by 90 about Y: -X
    EXPECT_NEAR(camera.fov, 57.2957795, 1e-6);
}

// Under a parent that turns, stretches and mirrors: where it stands, looks and has its up go along,
// however its node comes to be there. Its number is the file's; those that are of no use have
// theirs.
TEST_F(ObjectFiles, GltfCamerasUnderOtherNodesKeepTheirNumbers) {
    const ObjectFile file =
        read("a.gltf",
             gltf(R"({"children":[1,2,3,4]},{"mesh":0},{"camera":3,"translation":[0,0,9]},)"
                  R"({"scale":[-1,1,2],"rotation":[0,0,0.70710678118654752,0.70710678118654752],)"
                  R"("translation":[10,0,0],"children":[5]},{"camera":0},)"
                  R"({"camera":1,"name":"nested","translation":[1,2,3]})",
                  R"(,"cameras":[{"type":"orthographic","name":"flat"},)"
                  R"({"type":"perspective","perspective":{"yfov":0.5}},)"
                  R"({"type":"perspective","perspective":{"yfov":0.25}},)"
                  R"({"type":"perspective","name":"last","perspective":{"yfov":1}}])"));
    ASSERT_EQ(file.cameras.size(), 2u);
    const auto& [number, name, camera] = file.cameras[0];
    EXPECT_EQ(number, 1u);
    EXPECT_EQ(name, "nested");
    // (1, 2, 3) is (-1, 2, 6) scaled, (-2, -1, 6) turned by 90 degrees about Z.
    EXPECT_LT((camera.eye - V3d(8, -1, 6)).length(), 1e-12);
    EXPECT_LT((camera.target - camera.eye - V3d(0, 0, -1)).length(), 1e-12);
    EXPECT_LT((camera.up.normalized() - V3d(-1, 0, 0)).length(), 1e-12);
    EXPECT_NEAR(camera.fov, 0.5 * 57.2957795, 1e-6);
    EXPECT_EQ(file.cameras[1].number, 3u);
    EXPECT_EQ(file.cameras[1].name, "last");
    ASSERT_EQ(file.notes.size(), 1u);
    EXPECT_NE(file.notes[0].find("flat is orthographic"), std::string::npos) << file.notes[0];
}

TEST_F(ObjectFiles, GltfRefusals) {
    const std::string plain = gltf(R"({"mesh":0})");
    EXPECT_EQ(refusal("a.gltf", plain), "");
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string text = plain;
        const std::size_t at = text.find(from);
        EXPECT_NE(at, text.npos) << from;
        return refusal("a.gltf", text.replace(at, from.size(), to));
    };
    EXPECT_NE(changed("\"2.0\"", "\"1.0\"").find("version"), std::string::npos);
    EXPECT_NE(changed("\"count\":3", "\"count\":4").find("bufferView"), std::string::npos);
    EXPECT_NE(changed("\"count\":3", "\"count\":1e15"), "");
    EXPECT_NE(changed("\"count\":3", "\"count\":-3"), "");
    EXPECT_NE(changed("\"count\":3", "\"count\":\"3\""), "");
    EXPECT_NE(changed("\"POSITION\":0", "\"POSITION\":7"), "");
    EXPECT_NE(changed("\"POSITION\":0", "\"POSITION\":-1"), "");
    EXPECT_NE(changed("\"mesh\":0", "\"mesh\":1"), "");
    EXPECT_NE(changed("\"buffer\":0,\"byteLength\":36", "\"buffer\":0,\"byteLength\":37"), "");
    EXPECT_NE(changed("\"material\":0", "\"material\":1"), "");
    EXPECT_NE(changed("base64", "base32"), "");
    EXPECT_NE(changed("5126", "5127"), "");
    EXPECT_NE(changed("VEC3", "VEC2"), "");
    EXPECT_NE(changed("\"mesh\":0", "\"children\":[0]").find("two places"), std::string::npos);
    EXPECT_NE(refusal("a.gltf", gltf(R"({"children":[1]},{"children":[0]})")), "");
    EXPECT_NE(refusal("a.gltf", gltf(R"({"mesh":0})", R"(,"extensionsRequired":["KHR_x"])"))
                  .find("KHR_x"),
              std::string::npos);
    EXPECT_NE(refusal("a.gltf", gltf("7")), "");
}

TEST_F(ObjectFiles, GltfCutAtAnyLengthIsRefused) {
    const std::string whole = gltf(R"({"mesh":0})");
    for (std::size_t length = 1; length < whole.size(); length += 3) {
        EXPECT_NE(refusal("cut.gltf", whole.substr(0, length)), "") << length;
    }
    std::string binary = "glTF";
    const std::string padded = whole + std::string((4 - whole.size() % 4) % 4, ' ');
    append(binary, std::uint32_t{2}, false);
    append(binary, static_cast<std::uint32_t>(20 + padded.size()), false);
    append(binary, static_cast<std::uint32_t>(padded.size()), false);
    binary += "JSON" + padded;
    EXPECT_EQ(refusal("whole.glb", binary), "");
    for (std::size_t length = 4; length < binary.size(); length += 3) {
        EXPECT_NE(refusal("cut.glb", binary.substr(0, length)), "") << length;
    }
}

TEST_F(ObjectFiles, ObjMaterialsArePartsWithTheirColours) {
    write("m.mtl", "newmtl red\nKd 1 0.5 0\nKe 2 0 0\nnewmtl blue\nKd 0 0 1\n");
    const std::string text = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0.25 0.75\n"
                             "usemtl blue\nf 1/1 2/1 3/1\nusemtl red\nf 1/1 3/1 4/1\n";
    const ObjectFile file = read("a.obj", text);
    ASSERT_EQ(file.object.parts.size(), 2u);
    EXPECT_EQ(file.object.parts[0].surface.base_color, V3d(1, 0.5, 0));
    EXPECT_EQ(file.object.parts[0].surface.emissive, V3d(2, 0, 0));
    EXPECT_EQ(file.object.parts[1].surface.base_color, V3d(0, 0, 1));
    EXPECT_EQ(file.object.parts[1].first, 3u);
    EXPECT_EQ(file.object.mesh->texcoords[0], V2f(0.25F, 0.25F));
    EXPECT_EQ(file.files.size(), 2u);

    std::filesystem::remove(folder_ + "/m.mtl");
    const ObjectFile without = read("a.obj", text);
    ASSERT_EQ(without.notes.size(), 1u);
    EXPECT_NE(without.notes[0].find("m.mtl"), std::string::npos);
    write("m.mtl", "newmtl red\nmap_Kd none.png\nnewmtl blue\n");
    EXPECT_NE(refusal("a.obj", text).find("none.png"), std::string::npos);
    EXPECT_NE(refusal("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/3 2/3 3/3\n"), "");
}

// d, Tr (1 - d) and map_d, whose alpha counts if it has one, otherwise its first channel.
TEST_F(ObjectFiles, ObjMaterialsDissolve) {
    OutputSet outputs;
    for (const int channels : {3, 4}) {
        Image image(1, 1, channels);
        const float values[] = {0.25F, 0.5F, 0.75F, 0.875F};
        std::copy_n(values, channels, image.at(0, 0));
        writeImage(outputs, folder_ + "/" + std::to_string(channels) + ".exr", image);
    }
    outputs.commit();
    write("m.mtl", "newmtl whole\nKd 1 1 1\nmap_Kd 4.exr\nnewmtl half\nd 0.5\n"
                   "newmtl most\nTr 0.25\nnewmtl first\nmap_d 3.exr\n"
                   "newmtl alpha\nd 0.75\nmap_Kd 4.exr\nmap_d 4.exr\n");
    std::string text = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n";
    for (const char* name : {"whole", "half", "most", "first", "alpha"})
        text += std::string("usemtl ") + name + "\nf 1/1 2/1 3/1\n";
    const ObjectFile file = read("a.obj", text);
    ASSERT_EQ(file.object.parts.size(), 5u);
    const double alphas[] = {1, 0.5, 0.75, 1, 0.75};
    for (std::size_t i = 0; i < 5; ++i) {
        const Surface& surface = file.object.parts[i].surface;
        EXPECT_EQ(surface.alpha, alphas[i]) << i;
        EXPECT_EQ(surface.alpha_cutoff, i == 0 ? 0 : kBlended) << i;
        EXPECT_EQ(surface.alpha_texture.has_value(), i > 2) << i;
    }
    const auto texel = [&](std::size_t part) {
        const Surface& surface = file.object.parts[part].surface;
        return file.object.textures.at(surface.alpha_texture.value()).image.at(0, 0)[0];
    };
    EXPECT_EQ(texel(3), 0.25F);
    EXPECT_EQ(texel(4), 0.875F);
    EXPECT_EQ(file.object.parts[0].surface.base_texture, file.object.parts[4].surface.base_texture);
    EXPECT_EQ(file.files.size(), 4u); // each once
    EXPECT_TRUE(file.notes.empty());
    write("m.mtl", "newmtl whole\nKd 1 1 1\nnewmtl half\nTr 1\n");
    const ObjectFile unseen =
        read("a.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl half\nf 1 2 3\n");
    ASSERT_EQ(unseen.notes.size(), 1u);
    EXPECT_NE(unseen.notes[0].find("material half is not seen"), std::string::npos);
}

} // namespace
} // namespace ibl
