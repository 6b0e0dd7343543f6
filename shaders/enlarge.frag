// One step up a pyramid: the coarser level enlarged, and this level's own share.
layout(binding = 0) uniform sampler2D coarse;
layout(binding = 1) uniform sampler2D own;
uniform ivec2 size; // of the level that is made
uniform float coarse_weight;
uniform float own_weight; // 0: `own` is not read
out vec4 color;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec3 sum = coarse_weight * enlarged(coarse, at, size);
    if (own_weight != 0.0) sum += own_weight * texelFetch(own, at, 0).rgb;
    color = vec4(sum, 1.0);
}
