// Metal or dielectric with a surface of microfacets (GGX, Walter et al. 2007; Fresnel by Schlick
// 1994), a dielectric's over a Lambertian base that gets the light which the surface lets through.
uniform float roughness;
uniform float metallic;
uniform float ior;

vec3 shade(vec3 normal, vec3 incident) {
    vec2 albedo;
    vec3 bias, total;
    ggxIntegrals(normal, incident, roughness * surface_roughness, albedo, bias, total);
    // What microfacets without Fresnel lose is F0 of that less with each further bounce: all of it
    // comes back at F0 = 1 (Turquin 2019).
    float lost = MULTISCATTER ? 1.0 / max(albedo.y, 1e-4) - 1.0 : 0.0;

    // F = F0 + (F90 - F0) (1 - v.h)^5, F90 = 1 but where there is next to no surface.
    float f0 = (ior - 1.0) * (ior - 1.0) / ((ior + 1.0) * (ior + 1.0)), f90 = min(50.0 * f0, 1.0);
    float more = 1.0 + f0 * lost;
    vec3 coat = (f0 * (total - bias) + f90 * bias) * more;
    float mirrored = (f0 * (albedo.y - albedo.x) + f90 * albedo.x) * more;
    vec3 tint = baseColor();
    float metal_part = metallic * surface_metallic;
    vec3 metal = (tint * (total - bias) + bias) * (1.0 + tint * lost);
    vec3 base = metal_part < 1.0 ? tint * (1.0 - mirrored) * diffuseRadiance(normal) : vec3(0.0);
    return mix(coat + base, metal, metal_part);
}
