// Schlick 1994, "An inexpensive BRDF model for physically-based rendering": rational approximations of
// Fresnel reflectance, S = f0 + (1 - f0)(1 - l.h)^5, of the distribution of facets,
// Z = r / (1 + (r - 1)(n.h)^2)^2, whose integral over (n.h) dh is pi, and of their shadowing,
// G(c) = c / (k + (1 - k) c), k = sqrt(2 r / pi); S Z G(n.l) G(n.v) / (4 pi (n.l)(n.v)), and what S leaves
// reaches the base. His k = r, where roughness stands for both, returns up to 1.5 times what arrives at
// grazing angles; this k is that of his approximation of Smith's shadowing for slopes of the variance r.
uniform vec3 f0;
uniform float facet_roughness;

vec3 brdf(vec3 n, vec3 l, vec3 v) {
    const float pi = 3.14159265358979;
    vec3 h = normalize(l + v);
    float nl = dot(n, l), nv = max(dot(n, v), 0.0), r = facet_roughness;
    float nh = clamp(dot(n, h), 0.0, 1.0), t = 1.0 + (r - 1.0) * nh * nh;
    vec3 fresnel = f0 + (1.0 - f0) * pow(1.0 - clamp(dot(l, h), 0.0, 1.0), 5.0);
    float k = sqrt(2.0 * r / pi);
    float facets = r / (t * t) / ((k + (1.0 - k) * nl) * (k + (1.0 - k) * nv));
    return (1.0 - fresnel) * albedo / pi + fresnel * (facets / (4.0 * pi));
}
