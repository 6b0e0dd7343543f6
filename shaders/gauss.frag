// One axis of a Gaussian blur; outside, the picture is its own mirror image. It reaches to where it
// has fallen to 6e-13 of its middle, so that what is left of the blur of a sun of 1e9 ends round, not
// at the edges of a square.
layout(binding = 0) uniform sampler2D picture;
uniform ivec2 axis; // (1, 0) or (0, 1)
uniform float deviation;
uniform float weight; // of the result
out vec4 color;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(picture, 0);
    int n = size.x * axis.x + size.y * axis.y, centre = at.x * axis.x + at.y * axis.y;
    int radius = int(ceil(7.5 * deviation));
    vec3 sum = vec3(0.0), least = vec3(3.4028235e38), most = -least;
    float weights = 0.0;
    for (int k = -radius; k <= radius; ++k) {
        float x = float(k) / deviation, share = exp(-0.5 * x * x);
        int i = centre + k, round_trip = 2 * n;
        i = i - round_trip * int(floor(float(i) / float(round_trip)));
        vec3 c = texelFetch(picture, at * axis.yx + mirrored(i, n) * axis, 0).rgb;
        sum += share * c;
        least = min(least, c);
        most = max(most, c);
        weights += share;
    }
    color = vec4(weight * clamp(sum / weights, least, most), 1.0); // a mean, but for its rounding
}
