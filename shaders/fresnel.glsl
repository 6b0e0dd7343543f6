// What a smooth dielectric's surface reflects.
uniform vec3 fresnel; // bias, scale and power; a negative bias: from the index of refraction

// Unpolarised light from an index of 1 into `ior` at the cosine c (Fresnel 1823, in the form of Cook
// and Torrance 1982 with g^2 = ior^2 - 1 + c^2): (g - c)^2 / (2 (g + c)^2)
// (1 + ((c (g + c) - 1) / (c (g - c) + 1))^2). With ior < 1, from the denser side, all is reflected
// where g would be imaginary.
float dielectricReflectance(float c, float ior) {
    float square = ior * ior - 1.0 + c * c;
    if (square <= 0.0) return ior < 1.0 ? 1.0 : 0.0; // an index of 1 is no surface
    float g = sqrt(square), sum = g + c;
    float difference = (ior * ior - 1.0) / sum; // g - c, where nothing cancels
    float across = difference / sum, along = (c * sum - 1.0) / (c * difference + 1.0);
    return 0.5 * across * across * (1.0 + along * along);
}

// The same, or what `fresnel` says.
float surfaceReflectance(float c, float ior) {
    if (fresnel.x < 0.0) return dielectricReflectance(c, ior);
    return clamp(fresnel.x + fresnel.y * pow(max(1.0 - c, 1e-7), fresnel.z), 0.0, 1.0);
}
