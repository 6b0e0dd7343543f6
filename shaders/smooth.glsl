// A pyramid's level smoothed by 1 4 6 4 1 / 16 along an axis, which makes a Gaussian of its tents;
// outside, it is its own mirror image.
vec3 smoothed(sampler2D level, ivec2 at, ivec2 axis, ivec2 size) {
    const float weights[5] = float[](0.0625, 0.25, 0.375, 0.25, 0.0625);
    int n = size.x * axis.x + size.y * axis.y, i = at.x * axis.x + at.y * axis.y;
    vec3 sum = vec3(0.0);
    for (int k = 0; k < 5; ++k)
        sum += weights[k] * texelFetch(level, at * axis.yx + mirrored(i + k - 2, n) * axis, 0).rgb;
    return sum;
}
