// What glTF 2.0 says of node transforms and sparse accessors, on a square.
#include "gltf_support.h"

#include "core/error.h"

#include <cmath>

namespace ibl {
namespace {

// A child turned by 45 degrees about Z under a stretched, mirrored parent: sheared. Its turn about
// X comes first, so that the normal is sheared, too.
TEST_F(Gltf, NormalsStaySquareToShearedAndMirroredFaces) {
    Square square;
    square.nodes = R"({"scale":[1,2,-3],"translation":[0,0,7],"children":[1]},)"
                   R"({"rotation":[0,0,0.38268343236508977,0.92387953251128674],"children":[2]},)"
                   R"({"rotation":[0.38268343236508977,0,0,0.92387953251128674],"mesh":0})";
    const ObjectFile file = read(square);
    const Mesh& mesh = *file.object.mesh;
    // About X: x to (1, 0, 0), y to (0, s, s), z to (0, -s, s). About Z: these to (s, s, 0),
    // (-1/2, 1/2, s), (1/2, -1/2, s). By the parent (s, 2 s, 0), (-1/2, 1, -3 s); the normal goes
    // by the inverse, to (1/2, -1/4, -s/3).
    const double s = std::sqrt(0.5);
    const V3d x(s, 2 * s, 0), y(-0.5, 1, -3 * s), shift(0, 0, 7);
    const V3d normal = V3d(0.5, -0.25, -s / 3).normalized();
    EXPECT_NEAR(normal.dot(x), 0, 1e-12);
    EXPECT_NEAR(normal.dot(y), 0, 1e-12);
    ASSERT_EQ(mesh.positions.size(), 4u);
    EXPECT_LT((V3d(mesh.positions[0]) - (shift - x - y)).length(), 1e-6);
    EXPECT_LT((V3d(mesh.positions[1]) - (shift + x - y)).length(), 1e-6);
    for (const V3f& n : mesh.normals)
        EXPECT_LT((V3d(n) - normal).length(), 1e-6) << n;
    ASSERT_EQ(mesh.indices.size(), 6u);
    for (std::size_t i = 0; i < 6; i += 3) { // counter-clockwise, seen from outside
        const V3f& a = mesh.positions[mesh.indices[i]];
        const V3f &b = mesh.positions[mesh.indices[i + 1]],
                  &c = mesh.positions[mesh.indices[i + 2]];
        EXPECT_LT((V3d((b - a).cross(c - a)).normalized() - normal).length(), 1e-6) << i;
    }
}

TEST_F(Gltf, SparsePositionsReplaceWhatThereIsOrZeros) {
    const auto sparse = [](const char* base, int count) {
        return std::string(base) + R"("sparse":{"count":)" + std::to_string(count) +
               R"(,"indices":{"bufferView":4,"componentType":5123},"values":{"bufferView":5}})";
    };
    Square square;
    square.extra =
        packed<std::uint16_t>({1, 2, 3, 0}) + packed<float>({2, -1, 0, 1, 3, 0, -1, 1, 0.5F});
    square.views = R"(,{"buffer":0,"byteOffset":140,"byteLength":8})"
                   R"(,{"buffer":0,"byteOffset":148,"byteLength":36})";
    const V3f one(2, -1, 0), two(1, 3, 0), three(-1, 1, 0.5F);
    square.positions = sparse("", 3);
    EXPECT_EQ(read(square).object.mesh->positions, (std::vector{V3f(0), one, two, three}));
    square.positions = sparse(R"("bufferView":0,)", 2);
    EXPECT_EQ(read(square).object.mesh->positions,
              (std::vector{V3f(-1, -1, 0), one, two, V3f(-1, 1, 0)}));
    square.positions = R"("byteOffset":0)"; // neither a view nor sparse
    EXPECT_THROW(read(square), Error);
}

TEST_F(Gltf, SparseIndicesReplaceCorners) {
    const auto drawn = [&](int code, const std::string& place) {
        Square square;
        square.extra = place + packed<std::uint16_t>({1});
        const std::string size = std::to_string(place.size());
        square.views = R"(,{"buffer":0,"byteOffset":140,"byteLength":)" + size +
                       R"(},{"buffer":0,"byteOffset":)" + std::to_string(140 + place.size()) +
                       R"(,"byteLength":2})";
        square.indices = R"("bufferView":3,"sparse":{"count":1,"indices":{"bufferView":4,)"
                         R"("componentType":)" +
                         std::to_string(code) + R"(},"values":{"bufferView":5}})";
        return read(square).object.mesh->indices;
    };
    const std::vector<std::uint32_t> expected{0, 1, 2, 0, 1, 3};
    EXPECT_EQ(drawn(5121, packed<std::uint8_t>({4})), expected);
    EXPECT_EQ(drawn(5123, packed<std::uint16_t>({4})), expected);
    EXPECT_EQ(drawn(5125, packed<std::uint32_t>({4})), expected);
    EXPECT_THROW(drawn(5123, packed<std::uint16_t>({6})), Error); // no such place
}

} // namespace
} // namespace ibl
