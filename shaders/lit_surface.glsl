// A material under lights: `brdf` of the material's file times what of each light arrives, and its base
// colour times the ambient light. surface_point and facet_normal are set ahead of shade().
uniform vec3 ambient;

vec3 shade(vec3 normal, vec3 incident) {
    vec3 radiance = first_batch ? base_color * ambient : vec3(0.0);
    for (int i = 0; i < light_count; ++i) {
        vec3 irradiance;
        float distance;
        vec3 l = towards(i, surface_point, irradiance, distance);
        float cosine = dot(normal, l);
        if (cosine <= 0.0) continue;
        float visible = visibilityOfObject(i, surface_point, facet_normal, l, distance);
        radiance += brdf(normal, l, -incident) * irradiance * (cosine * visible);
    }
    return radiance;
}
