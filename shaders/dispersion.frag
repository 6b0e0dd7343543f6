// Glass whose index of refraction is another for each channel.
uniform vec3 ior_rgb;

vec3 shade(vec3 normal, vec3 incident) {
    vec3 reflected = probeRadiance(reflect(incident, normal));
    vec3 result;
    for (int c = 0; c < 3; ++c) {
        float mirrored = firstReflectance(normal, incident, ior_rgb[c]);
        float through = baseColor()[c] * radianceThrough(normal, incident, ior_rgb[c], mirrored)[c];
        result[c] = mix(through, reflected[c], mirrored);
    }
    return result;
}
