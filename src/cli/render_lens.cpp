#include "cli/render_options.h"

#include "core/error.h"

#include <cmath>
#include <numbers>

namespace ibl {
namespace {

/// 1 / distance along the view of what each pixel's centre sees; the background is infinitely far.
Image inverseDistances(const FrameAovs& aovs, const CameraRays& rays,
                       const std::optional<Ground>& ground) {
    Image inverse(aovs.normal.width, aovs.normal.height, 1);
    for (int y = 0; y < inverse.height; ++y) {
        for (int x = 0; x < inverse.width; ++x) {
            float& value = *inverse.at(x, y);
            const float depth = aovs.depth[static_cast<std::size_t>(y) * inverse.width + x];
            value = depth < kNoDepth ? 1 / depth : 0;
            if (depth < kNoDepth || !ground) continue;
            // A ray's part along the view is 1.
            const double steps = rays.direction(x + 0.5, y + 0.5).y / (ground->height - rays.eye.y);
            if (steps > 0) value = static_cast<float>(steps);
        }
    }
    return inverse;
}

} // namespace

void bindLens(CLI::App& app, LensArguments& arguments, FrameRange& frames) {
    CLI::Option* aperture =
        addRamps(
            app, "--aperture", 1,
            [&arguments](const std::vector<Ramp>& v) { arguments.aperture = v[0]; },
            "Depth of field: diameter of the lens in scene units (default 0, all is sharp)",
            rampIn(0, 1e6), frames)
            ->type_name("D")
            ->group("Camera");
    addRamps(
        app, "--focus", 1, [&arguments](const std::vector<Ramp>& v) { arguments.focus = v[0]; },
        "Distance along the view of what is sharp (default that of the target)", rampIn(1e-6, 1e9),
        frames)
        ->needs(aperture)
        ->type_name("D")
        ->group("Camera");
}

void requireLens(const LensArguments& lens, const CameraArguments& camera) {
    const bool blurs = lens.aperture.from > 0 || lens.aperture.to > 0;
    if (lens.focus && !blurs) {
        throw Error(ExitCode::usage, "--focus has no effect with --aperture 0; leave it out");
    }
    if (blurs && !lens.focus && !camera.of_file.empty()) {
        throw Error(ExitCode::usage,
                    "--aperture: the file's camera has no target to be sharp; give --focus");
    }
}

void throughLens(const EglContext& context, const LensArguments& arguments, const FramePlace& place,
                 const Camera& camera, const FrameOptions& options,
                 const std::optional<Ground>& ground, const FrameAovs& aovs, int threads,
                 Image& picture) {
    const double focus =
        arguments.focus ? arguments.focus->at(place) : (camera.target - camera.eye).length();
    const CameraRays rays = cameraRays(camera, picture.width, picture.height);
    const double half_fov = camera.fov * std::numbers::pi / 360;
    defocus(context, picture, inverseDistances(aovs, rays, ground),
            {arguments.aperture.at(place), focus}, picture.height / (2 * std::tan(half_fov)),
            options.shader_folder, threads);
}

} // namespace ibl
