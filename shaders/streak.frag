// A step of a ray's streak: four places along it, `stride` pixels apart, the light fading by `fading`
// a pixel. Steps of stride 1, 4, 16 ... make the sum over a whole ray (Kawase 2003). Bilinear between
// pixels; outside the picture is no light.
layout(binding = 0) uniform sampler2D picture;
uniform vec2 direction; // unit
uniform float stride;
uniform float fading;
uniform float weight; // of the result
out vec4 color;

vec3 fetch(ivec2 at, ivec2 size) {
    bool inside = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, size));
    return inside ? texelFetch(picture, at, 0).rgb : vec3(0.0);
}

vec3 between(vec2 at, ivec2 size) {
    ivec2 low = ivec2(floor(at));
    vec2 t = at - vec2(low);
    return mix(mix(fetch(low, size), fetch(low + ivec2(1, 0), size), t.x),
               mix(fetch(low + ivec2(0, 1), size), fetch(low + ivec2(1, 1), size), t.x), t.y);
}

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy), size = textureSize(picture, 0);
    vec3 sum = fetch(at, size);
    float weights = 1.0;
    for (int k = 1; k < 4; ++k) {
        float there = pow(fading, float(k) * stride);
        sum += there * between(vec2(at) - float(k) * stride * direction, size);
        weights += there;
    }
    color = vec4(weight / weights * sum, 1.0);
}
