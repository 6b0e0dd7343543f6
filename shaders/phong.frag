// Phong 1975 in the reciprocal, normalised form of Lafortune and Willems 1994:
// ks (n + 2) / (2 pi) max(r.v, 0)^n, r the mirrored light. The lobe's integral over cosine-weighted
// directions is ks at normal incidence and less elsewhere, where the surface cuts it off.
uniform vec3 specular_color;
uniform float reflectivity;
uniform float exponent;

vec3 brdf(vec3 n, vec3 l, vec3 v) {
    const float pi = 3.14159265358979;
    float c = max(dot(reflect(-l, n), v), 0.0);
    vec3 gloss = specular_color * ((exponent + 2.0) / (2.0 * pi) * pow(c, exponent));
    return mix(albedo / pi, gloss, reflectivity);
}
