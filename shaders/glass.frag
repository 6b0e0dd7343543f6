// Clear glass, tinted by base_color where light goes through. What enters leaves: 1 - F of the first
// face goes through, at once or after reflections inside.
uniform float ior;

vec3 shade(vec3 normal, vec3 incident) {
    float mirrored = firstReflectance(normal, incident, ior);
    vec3 through = baseColor() * radianceThrough(normal, incident, ior, mirrored);
    return mix(through, probeRadiance(reflect(incident, normal)), mirrored);
}
