// One axis of a Gaussian blur; outside, the picture is its own mirror image.
layout(binding = 0) uniform sampler2D picture;
uniform ivec2 axis; // (1, 0) or (0, 1)
uniform float deviation;
out vec4 color;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(picture, 0);
    int n = size.x * axis.x + size.y * axis.y, centre = at.x * axis.x + at.y * axis.y;
    int radius = int(ceil(5.0 * deviation));
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int k = -radius; k <= radius; ++k) {
        float x = float(k) / deviation, weight = exp(-0.5 * x * x);
        int i = centre + k, round_trip = 2 * n;
        i = i - round_trip * int(floor(float(i) / float(round_trip)));
        sum += weight * texelFetch(picture, at * axis.yx + mirrored(i, n) * axis, 0).rgb;
        weights += weight;
    }
    color = vec4(sum / weights, 1.0);
}
