// One step up a pyramid: this level's own share, smoothed by 1 4 6 4 1 / 16 along each axis, which makes
// a Gaussian of its tents, and what comes from the coarser level, enlarged.
layout(binding = 0) uniform sampler2D own;
layout(binding = 1) uniform sampler2D coarse;
uniform float own_weight;
uniform bool is_coarsest; // `coarse` is not read
out vec4 color;

void main() {
    const float weights[5] = float[](0.0625, 0.25, 0.375, 0.25, 0.0625);
    ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(own, 0);
    vec3 sum = vec3(0.0);
    for (int j = 0; j < 5; ++j) {
        int y = mirrored(at.y + j - 2, size.y);
        vec3 row = vec3(0.0);
        for (int i = 0; i < 5; ++i)
            row += weights[i] * texelFetch(own, ivec2(mirrored(at.x + i - 2, size.x), y), 0).rgb;
        sum += weights[j] * row;
    }
    sum *= own_weight;
    if (!is_coarsest) sum += enlarged(coarse, at, size);
    color = vec4(sum, 1.0);
}
