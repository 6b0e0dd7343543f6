// The lobe's integrals by split sum (Karis 2013): the mean radiance about the reflected ray times
// what the lobe reflects of a constant. `albedo` is (bias, total) of a constant 1, `bias` and
// `total` are the same of the probe.
void ggxIntegrals(vec3 normal, vec3 incident, float roughness, out vec2 albedo, out vec3 bias,
                  out vec3 total) {
    albedo = splitSum(clamp(-dot(normal, incident), 0.0, 1.0), roughness);
    vec3 mean = specularRadiance(reflect(incident, normal), roughness);
    bias = albedo.x * mean;
    total = albedo.y * mean;
}
