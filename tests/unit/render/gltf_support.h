// What the tests of glTF 2.0 share: a square, written as a document with a buffer.
#pragma once

#include "render/object_file.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace ibl {

template <class T>
std::string packed(const std::vector<T>& values) {
    std::string bytes(values.size() * sizeof(T), '\0');
    std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

// The square from (-1, -1, 0) to (1, 1, 0), seen from +Z, corners counter-clockwise from the lower
// left one: in its buffer 48 bytes of positions, 48 of normals, 32 of texture coordinates, 12 of
// indices, then `extra`.
struct Square {
    std::string material = "{}";
    std::string more{}; ///< members of the document
    std::vector<float> texcoords{0, 1, 1, 1, 1, 0, 0, 0};
    std::string extra{}, views{};
    std::string positions = R"("bufferView":0)", indices = R"("bufferView":3)";
    std::string nodes = R"({"mesh":0})";
};
inline constexpr int kExtraAt = 140;

class Gltf : public testing::Test {
protected:
    Gltf()
        : folder_(testing::TempDir() + "ibl_gltf_" +
                  testing::UnitTest::GetInstance()->current_test_info()->name()) {
        std::filesystem::create_directories(folder_);
    }
    ~Gltf() override { std::filesystem::remove_all(folder_); }

    void write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_ + "/" + name, std::ios::binary) << bytes;
    }
    ObjectFile read(const Square& square) const {
        const std::string buffer = packed<float>({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}) +
                                   packed<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}) +
                                   packed(square.texcoords) +
                                   packed<std::uint16_t>({0, 1, 2, 0, 2, 3}) + square.extra;
        write("square.bin", buffer);
        write("a.gltf", R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[)" +
                            square.nodes +
                            R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,)"
                            R"("TEXCOORD_0":2},"indices":3,"material":0}]}],"materials":[)" +
                            square.material + R"(],"accessors":[{"componentType":5126,"count":4,)" +
                            R"("type":"VEC3",)" + square.positions +
                            R"(},{"componentType":5126,"count":4,"type":"VEC3","bufferView":1},)"
                            R"({"componentType":5126,"count":4,"type":"VEC2","bufferView":2},)"
                            R"({"componentType":5123,"count":6,"type":"SCALAR",)" +
                            square.indices +
                            R"(}],"bufferViews":[{"buffer":0,"byteLength":48},)"
                            R"({"buffer":0,"byteOffset":48,"byteLength":48},)"
                            R"({"buffer":0,"byteOffset":96,"byteLength":32},)"
                            R"({"buffer":0,"byteOffset":128,"byteLength":12})" +
                            square.views + R"(],"buffers":[{"uri":"square.bin","byteLength":)" +
                            std::to_string(buffer.size()) + "}]" + square.more + "}");
        return readObject(folder_ + "/a.gltf");
    }

    const std::string folder_;
};

} // namespace ibl
