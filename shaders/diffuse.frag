// A Lambertian surface of albedo base_color.
uniform vec3 base_color;

vec3 shade(vec3 normal, vec3 incident) { return base_color * diffuseRadiance(normal); }
