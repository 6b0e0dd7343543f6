// A lit material at a vertex, where the surface's own normal stands for the facets around it. Ambient
// light and emission are of the first batch.
uniform vec3 ambient;

vec3 shade(vec3 normal, vec3 incident) {
    albedo = baseColor();
    vec3 radiance = litRadiance(surface_point, normal, normal, -incident);
    if (first_batch) {
        radiance += albedo * ambient;
    } else {
        surface_emission = vec3(0.0);
    }
    return radiance;
}
