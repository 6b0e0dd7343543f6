// The built-in meshes, one function each; builtinObject() in mesh.h names them.
#pragma once

#include "render/mesh.h"

namespace ibl {

/// Corners on the unit sphere, axis-aligned, flat faces.
Mesh makeCube();

/// Corners on the unit sphere, flat faces. Face normals are (0, +-1, +-phi) and its cyclic turns,
/// so that an edge, not a face, looks along each axis.
Mesh makeDodecahedron();

/// A ring about the Z axis, facing the viewer at azimuth 0: tube radius 0.3 about a circle of 0.7.
Mesh makeTorus();

/// Newell's teapot of 1975 (University of Utah): 32 bicubic Bezier patches, standing along +Y, its
/// spout towards +X, centred on its box and scaled into the unit sphere. As in the original there
/// is a narrow gap between lid and rim, and handle and spout run on into the body.
Mesh makeTeapot();

} // namespace ibl
