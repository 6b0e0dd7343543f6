// A Lambertian surface of albedo base_color under a clear, smooth coat. What the coat does not mirror
// reaches the base; reflections between the two are not followed.
uniform float ior;

vec3 shade(vec3 normal, vec3 incident) {
    float mirrored = surfaceReflectance(clamp(-dot(normal, incident), 0.0, 1.0), ior);
    return mix(baseColor() * diffuseRadiance(normal), probeRadiance(reflect(incident, normal)),
               mirrored);
}
