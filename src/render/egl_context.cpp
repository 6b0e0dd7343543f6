#include "render/egl_context.h"

#include "core/error.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <array>
#include <cstdlib>
#include <utility>
#include <vector>

#include <dlfcn.h>

namespace ibl {
namespace {

constexpr EGLint kRendererName = 0x335F; // EGL_RENDERER_EXT, which libepoxy does not know
constexpr const char* kPackages =
    "install the packages libegl1 libgl1-mesa-dri libopengl0 (or a graphics driver with EGL)";

Error missing(std::string problem) {
    return {ExitCode::missing, "EGL: " + std::move(problem) + "; " + kPackages};
}

// libepoxy ends the process when it cannot load these, so they are tried first. The handles stay
// open: libepoxy is about to open the same libraries for as long as the process lives.
void requireLibraries() {
    if (!dlopen("libEGL.so.1", RTLD_LAZY | RTLD_LOCAL)) {
        throw missing("libEGL.so.1 is not on this machine");
    }
    if (!dlopen("libOpenGL.so.0", RTLD_LAZY | RTLD_LOCAL) &&
        !dlopen("libGL.so.1", RTLD_LAZY | RTLD_LOCAL)) {
        throw missing("libOpenGL.so.0 is not on this machine");
    }
}

bool clientHas(const char* name) {
    const char* client = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    return client && epoxy_extension_in_string(client, name);
}

bool has(EGLDeviceEXT device, const char* name) {
    const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
    return extensions && epoxy_extension_in_string(extensions, name);
}

bool isSoftware(EGLDeviceEXT device) {
    return has(device, "EGL_MESA_device_software");
}

std::vector<EGLDeviceEXT> allDevices() {
    const bool listed =
        clientHas("EGL_EXT_platform_base") && clientHas("EGL_EXT_platform_device") &&
        (clientHas("EGL_EXT_device_base") || clientHas("EGL_EXT_device_enumeration"));
    std::array<EGLDeviceEXT, 64> all;
    EGLint count = 0;
    if (!listed || !eglQueryDevicesEXT(static_cast<EGLint>(all.size()), all.data(), &count))
        return {};
    return std::vector<EGLDeviceEXT>(all.begin(), all.begin() + count);
}

// Software devices last; not at all hardware when only software is wanted.
std::vector<EGLDeviceEXT> orderedDevices(DevicePreference preference) {
    std::vector<EGLDeviceEXT> hardware, software;
    for (const EGLDeviceEXT device : allDevices())
        (isSoftware(device) ? software : hardware).push_back(device);
    if (preference == DevicePreference::software) return software;
    hardware.insert(hardware.end(), software.begin(), software.end());
    return hardware;
}

std::string nameOf(EGLDeviceEXT device) {
    if (isSoftware(device)) return "software";
    if (has(device, "EGL_EXT_device_query_name")) {
        if (const char* name = eglQueryDeviceStringEXT(device, kRendererName)) return name;
    }
    if (has(device, "EGL_EXT_device_drm")) {
        if (const char* file = eglQueryDeviceStringEXT(device, EGL_DRM_DEVICE_FILE_EXT))
            return file;
    }
    if (has(device, "EGL_NV_device_cuda")) return "NVIDIA";
    return "unnamed";
}

// Not every driver's display can be had; the caller goes on to the next.
EGLContext makeCurrentContext(EGLDisplay display) {
    if (!eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;
    constexpr EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                     4,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     5,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                     EGL_NONE};
    EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
    if (context == EGL_NO_CONTEXT) return EGL_NO_CONTEXT;
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) return context;
    eglDestroyContext(display, context);
    return EGL_NO_CONTEXT;
}

struct Attempt {
    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
};

Attempt attempt(EGLenum platform, void* native) {
    const EGLDisplay display = eglGetPlatformDisplayEXT(platform, native, nullptr);
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) return {};
    if (const EGLContext context = makeCurrentContext(display)) return {display, context};
    eglTerminate(display);
    return {};
}

Attempt firstContext(DevicePreference preference) {
    if (!clientHas("EGL_EXT_platform_base")) return {};
    for (const EGLDeviceEXT device : orderedDevices(preference)) {
        if (const Attempt found = attempt(EGL_PLATFORM_DEVICE_EXT, device); found.context) {
            return found;
        }
    }
    // Mesa before its device platform; whether it renders in software cannot be asked beforehand.
    if (preference == DevicePreference::hardwareFirst &&
        clientHas("EGL_MESA_platform_surfaceless")) {
        return attempt(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY);
    }
    return {};
}

void prepareEgl() {
    requireLibraries();
    // Mesa writes its own warnings to standard error for every device that it tries in vain.
    setenv("EGL_LOG_LEVEL", "fatal", 0);
}

} // namespace

EglContext::EglContext(DevicePreference preference) {
    prepareEgl();
    const Attempt found = firstContext(preference);
    if (!found.context) throw missing("no device here gives OpenGL 4.5");
    display_ = found.display;
    context_ = found.context;
}

EglContext EglContext::ofDevice(int number) {
    prepareEgl();
    const std::vector<EGLDeviceEXT> devices = allDevices();
    Attempt found;
    const bool exists = number >= 0 && static_cast<std::size_t>(number) < devices.size();
    if (exists) {
        found = attempt(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(number)]);
    }
    if (found.context) return {found.display, found.context};
    if (devices.empty()) throw missing("there is no device here");
    std::string names;
    for (std::size_t i = 0; i < devices.size(); ++i)
        names += (i ? ", " : "") + std::to_string(i) + " (" + nameOf(devices[i]) + ")";
    const std::string count = devices.size() == 1
                                  ? "is 1 device: "
                                  : "are " + std::to_string(devices.size()) + " devices: ";
    throw Error(ExitCode::missing,
                "EGL: device " + std::to_string(number) +
                    (exists ? " gives no OpenGL 4.5" : " is not on this machine") + "; there " +
                    count + names);
}

std::vector<std::string> eglDevices() {
    prepareEgl();
    std::vector<std::string> names;
    for (const EGLDeviceEXT device : allDevices())
        names.push_back(nameOf(device));
    return names;
}

// The display stays as it is for the life of the process: EGL hands out one display a device,
// whoever asks, and terminating it would take every other context there along.
EglContext::~EglContext() {
    if (!context_) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
}

EglContext::EglContext(EglContext&& other) noexcept
    : display_(std::exchange(other.display_, nullptr)),
      context_(std::exchange(other.context_, nullptr)) {}

EglContext& EglContext::operator=(EglContext&& other) noexcept {
    std::swap(display_, other.display_);
    std::swap(context_, other.context_);
    return *this;
}

std::string EglContext::description() const {
    const auto text = [](GLenum name) {
        const GLubyte* value = glGetString(name);
        return std::string(value ? reinterpret_cast<const char*>(value) : "unknown");
    };
    return text(GL_VENDOR) + ", " + text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION);
}

} // namespace ibl
