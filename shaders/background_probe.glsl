vec3 behind() { return probeRadiance(viewRay()); }
