// One step up a pyramid: this level's own share, smoothed by 1 4 6 4 1 / 16 along each axis, which
// makes a Gaussian of its tents, and what comes from the coarser level, enlarged. Defined as 0 or
// 1: COARSEST (there is no coarser level), EVEN (it is exactly half as large).
layout(binding = 0) uniform sampler2D own;
layout(binding = 1) uniform sampler2D coarse;
uniform float own_weight;
out vec4 color;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(own, 0);
    // Linear between pixels, so three places make five weights: 1 and 4 are 5 at 1.2 pixels.
    const float places[3] = float[](-1.2, 0.0, 1.2), weights[3] = float[](0.3125, 0.375, 0.3125);
    vec2 pixel = 1.0 / vec2(size), centre = (vec2(at) + 0.5) * pixel;
    vec3 sum = vec3(0.0);
    for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
            vec2 place = centre + vec2(places[i], places[j]) * pixel;
            sum += weights[i] * weights[j] * texture(own, place).rgb;
        }
    }
    sum *= own_weight;
#if !COARSEST
#if EVEN
    sum += enlargedTwice(coarse, at, size);
#else
    sum += enlarged(coarse, at, size);
#endif
#endif
    color = vec4(sum, 1.0);
}
