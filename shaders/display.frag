// From radiance to display light: exposure, the glow that lenses add, vignette, tone map. Colours
// are premultiplied by alpha; tone maps apply to the straight colour. Defined as 0 or 1: STRAIGHT
// (alpha may be below 1), GLOW, EVEN (the half-size pictures are exactly that), VIGNETTE; and TONE, a
// function of tone_maps.glsl.
layout(binding = 0) uniform sampler2D frame; // or the part of it from texture_origin
uniform ivec2 texture_origin;
layout(binding = 1) uniform sampler2D glow; // what is scattered, by its weights
uniform float bright_weight;                // of the bright part, how much is scattered
uniform float glare_weight;                 // of everything
uniform float vignette;
out vec4 color;

// Light through a lens falls off by cos^4 of the angle to its axis; the corners stand at 45
// degrees.
float vignetteFactor() {
    vec2 from_centre = (vec2(framePixel()) + 0.5) / vec2(frame_size) - 0.5;
    vec2 r = from_centre * vec2(frame_size) / (0.5 * length(vec2(frame_size)));
    float cos2 = 1.0 / (1.0 + dot(r, r));
    return 1.0 - vignette * (1.0 - cos2 * cos2);
}

void main() {
    vec4 pixel = texelFetch(frame, framePixel() - texture_origin, 0);
    vec3 c = exposed(pixel.rgb);
#if GLOW
    c *= 1.0 - bright_weight * brightShare(c) - glare_weight;
#if EVEN
    c += enlargedTwice(glow, framePixel(), frame_size);
#else
    c += enlarged(glow, framePixel(), frame_size);
#endif
#endif
#if VIGNETTE
    c *= vignetteFactor();
#endif
#if STRAIGHT
    float alpha = isnan(pixel.a) ? 0.0 : clamp(pixel.a, 0.0, 1.0);
    c = alpha > 0.0 ? clamp(c / alpha, -largest, largest) : vec3(0.0);
    color = vec4(alpha * TONE(c), alpha);
#else
    color = vec4(TONE(c), 1.0);
#endif
    color.rgb = clamp(color.rgb, -largest, largest);
}
