vec4 behind() { return vec4(probeRadiance(viewRay()), 1.0); }
