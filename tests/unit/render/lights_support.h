// What the tests of lights and of their shadows share.
#pragma once

#include "scene_support.h"

#include <utility>
#include <vector>

namespace ibl {

inline SceneLight sunlight(const V3d& towards, const V3d& irradiance) {
    return {LightType::directional, towards.normalized(), irradiance, V3d(0), 0, 0};
}

inline SceneLight lamp(const V3d& position, const V3d& intensity) {
    return {LightType::point, V3d(0, 0, 1), intensity, position, 0, 0};
}

inline Scene litScene(std::vector<SceneLight> lights, std::optional<Mesh> mesh = std::nullopt) {
    Scene scene;
    scene.material.shader = Shader::lambert;
    scene.object.mesh = std::move(mesh);
    scene.background = ColorBackground(0, 0, 0);
    scene.lights = std::move(lights);
    return scene;
}

inline Image draw(const Scene& scene, const Camera& camera, int size, int samples, int map = 0) {
    return Renderer(softwareContext(), scene, {size, size, samples, {}, map}).render(camera);
}

} // namespace ibl
