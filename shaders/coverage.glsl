// Whether a surface is missing at a fragment: cut out by its alpha or, where it is blended, not in this
// sample. Of a pixel's samples a blended surface has the part that its alpha says, in a choice of its
// own, so that what lies behind it shows in the others whatever the order (stochastic transparency,
// Enderton et al. 2010). Defined: CUT_OUTS, 0 or 1, whether the object has such surfaces.
uniform float part_id; // of the object's parts, from 1
#if CUT_OUTS
uniform float alpha_cutoff; // below 0: blended
uniform ivec2 sample_of;    // which, of how many; of none: what has half alpha is there

// PCG (O'Neill 2014; Jarzynski and Olano 2020).
uint mixed(uint v) {
    uint state = v * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// The place of i in the permutation of 0 to n - 1 that the seed says (Kensler 2013).
uint permuted(uint i, uint n, uint seed) {
    uint w = n - 1u;
    w |= w >> 1u;
    w |= w >> 2u;
    w |= w >> 4u;
    w |= w >> 8u;
    w |= w >> 16u;
    do {
        i ^= seed;
        i *= 0xe170893du;
        i ^= seed >> 16u;
        i ^= (i & w) >> 4u;
        i ^= seed >> 8u;
        i *= 0x0929eb3fu;
        i ^= seed >> 23u;
        i ^= (i & w) >> 1u;
        i *= 1u | seed >> 27u;
        i *= 0x6935fa69u;
        i ^= (i & w) >> 11u;
        i *= 0x74dcb303u;
        i ^= (i & w) >> 2u;
        i *= 0x9e501cc3u;
        i ^= (i & w) >> 2u;
        i *= 0xc860a3dfu;
        i &= w;
        i ^= i >> 5u;
    } while (i >= n);
    return (i + seed) % n;
}
#endif

bool isMissing(float alpha) {
#if CUT_OUTS
    if (alpha_cutoff >= 0.0) return alpha < alpha_cutoff;
    if (sample_of.y == 0) return alpha < 0.5;
    if (alpha >= 1.0) return false;
    uint layer = mixed(uint(gl_PrimitiveID) + mixed(uint(part_id)));
    uint seed = mixed(uint(gl_FragCoord.x) + mixed(uint(gl_FragCoord.y) + layer));
    float place = float(permuted(uint(sample_of.x), uint(sample_of.y), seed));
    return alpha * float(sample_of.y) <= place + float(mixed(seed) >> 8u) / 16777216.0;
#else
    return false;
#endif
}
