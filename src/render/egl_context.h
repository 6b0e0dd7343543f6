// An OpenGL context with no display and no window.
#pragma once

#include <string>
#include <vector>

namespace ibl {

/// Which renderer a context is asked from.
enum class DevicePreference {
    hardwareFirst, ///< a graphics card where one gives a context, otherwise software
    software,      ///< Mesa's software rasteriser, the same on every machine
};

/// The EGL devices of this machine, in EGL's order, each in a few words: the driver's name for it
/// or its device file, or "software". Throws Error (missing) when there is no EGL.
std::vector<std::string> eglDevices();

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
    /// Of that device of eglDevices() alone. Throws Error (missing), naming the devices that there
    /// are, when it is not among them or gives no OpenGL 4.5.
    static EglContext ofDevice(int number);
    ~EglContext();
    EglContext(EglContext&& other) noexcept;
    EglContext& operator=(EglContext&& other) noexcept;
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;

    /// Vendor, renderer and version as the driver gives them, on one line.
    std::string description() const;

private:
    EglContext(void* display, void* context) : display_(display), context_(context) {}

    void* display_ = nullptr; // EGLDisplay
    void* context_ = nullptr; // EGLContext
};

} // namespace ibl
