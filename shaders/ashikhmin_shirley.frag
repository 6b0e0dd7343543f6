// Ashikhmin and Shirley 2000, "An anisotropic Phong BRDF model": their equations 4 and 5, with Schlick's
// Fresnel term on f0. The base layer gets what the coat lets through, so that it needs no reflectivity.
uniform vec3 f0;
uniform float exponent_u;
uniform float exponent_v;

vec3 brdf(vec3 n, vec3 l, vec3 v) {
    const float pi = 3.14159265358979;
    vec3 along_u, along_v;
    tangents(n, along_u, along_v);
    vec3 h = normalize(l + v);
    float nl = dot(n, l), nv = max(dot(n, v), 0.0), hl = clamp(dot(h, l), 1e-4, 1.0);
    float hu = dot(h, along_u), hv = dot(h, along_v), hn = clamp(dot(h, n), 0.0, 1.0);
    float power = (exponent_u * hu * hu + exponent_v * hv * hv) / max(hu * hu + hv * hv, 1e-12);
    float lobe = sqrt((exponent_u + 1.0) * (exponent_v + 1.0)) / (8.0 * pi) * pow(hn, power) /
                 (hl * max(max(nl, nv), 1e-4));
    vec3 gloss = (f0 + (1.0 - f0) * pow(1.0 - hl, 5.0)) * lobe;
    vec3 matte = 28.0 / (23.0 * pi) * albedo * (1.0 - f0) * (1.0 - pow(1.0 - 0.5 * nl, 5.0)) *
                 (1.0 - pow(1.0 - 0.5 * nv, 5.0));
    return matte + gloss;
}
