// In a material's place: the normal as the colour, and depth and part beside it.
layout(location = 1) out vec2 depth_and_id;

vec3 shade(vec3 normal, vec3 incident) {
    surface_emission = vec3(0.0);
    depth_and_id = vec2(surface_depth, part_id);
    return normal;
}
