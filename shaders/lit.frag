// A material under a batch of lights, added to the sample.
layout(binding = 4) uniform sampler2D points;
layout(binding = 5) uniform sampler2D normals;
layout(binding = 6) uniform sampler2D facets;
layout(binding = 7) uniform sampler2D colors;
out vec4 color;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 p = texelFetch(points, pixel, 0).xyz, normal = texelFetch(normals, pixel, 0).xyz;
    vec3 facet = texelFetch(facets, pixel, 0).xyz, v = -normalize(viewRay());
    albedo = texelFetch(colors, pixel, 0).rgb;
    color = vec4(litRadiance(p, normal, facet, v), 0.0);
}
