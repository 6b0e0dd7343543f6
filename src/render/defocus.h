// Depth of field of a thin lens, from a picture and its depth.
#pragma once

#include "image/image.h"
#include "render/egl_context.h"

#include <filesystem>
#include <optional>

namespace ibl {

/// Lengths in scene units.
struct Lens {
    double aperture = 0; ///< diameter; 0 is a pinhole, all sharp
    double focus = 1;    ///< distance along the view of what is sharp, above 0
};

/// Radius in pixels of the circle of confusion of what lies at 1 / `inverse_distance` along the
/// view (0: infinitely far): the lens's disc seen through the point, on the plane in focus,
/// aperture / 2 |1 / focus - 1 / distance| as a tangent (Potmesil and Chakravarty 1982).
/// `pixels_per_tangent` is height / (2 tan(fov / 2)).
double blurRadius(const Lens& lens, double inverse_distance, double pixels_per_tangent);

/// Most pixels that a circle's radius may have; a pixel's cost grows with its square.
constexpr int kMostBlur = 256;

/// Blurs a scene-linear picture (3 or 4 channels, premultiplied) in its place. `inverse_distance`
/// is of its size and has one channel. Light is kept: of a picture at one distance the sum stays,
/// and a uniform picture stays as it is at whatever distances. At the picture's border it is taken
/// as its own mirror image. Circles are rounded to 1/16 of a pixel.
///
/// Throws Error (usage) for lenses that are not sound, circles beyond kMostBlur, and pictures
/// larger than the device's textures.
void defocus(const EglContext& context, Image& picture, const Image& inverse_distance,
             const Lens& lens, double pixels_per_tangent,
             const std::optional<std::filesystem::path>& shader_folder = std::nullopt,
             int threads = 0);

} // namespace ibl
