#include "core/error.h"
#include "render/object_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

namespace ibl {
namespace {

class Obj : public testing::Test {
protected:
    Obj()
        : folder_(testing::TempDir() + "ibl_obj_" +
                  testing::UnitTest::GetInstance()->current_test_info()->name()) {
        std::filesystem::create_directories(folder_);
    }
    ~Obj() override { std::filesystem::remove_all(folder_); }

    std::string write(const std::string& text) const {
        const std::string path = folder_ + "/object.obj";
        std::ofstream(path) << text;
        return path;
    }
    Mesh load(const std::string& text) const { return *readObject(write(text)).object.mesh; }

    // The message, or nothing when the file was taken.
    std::string refusal(const std::string& path) const {
        try {
            readObject(path);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::input);
            EXPECT_EQ(std::string(error.what()).rfind(path + ": ", 0), 0u) << error.what();
            return error.what();
        }
        return "";
    }
    std::string refusalOf(const std::string& text) const { return refusal(write(text)); }

    std::string folder_;
};

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(Obj, PolygonsBecomeTrianglesAndGetNormals) {
    const Mesh mesh = load(kSquare + "f 1 2 3 4\n");
    EXPECT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.indices.size(), 6u);
    for (const V3f& n : mesh.normals)
        EXPECT_LT((n - V3f(0, 0, 1)).length(), 1e-6f);
}

TEST_F(Obj, GivenNormalsAreKeptAndNormalised) {
    const Mesh mesh = load(kSquare + "vn 3 0 4\nf 1//1 2//1 3//1\n");
    ASSERT_EQ(mesh.normals.size(), 3u);
    EXPECT_LT((mesh.normals[0] - V3f(0.6f, 0, 0.8f)).length(), 1e-6f);
}

TEST_F(Obj, TrianglesAgainstTheirNormalsAreTurned) {
    const Mesh mesh = load(kSquare + "vn 0 0 1\nf 1//1 3//1 2//1\n");
    const V3f a = mesh.positions[mesh.indices[0]], b = mesh.positions[mesh.indices[1]],
              c = mesh.positions[mesh.indices[2]];
    EXPECT_GT((b - a).cross(c - a).z, 0);
}

TEST_F(Obj, NegativeIndicesCountFromTheEnd) {
    EXPECT_EQ(load(kSquare + "f -4 -3 -2\n").positions[1], V3f(1, 0, 0));
}

TEST_F(Obj, NormalsOfACornerDoNotDependOnHowFacesAreCut) {
    // Three unit squares about the origin; each is cut along some diagonal. The normal at the
    // shared corner is the diagonal of space, which the mean over triangles would miss.
    const Mesh mesh = load("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 0\nv 0 1 1\nv 1 0 1\n"
                           "f 1 2 5\nf 1 5 3\nf 1 3 6\nf 1 6 4\nf 1 4 7 2\n");
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        if (mesh.positions[i] == V3f(0)) {
            EXPECT_LT((mesh.normals[i] - V3f(1 / std::sqrt(3.f))).length(), 1e-5f);
        }
    }
}

TEST_F(Obj, FacesBackToBackStillHaveNormals) {
    for (const V3f& n : load(kSquare + "f 1 2 3\nf 3 2 1\n").normals) {
        EXPECT_NEAR(n.length(), 1, 1e-6);
    }
}

TEST_F(Obj, TrianglesWithoutAreaAreDropped) {
    EXPECT_EQ(load(kSquare + "f 1 2 3\nf 1 1 2\n").indices.size(), 3u);
}

TEST_F(Obj, MaterialsThatAreNotThereDoNotMatter) {
    EXPECT_EQ(load("mtllib none.mtl\n" + kSquare + "usemtl red\nf 1 2 3\n").indices.size(), 3u);
}

TEST_F(Obj, Refusals) {
    EXPECT_NE(refusal(folder_), "");               // a directory
    EXPECT_NE(refusal(folder_ + "/none.obj"), ""); // missing
    EXPECT_NE(refusalOf(""), "");
    EXPECT_NE(refusalOf("# nothing\n"), "");
    EXPECT_NE(refusalOf(kSquare), "");                   // no face
    EXPECT_NE(refusalOf(kSquare + "f 1 1 1\n"), "");     // no area
    EXPECT_NE(refusalOf(kSquare + "f 1 2 9\n"), "");     // triangle beyond the vertices
    EXPECT_NE(refusalOf(kSquare + "f 1 2 3 9\n"), "");   // quad
    EXPECT_NE(refusalOf(kSquare + "f 1 2 3 4 9\n"), ""); // polygon
    EXPECT_NE(refusalOf(kSquare + "f -9 2 3\n"), "");
    EXPECT_NE(refusalOf(kSquare + "f 0 1 2\n"), "");
    EXPECT_NE(refusalOf(kSquare + "f 1//5 2//5 3//5\n"), ""); // no such normal
    EXPECT_NE(refusalOf("v 0 0 0\nv 1e39 0 0\nv 0 1 0\nf 1 2 3\n"), "");
    EXPECT_NE(refusalOf("v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n"), "");
    for (const char* word : {"abc", "zz", "-", "1e999", "inf", "1.5.2", "0x10"}) {
        const std::string text = "v 0 0 0\nv 1 0 " + std::string(word) + "\nv 0 1 0\nf 1 2 3\n";
        EXPECT_NE(refusalOf(text).find(": line 2: v has a word"), std::string::npos) << word;
    }
    EXPECT_NE(refusalOf("v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n"), "");
    EXPECT_NE(refusalOf(kSquare + "vn 0 0 x\nf 1//1 2//1 3//1\n"), "");
    EXPECT_NE(refusalOf(kSquare + "vt zz 0\nf 1/1 2/1 3/1\n"), "");
    EXPECT_EQ(load("v +0 0. .0 1 1 1\t# corner\r\nv\t1e0 0 0\nv 0 1 0\nf 1 2 3\n").indices.size(),
              3u);
    std::string bytes;
    for (int i = 0; i < 5000; ++i)
        bytes += static_cast<char>(i * 7919 >> 3);
    EXPECT_NE(refusalOf(bytes), "");
    EXPECT_NE(refusalOf("\x7f"
                        "ELF" +
                        bytes),
              "");
}

} // namespace
} // namespace ibl
