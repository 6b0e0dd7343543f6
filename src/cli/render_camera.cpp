#include "cli/render_options.h"

namespace ibl {

Camera cameraOf(const CameraArguments& arguments) {
    if (!arguments.eye) {
        return orbitCamera(arguments.azimuth, arguments.elevation, arguments.distance,
                           arguments.target, arguments.fov);
    }
    return {*arguments.eye, arguments.target, arguments.up, arguments.fov};
}

void bindCamera(CLI::App& app, CameraArguments& arguments) {
    V3d& target = arguments.target;
    CLI::Option* eye = app.add_option_function<std::vector<double>>(
                              "--eye",
                              [&arguments](const std::vector<double>& v) {
                                  arguments.eye = V3d(v[0], v[1], v[2]);
                              },
                              "Where the camera stands")
                           ->delimiter(',')
                           ->expected(3)
                           ->type_name("X,Y,Z");
    addTriple(app, "--target", target, "Where it looks (default 0,0,0)")->group("Camera");
    addTriple(app, "--up", arguments.up, "What is up in the picture (default 0,1,0)")
        ->needs(eye)
        ->group("Camera");
    eye->group("Camera");
    const auto orbit = [&](const char* name, double& value, const char* help) {
        return app.add_option(name, value, help)
            ->excludes(eye)
            ->capture_default_str()
            ->group("Camera");
    };
    const CLI::Validator above_zero(
        [](const std::string& text) {
            double value = 0;
            const bool fits = CLI::detail::lexical_cast(text, value) && value > 0 && value < 1e9;
            return fits ? std::string() : "'" + text + "' is not a number above 0 and below 1e9";
        },
        "ABOVE 0");
    orbit("--azimuth", arguments.azimuth, "Camera's longitude about the target, 0 at +Z, 90 at +X")
        ->type_name("DEG");
    orbit("--elevation", arguments.elevation, "Its latitude, -90 to 90")
        ->check(CLI::Range(-90.0, 90.0))
        ->type_name("DEG");
    orbit("--distance", arguments.distance, "Its distance from the target")
        ->check(above_zero)
        ->type_name("D");
    app.add_option("--fov", arguments.fov, "Vertical field of view, above 0 and below 180")
        ->type_name("DEG")
        ->capture_default_str()
        ->group("Camera");
}

} // namespace ibl
