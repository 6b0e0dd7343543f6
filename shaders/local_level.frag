// A level of the pyramid of Gaussians of reinhard_local.glsl: every second sample of the finer one,
// by 1 5 8 5 1 / 20 along each axis. Defined as 0 or 1: PICTURE (the finer one is the picture, of
// which the texture holds a part, and whose border goes on outside).
layout(binding = 0) uniform sampler2D fine;
uniform ivec2 fine_size;   // of the whole
uniform ivec2 fine_origin; // of the part that the texture holds
uniform int margin; // samples ahead of the picture's first
out vec4 color;

void main() {
    const float weights[5] = float[](0.05, 0.25, 0.4, 0.25, 0.05);
    ivec2 centre = 2 * (ivec2(gl_FragCoord.xy) - margin);
    float sum = 0.0;
    for (int j = 0; j < 5; ++j) {
        for (int i = 0; i < 5; ++i) {
            ivec2 at = clamp(centre + ivec2(i, j) - 2, ivec2(0), fine_size - 1) - fine_origin;
            vec4 c = texelFetch(fine, at, 0);
#if PICTURE
            c.r = luminance(clamp(exposed(c.rgb), 0.0, 1e30));
#endif
            sum += weights[i] * weights[j] * c.r;
        }
    }
    color = vec4(sum);
}
