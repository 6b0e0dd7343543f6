// What a point sends to the eye of the lights in use: `brdf` of the material's file times what of each
// arrives. v is towards the eye, `facet` the normal of the surface that casts shadows there.
vec3 litRadiance(vec3 p, vec3 normal, vec3 facet, vec3 v) {
    vec3 radiance = vec3(0.0);
    for (int i = 0; i < light_count; ++i) {
        vec3 irradiance;
        float distance;
        vec3 l = towards(lights[i], p, irradiance, distance);
        float cosine = dot(normal, l);
        if (cosine <= 0.0) continue;
        float visible = visibilityOfObject(i, p, facet, l, distance);
        radiance += brdf(normal, l, v) * irradiance * (cosine * visible);
    }
    return radiance;
}
