// The tone maps. Curves take a value from 0 and are applied to the channels or to the luminance;
// the others take a colour. `parameters` are those of the table in src/render/tone_map.cpp.
uniform float parameters[6];

// 1 - exp(-c x); next to 0 its series, since there the difference has no digits left.
float exponentialCurve(float x) {
    float t = parameters[0] * x;
    return t < 0.03 ? t * (1.0 - t / 2.0 * (1.0 - t / 3.0 * (1.0 - t / 4.0))) : 1.0 - exp(-t);
}

// x^n / (x^n + sigma^n), so written that x^n cannot overflow.
float scurveCurve(float x) {
    return x > 0.0 ? 1.0 / (1.0 + pow(parameters[1] / x, parameters[0])) : 0.0;
}

// x (1 + x / white^2) / (1 + x), so written that x^2 cannot overflow and that rounding does not make
// more light darker.
float reinhardCurve(float x) {
    float compressed = x < 1.0 ? x / (1.0 + x) : 1.0 - 1.0 / (1.0 + x);
    return compressed * (1.0 + x / (parameters[0] * parameters[0]));
}

// Hable's f(x) = (x (A x + C B) + D E) / (x (A x + B) + D F) - E / F with A = 0.15, B = 0.5, C = 0.1,
// D = 0.2, E = 0.02, F = 0.3, on one denominator, so that nothing cancels next to 0:
// x (A (1 - E/F) x + B (C - E/F)) / (x (A x + B) + D F);
// and where it flattens as what it lacks of its limit.
float hable(float x) {
    const float A = 0.15, B = 0.5, C = 0.1, D = 0.2, E = 0.02, F = 0.3;
    const float limit = 1.0 - E / F, low = B * (C - E / F);
    if (x < 1.0) return x * (A * limit * x + low) / (x * (A * x + B) + D * F);
    float w = 1.0 / x;
    return limit - w * (B * limit - low + w * D * F * limit) / (A + w * (B + w * D * F));
}
float filmicCurve(float x) { return hable(2.0 * x) / hable(parameters[0]); }

vec3 noTone(vec3 c) { return c; }
vec3 clampTone(vec3 c) { return clamp(c, 0.0, 1.0); }

// Stephen Hill's fit: into a space between sRGB and AP1, a rational curve, and back.
vec3 acesTone(vec3 c) {
    const mat3 to = transpose(mat3(0.59719, 0.35458, 0.04823, 0.07600, 0.90834, 0.01566,
                                   0.02840, 0.13383, 0.83777));
    const mat3 from = transpose(mat3(1.60475, -0.53108, -0.07367, -0.10208, 1.10813, -0.00605,
                                     -0.00327, -0.07276, 1.07602));
    vec3 v = to * clamp(c, 0.0, 1e30);
    vec3 w = 1.0 / max(v, vec3(1.0)); // above 1, numerator and denominator divided by v^2
    vec3 u = v * w;
    vec3 curve = (u * (u + 0.0245786 * w) - 0.000090537 * w * w) /
                 (u * (0.983729 * u + 0.4329510 * w) + 0.238081 * w * w);
    return clamp(from * curve, 0.0, 1.0);
}

#ifdef CURVE
// Beyond 1e30 no curve moves, and below it CURVE(x) / x stays a normal number.
vec3 perChannel(vec3 c) {
    c = clamp(c, 0.0, 1e30);
    return vec3(CURVE(c.r), CURVE(c.g), CURVE(c.b));
}

vec3 perLuminance(vec3 c) {
    c = clamp(c, 0.0, 1e30);
    if (c.r == c.g && c.g == c.b) return vec3(CURVE(c.r)); // no rounding but the curve's
    float x = luminance(c);
    return x > 0.0 ? c * (CURVE(x) / x) : vec3(0.0);
}
#endif
