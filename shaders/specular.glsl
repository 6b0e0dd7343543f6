// Prefiltered radiance and the split-sum table.
layout(binding = 16) uniform samplerCube specular_levels;
layout(binding = 17) uniform sampler2D split_sum;
uniform vec2 specular_scale; // level = (roughness - x) y

// The mean of what arrives about a direction, weighted by GGX's lobe of that roughness with normal
// and eye in its axis.
vec3 specularRadiance(vec3 direction, float roughness) {
    return textureLod(specular_levels, probe_from_world * direction,
                      (roughness - specular_scale.x) * specular_scale.y)
        .rgb;
}

// What GGX reflects of a constant 1: x of Schlick's (1 - v.h)^5 alone, y without Fresnel.
vec2 splitSum(float n_dot_v, float roughness) {
    return textureLod(split_sum, vec2(n_dot_v, roughness), 0.0).xy;
}
