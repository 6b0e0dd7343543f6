// Cook and Torrance 1982: facets with Beckmann's distribution of slopes (rms slope m), the shadowing of
// V-grooves (Blinn 1977), and the dielectric Fresnel reflectance of the index that has the reflectance f0
// at normal incidence, a channel at a time. F D G / (4 (n.l)(n.v)) with D normalised to
// int D (n.h) dh = 1; their paper has 1/pi for 1/4 with D without its 1/pi, four times as much.
uniform vec3 f0;
uniform float reflectivity;
uniform float slope;

vec3 fresnelOfDielectric(float c) {
    vec3 root = min(sqrt(f0), 0.9999);
    vec3 n = (1.0 + root) / (1.0 - root), g = sqrt(n * n + (c * c - 1.0));
    vec3 a = (g - c) / (g + c), b = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * a * a * (1.0 + b * b);
}

vec3 brdf(vec3 n, vec3 l, vec3 v) {
    const float pi = 3.14159265358979;
    vec3 h = normalize(l + v);
    float nl = max(dot(n, l), 1e-4), nv = max(dot(n, v), 1e-4);
    float nh = clamp(dot(n, h), 1e-3, 1.0), vh = max(dot(v, h), 1e-4);
    float c2 = nh * nh, m2 = slope * slope;
    float distribution = exp((c2 - 1.0) / (c2 * m2)) / (pi * m2 * c2 * c2);
    float shadowing = min(1.0, 2.0 * nh * min(nl, nv) / vh);
    vec3 gloss = fresnelOfDielectric(vh) * (distribution * shadowing / (4.0 * nl * nv));
    return mix(albedo / pi, gloss, reflectivity);
}
