// A material under a batch of lights: `brdf` of the material's file times what of each light arrives, added
// to the sample.
layout(binding = 4) uniform sampler2D points;
layout(binding = 5) uniform sampler2D normals;
layout(binding = 6) uniform sampler2D facets;
layout(binding = 7) uniform sampler2D colors;
out vec4 color;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 p = texelFetch(points, pixel, 0).xyz, normal = texelFetch(normals, pixel, 0).xyz;
    vec3 facet = texelFetch(facets, pixel, 0).xyz, v = -normalize(viewRay());
    base_color = texelFetch(colors, pixel, 0).rgb;
    vec3 radiance = vec3(0.0);
    for (int i = 0; i < light_count; ++i) {
        vec3 irradiance;
        float distance;
        vec3 l = towards(lights[i], p, irradiance, distance);
        float cosine = dot(normal, l);
        if (cosine <= 0.0) continue;
        float visible = visibilityOfObject(i, p, facet, l, distance);
        radiance += brdf(normal, l, v) * irradiance * (cosine * visible);
    }
    color = vec4(radiance, 0.0);
}
