// Depth of field: every pixel spreads over its circle of confusion, gathered here. `radius` holds
// the circle's radius in pixels and 1 / distance; outside, the picture is its own mirror image, so
// that no light leaves it.
//
// A pixel q has at p the part cover(|p - q|, r) / sum of cover over all pixels, r the radius at q, so
// what it spreads is all it has. What lies behind p is seen past p's edge only as far as p itself is
// out of focus: r is then the smaller of the two radii. The result is divided by the sum of weights,
// which is 1 where no such edge is near.
layout(binding = 0) uniform sampler2D picture;
layout(binding = 1) uniform sampler2D circles;     // r: radius, g: 1 / distance
layout(binding = 2) uniform sampler2D cover_sums;  // of radius k / kSteps
uniform int reach;                                 // pixels that any circle reaches
out vec4 color;

const float kSteps = 16.0;

float cover(float distance, float radius) { return clamp(radius + 0.5 - distance, 0.0, 1.0); }

// Of the picture and its mirror images, which repeat.
int folded(int i, int n) {
    int round_trip = 2 * n;
    return mirrored(i - round_trip * floorDivide(i, round_trip), n);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(picture, 0);
    vec2 own = texelFetch(circles, at, 0).rg;
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int y = -reach; y <= reach; ++y) {
        for (int x = -reach; x <= reach; ++x) {
            float distance = length(vec2(x, y));
            ivec2 from = ivec2(folded(at.x + x, size.x), folded(at.y + y, size.y));
            vec2 there = texelFetch(circles, from, 0).rg;
            float radius = there.g < 0.999 * own.g ? min(there.r, own.r) : there.r;
            float share = cover(distance, radius);
            if (share > 0.0) {
                float weight = share / texelFetch(cover_sums, ivec2(int(radius * kSteps + 0.5), 0), 0).r;
                sum += weight * texelFetch(picture, from, 0);
                weights += weight;
            }
        }
    }
    color = sum / weights;
}
