// Clear glass, tinted by base_color where light goes through. What enters leaves: 1 - F of the first
// face goes through, and what the second face would mirror leaves with it.
uniform float ior;

vec3 shade(vec3 normal, vec3 incident) {
    float mirrored = firstReflectance(normal, incident, ior);
    vec3 through = baseColor() * probeRadiance(throughObject(normal, incident, ior));
    return mix(through, probeRadiance(reflect(incident, normal)), mirrored);
}
