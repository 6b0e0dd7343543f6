// The same integrals of the lobe as it is seen from the eye, by SPECULAR_SAMPLES samples. Half
// vectors are those visible from the eye (Heitz 2018), from the same points everywhere; each
// stands for a solid angle, over which the probe's levels hold the mean (Krivanek and Colbert 2008).
layout(binding = 18) uniform samplerCube probe_levels;

// Smith's Lambda of GGX for a direction at the cosine c from the normal.
float ggxLambda(float c, float alpha) {
    float tangent_2 = (1.0 - c * c) / (c * c);
    return 0.5 * (sqrt(1.0 + alpha * alpha * tangent_2) - 1.0);
}

// The mean radiance over about that solid angle. A texel of an N x N face covers (2/N)^2 m^3, m the
// direction's largest component; a level's texel has four times the solid angle of the one above.
vec3 meanRadiance(vec3 direction, float solid_angle) {
    direction = probe_from_world * direction;
    vec3 a = abs(direction);
    float m = max(a.x, max(a.y, a.z)), edge = float(textureSize(probe_levels, 0).x);
    float level = 0.5 * log2(solid_angle * edge * edge / (4.0 * m * m * m));
    return textureLod(probe_levels, direction, max(level, 0.0)).rgb;
}

void ggxIntegrals(vec3 normal, vec3 incident, float roughness, out vec2 albedo, out vec3 bias,
                  out vec3 total) {
    const float pi = 3.14159265358979;
    // Narrower than any probe shows. The view stays above the surface, as an interpolated normal may not.
    float alpha = max(roughness * roughness, 1e-5), n_dot_v = clamp(-dot(normal, incident), 1e-4, 1.0);
    // The view lies in the plane of x and z. Where it is the normal, x is any.
    vec3 x_axis = -incident - dot(-incident, normal) * normal;
    if (dot(x_axis, x_axis) < 1e-12) x_axis = cross(normal, abs(normal.x) < 0.7 ? vec3(1, 0, 0) : vec3(0, 1, 0));
    x_axis = normalize(x_axis);
    vec3 y_axis = cross(normal, x_axis);
    vec3 view = vec3(sqrt((1.0 - n_dot_v) * (1.0 + n_dot_v)), 0.0, n_dot_v);
    vec3 stretched = normalize(vec3(alpha * view.x, 0.0, view.z));
    float masked = ggxLambda(n_dot_v, alpha), split = 0.5 * (1.0 + stretched.z);

    albedo = vec2(0.0);
    bias = total = vec3(0.0);
    for (int i = 0; i < SPECULAR_SAMPLES; ++i) {
        // Vogel's (1979) spiral over the unit disc.
        float r = sqrt((float(i) + 0.5) / float(SPECULAR_SAMPLES));
        float phi = 2.0 * pi * float(uint(i) * 2654435769u) / 4294967296.0; // i times the golden ratio
        float t1 = r * cos(phi), t2 = r * sin(phi);
        t2 = mix(sqrt(1.0 - t1 * t1), t2, split);
        float t3 = sqrt(max(0.0, 1.0 - t1 * t1 - t2 * t2));
        // Along y, (-z, 0, x) of the stretched view, and it.
        vec2 across = t2 * vec2(-stretched.z, stretched.x) + t3 * stretched.xz;
        vec3 h = normalize(vec3(alpha * across.x, alpha * t1, max(0.0, across.y)));
        float v_dot_h = dot(view, h);
        vec3 light = 2.0 * v_dot_h * h - view;
        if (light.z <= 0.0) continue;
        // The density of l is D G1(v) / (4 n.v), what is to be summed D G2 / (4 n.v): G2 / G1(v) is
        // left, G1(l) if the two are independent.
        float shadowed = ggxLambda(light.z, alpha);
        float weight = SEPARABLE_MASKING ? 1.0 / (1.0 + shadowed)
                                         : (1.0 + masked) / (1.0 + masked + shadowed);
        float a2 = alpha * alpha, slope = h.x * h.x + h.y * h.y + a2 * h.z * h.z;
        float density = a2 / (pi * slope * slope) / ((1.0 + masked) * 4.0 * n_dot_v);
        vec3 world = light.x * x_axis + light.y * y_axis + light.z * normal;
        vec3 arriving = meanRadiance(world, 1.0 / (float(SPECULAR_SAMPLES) * density));
        float rest = 1.0 - v_dot_h, schlick = weight * (rest * rest) * (rest * rest) * rest;
        albedo += vec2(schlick, weight);
        bias += schlick * arriving;
        total += weight * arriving;
    }
    albedo /= float(SPECULAR_SAMPLES);
    bias /= float(SPECULAR_SAMPLES);
    total /= float(SPECULAR_SAMPLES);
}
