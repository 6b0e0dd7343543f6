// A directional light, and what a set of them says of itself.
#pragma once

#include "panorama/conventions.h"

#include <optional>
#include <string>
#include <vector>

namespace ibl {

/// Luminance weights of the lights (Debevec 2005, ITU-R BT.709 rounded as he gives them).
constexpr double kLuminanceRed = 0.2125;
constexpr double kLuminanceGreen = 0.7154;
constexpr double kLuminanceBlue = 0.0721;

inline double luminanceOf(const V3d& rgb) {
    return kLuminanceRed * rgb.x + kLuminanceGreen * rgb.y + kLuminanceBlue * rgb.z;
}

/// A pixel's luminance as the cuts weigh it: negative ones count as 0.
inline double litLuminance(const float* rgb) {
    const double y = kLuminanceRed * rgb[0] + kLuminanceGreen * rgb[1] + kLuminanceBlue * rgb[2];
    return y > 0 ? y : 0.0;
}

/// A rectangle of directions. Degrees; each pair ascends.
struct AngularRegion {
    double longitude[2]{}; ///< atan2(x, z), from in [-180, 180), to may pass 180 across the seam
    double latitude[2]{};  ///< asin(y)
};

/// One light: all the radiance of a set of directions, gathered into one direction.
struct Light {
    V3d direction{0, 0, 1}; ///< unit, from the object towards the light
    V3d irradiance{0};      ///< RGB: radiance times solid angle summed over the set, i.e. the
                            ///< irradiance on a surface that faces the light
    double solid_angle = 0; ///< of the set, steradians
    double radius = 0;      ///< of a cut: root mean square distance, on the unit sphere, of its
                            ///< luminance from its centroid
    int id = 0;             ///< the same for the same light from frame to frame
    std::optional<AngularRegion> region;  ///< of a cut
    std::optional<double> angular_radius; ///< of a lamp, radians
};

/// How lights compare with those of the frame before.
struct FrameChange {
    double light_change = 0; ///< sum of |E - E_before| over luminance of all, relative to their sum
    double movement = 0;     ///< mean angle, weighted by luminance, of lights that kept their id
    int kept = 0;            ///< lights that kept their id
    bool same_regions = false;
};

struct LightSet {
    std::vector<Light> lights;
    std::string source; ///< the probe
    std::string method; ///< "median", "variance", "importance" or "sun"
    /// Relative RMSE over all normals and channels of the lights' irradiance; 0 for a black probe.
    double irradiance_error = 0;
    std::optional<FrameChange> change; ///< where a previous frame was given
};

/// The lights' colours summed: the probe's radiance times solid angle over all directions.
inline V3d totalIrradiance(const std::vector<Light>& lights) {
    V3d sum(0);
    for (const Light& light : lights)
        sum += light.irradiance;
    return sum;
}

/// The light's part of the luminance of all, given their sum; 0 where that is not positive.
inline double energyShare(const Light& light, const V3d& total) {
    const double all = luminanceOf(total);
    return all > 0 ? luminanceOf(light.irradiance) / all : 0.0;
}

} // namespace ibl
