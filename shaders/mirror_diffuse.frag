// A Lambertian surface of albedo base_color that mirrors the part `reflectivity` of the light.
uniform float reflectivity;

vec3 shade(vec3 normal, vec3 incident) {
    vec3 matte = baseColor() * diffuseRadiance(normal);
    return mix(matte, probeRadiance(reflect(incident, normal)), reflectivity);
}
