// The conversions behind `resample`: each fills `result`, whose layout and extent are set and
// whose pixels are 0.
#pragma once

#include "panorama/layouts.h"
#include "panorama/overlap.h"
#include "panorama/panorama.h"
#include "panorama/resample.h"

#include <algorithm>

namespace ibl {

// Where `down` is given, of a lat-long's size, `enlarging` is to hold, and `result` gets its
// pixels' moments along the rows, `down` those across (latlong_moments.h).
void latlongToLatlong(const Panorama& source, Panorama& result, Enlarging enlarging, int threads,
                      Image* down = nullptr);
void latlongToCube(const Panorama& source, Panorama& result, Enlarging enlarging, int threads);
void cubeToLatlong(const Panorama& source, Panorama& result, Enlarging enlarging, int threads,
                   Image* down = nullptr);
void cubeToCube(const Panorama& source, Panorama& result, Enlarging enlarging, int threads);
/// An image in the plain layout of an exr layout's kind, whose pixels are not set: of half the
/// width, so that each of the panorama's, whose borders run through centres, is two by two of them
/// or, at a border, one by two or one.
Panorama halfPixelsOf(const Panorama& panorama);
/// Where one of the two is a square map, the other one too, a lat-long, `faces` or of an exr
/// layout. What is read by area is `areas`: `source`, or where that is of an exr layout the same in
/// half pixels.
void throughSquareMap(const Panorama& source, const Panorama& areas, Panorama& result,
                      Enlarging enlarging, int threads, Image* down = nullptr);

/// The share of the area filter (the rest is interpolation) where a new texel is `ratio` old pixels
/// wide: none up to 0.8, all from 1 on, smooth between.
inline double areaShare(double ratio, Enlarging enlarging = Enlarging::interpolate) {
    if (enlarging == Enlarging::hold) return 1;
    const double x = std::clamp((ratio - 0.8) / 0.2, 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

inline bool hasBorderRule(Layout layout) {
    return layout == Layout::exrLatlong || layout == Layout::exrCube;
}

/// Distance of pixel centres from pole to pole, or over the two units of a face.
inline double centrePitch(double length, int pixels, bool border_rule) {
    return length / (border_rule && pixels > 1 ? pixels - 1 : pixels);
}

/// Position of pixel i's centre, as a part of the way from end to end.
inline double centreAt(int i, int pixels, bool border_rule) {
    if (border_rule && pixels > 1) return static_cast<double>(i) / (pixels - 1);
    return (i + 0.5) / pixels;
}

/// The six faces' places in an image.
struct CubePlacement {
    int edge;
    std::array<FacePlacement, 6> faces;

    explicit CubePlacement(const Panorama& p)
        : edge(*layoutSize(p.layout, p.image.width, p.image.height)) {
        for (int f = 0; f < 6; ++f)
            faces[static_cast<std::size_t>(f)] = facePlacement(p.layout, edge, f);
    }
    V2i pixel(int face, int i, int j) const {
        return faces[static_cast<std::size_t>(face)].pixel(i, j);
    }
};

/// A lat-long's pixels one for each rectangle of its grid: by the border rule the first and the
/// last column are halves of one.
class LatlongPixels {
public:
    explicit LatlongPixels(const Panorama& p);
    const float* at(int x, int y) const { return image_->at(x, y); }
    const float* row(int y) const { return image_->row(y); }
    int columns() const { return image_->width; }

private:
    Image folded_;
    const Image* image_;
};

/// Radiance times area, and area.
struct AreaSum {
    V3d radiance{0, 0, 0};
    double area = 0;

    void add(const float* pixel, double part) {
        radiance += V3d(pixel[0], pixel[1], pixel[2]) * part;
        area += part;
    }
    V3d mean() const { return radiance / area; }
};

inline void setPixel(float* pixel, const V3d& value) {
    for (int c = 0; c < 3; ++c)
        pixel[c] = static_cast<float>(value[c]);
}

} // namespace ibl
