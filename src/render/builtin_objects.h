// The built-in meshes, one function each; builtinObject() in mesh.h names them.
#pragma once

#include "render/mesh.h"

namespace ibl {

/// Corners on the unit sphere, axis-aligned, flat faces.
Mesh makeCube();

/// Corners on the unit sphere, flat faces. Face normals are (0, +-1, +-phi) and its cyclic turns,
/// so that an edge, not a face, looks along each axis.
Mesh makeDodecahedron();

/// Corners on the unit sphere, flat faces: one corner of the tetrahedron up, the others at azimuths
/// 60, 180 and 300 degrees, so that a face looks at the viewer at azimuth 0.
Mesh makeTetrahedron();

/// Corners on the unit sphere, one on each half axis, flat faces.
Mesh makeOctahedron();

/// Corners on the unit sphere, (0, +-1, +-phi) and its cyclic turns before scaling, flat faces.
Mesh makeIcosahedron();

/// A square in the plane y = 0, looking up, corners on the unit sphere; its texture's upper edge
/// lies towards -Z, its right one towards +X.
Mesh makePlane();

/// Upright, closed by flat discs, as high as wide: radius and half height 1 / sqrt 2.
Mesh makeCylinder();

/// Upright, tip at (0, 1, 0), closed by a flat disc at y = -1/2 of radius sqrt(3)/2: seen from the
/// side it is an equilateral triangle.
Mesh makeCone();

/// The unit sphere as triangles, textured as the exact one is.
Mesh makeSphere();

/// A ring about the Z axis, facing the viewer at azimuth 0: tube radius 0.3 about a circle of 0.7.
Mesh makeTorus();

/// Newell's teapot of 1975 (University of Utah): 32 bicubic Bezier patches, standing along +Y, its
/// spout towards +X, centred on its box and scaled into the unit sphere. As in the original there
/// is a narrow gap between lid and rim, and handle and spout run on into the body.
Mesh makeTeapot();

} // namespace ibl
