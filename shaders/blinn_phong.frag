// Blinn 1977: ks N (n.h)^n, h halfway between light and eye. N = (n + 2)(n + 4) / (8 pi (2^(-n/2) + n)) makes
// the integral over cosine-weighted directions ks at normal incidence, where it is largest: there n.h is
// cos(t/2), and 2 pi int cos^n(t/2) cos t sin t dt from 0 to pi/2 is 1/N.
uniform vec3 specular_color;
uniform float reflectivity;
uniform float exponent;

vec3 brdf(vec3 n, vec3 l, vec3 v) {
    const float pi = 3.14159265358979;
    float c = max(dot(n, normalize(l + v)), 0.0);
    float norm = (exponent + 2.0) * (exponent + 4.0) / (8.0 * pi * (exp2(-0.5 * exponent) + exponent));
    vec3 gloss = specular_color * (norm * pow(c, exponent));
    return mix(albedo / pi, gloss, reflectivity);
}
