// One step up a pyramid: this level's own share, smoothed, and what comes from the coarser level,
// enlarged. Defined as 0 or 1: EVEN (that is exactly half as large).
layout(binding = 0) uniform sampler2D own; // smoothed across; the texture may be larger
layout(binding = 1) uniform sampler2D coarse;
uniform ivec2 size;
uniform float own_weight;
out vec4 color;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec3 sum = own_weight * smoothed(own, at, ivec2(0, 1), size);
#if EVEN
    sum += enlargedTwice(coarse, at, size);
#else
    sum += enlarged(coarse, at, size);
#endif
    color = vec4(sum, 1.0);
}
