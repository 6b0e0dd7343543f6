#pragma once

namespace ibl {

/// Keeps up to half a gigabyte that is freed for the next allocation, on large pages, in place of
/// handing each block back to the system and getting it anew, a zeroed page at a time. To be called
/// once, before the first thread starts. It covers what the OpenGL driver allocates, too, whose
/// textures were half of the page faults of a 1920x1080 frame: that frame takes 0.21 s in place of
/// 0.31, a specular chain 0.106 in place of 0.122 (a 2048x1024 probe, two cores), with 2 to 10 MB
/// more memory at the peak. A wish: where it cannot be had, allocation works as before.
void keepHeap();

} // namespace ibl
