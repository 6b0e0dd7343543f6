// The maps of the scene, turned with the probe. One that nothing reads is not bound.
uniform mat3 probe_from_world;
layout(binding = 0) uniform PROBE_SAMPLER probe;
layout(binding = 1) uniform DIFFUSE_SAMPLER diffuse;

// Radiance that arrives from a direction.
vec3 probeRadiance(vec3 direction) { return lookUp(probe, PROBE_BORDER, probe_from_world * direction); }

// Irradiance / pi of a surface with that normal.
vec3 diffuseRadiance(vec3 normal) { return lookUp(diffuse, DIFFUSE_BORDER, probe_from_world * normal); }
