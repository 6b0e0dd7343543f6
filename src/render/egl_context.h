// An OpenGL context with no display and no window.
#pragma once

#include <string>

namespace ibl {

/// Which renderer a context is asked from.
enum class DevicePreference {
    hardwareFirst, ///< a graphics card where one gives a context, otherwise software
    software,      ///< Mesa's software rasteriser, the same on every machine
};

/// An OpenGL 4.5 core context (direct state access) that is current on the thread that made it,
/// from an EGL device or, failing that, from EGL's surfaceless platform. It is released when the
/// object goes; GL objects must be gone before it.
///
/// Throws Error (missing), naming the packages to install, when this machine has no EGL, no GL
/// library, no driver, or none that gives OpenGL 4.5. Nothing of EGL or GL is loaded before the
/// first context is made.
class EglContext {
public:
    explicit EglContext(DevicePreference preference = DevicePreference::hardwareFirst);
    ~EglContext();
    EglContext(EglContext&& other) noexcept;
    EglContext& operator=(EglContext&& other) noexcept;
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;

    /// Vendor, renderer and version as the driver gives them, on one line.
    std::string description() const;

private:
    void* display_ = nullptr; // EGLDisplay
    void* context_ = nullptr; // EGLContext
};

} // namespace ibl
