// A Lambertian surface of albedo base_color.
vec3 shade(vec3 normal, vec3 incident) { return baseColor() * diffuseRadiance(normal); }
