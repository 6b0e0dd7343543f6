// Frames as `ibltool render --frames` draws them, drawn and read back as floats and then dropped:
// neither the display chain, nor encoding, nor a file. tests/bench/render/sequence runs it beside
// the tool.
#include "convolve/prefilter.h"
#include "convolve/split_sum.h"
#include "core/heap.h"
#include "image/read.h"
#include "render/renderer.h"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

namespace ibl {
namespace {

constexpr double kRoughness = 0.3;
constexpr int kLobeEdge = 128; // what render takes for that roughness

/// A teapot of polished metal under a lat-long, once around it.
void drawFrames(const char* probe_name, int frames, const FrameOptions& options) {
    const EglContext context;
    const Panorama probe{Layout::latlong, readImage(probe_name).image};
    const PrefilterRequest request{{Kernel::ggx, kRoughness}, Layout::faces, kLobeEdge};
    std::vector<PrefilterResult> lobe = prefilter(probe, {&request, 1}, {});
    SpecularMaps specular{{}, kRoughness, kRoughness};
    specular.levels.push_back(std::move(lobe[0].map));
    const Image table = splitSumTable({128, true, false, 0, kRoughness, {}}).image;
    Scene scene;
    scene.probe = &probe;
    scene.specular = &specular;
    scene.split_sum = &table;
    scene.object = *builtinObject("teapot");
    scene.material = Material(Shader::ggx);
    scene.material[Parameter::roughness] = V3d(kRoughness);
    scene.material[Parameter::metallic] = V3d(1);
    Renderer renderer(context, scene, options);
    for (int i = 0; i < frames; ++i)
        renderer.render(orbitCamera(360.0 * i / frames, 0, 4, V3d(0), 40));
}

} // namespace
} // namespace ibl

int main(int argc, char** argv) {
    if (argc != 4) {
        std::fprintf(stderr, "rasteriser_bench PROBE FRAMES SAMPLES\n");
        return 1;
    }
    ibl::keepHeap(); // as the tool does
    try {
        ibl::drawFrames(argv[1], std::atoi(argv[2]), {1920, 1080, std::atoi(argv[3]), {}, 0});
    } catch (const std::exception& problem) {
        std::fprintf(stderr, "rasteriser_bench: %s\n", problem.what());
        return 1;
    }
    return 0;
}
