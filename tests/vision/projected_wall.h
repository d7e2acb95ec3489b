#pragma once
// A wall in front of a camera and a projector, for tests of what the camera can tell.

#include "vision/camera_model.h"

#include "core/random.h"
#include "media/image.h"

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace fantascope::vision {

struct ProjectedWall {
    CameraModel camera, projector;
    // How far the surface stands out of the plane z = 0 at a place, metres.
    std::function<double(double x, double y)> relief = [](double, double) { return 0.0; };
    std::function<double(double x, double y)> reflectance = [](double, double) { return 0.6; };
    double ambient = 0.02;     // linear light of a white wall
    double gamma = 2.2;        // the projector's
    double black = 0.0005;     // the light of its black, as a share of white
    double noise = 2 / 255.0;  // standard deviation of stored values
    double blur = 0;           // of the camera's lens: standard deviation, camera pixels
    double strength = 0.8;     // linear light of a white wall under full light, where it is brightest

    // Where a ray meets the surface.
    glm::dvec3 hit(const Ray& ray) const {
        double height = 0;
        glm::dvec3 point{0};
        for (int i = 0; i < 30; ++i) {
            point = ray.origin + ray.direction * ((height - ray.origin.z) / ray.direction.z);
            height = relief(point.x, point.y);
        }
        return point;
    }
    // The projector pixel that lights a camera pixel.
    glm::dvec2 projectorAt(glm::dvec2 cameraPixel) const {
        return *projector.pixelFromWorld(hit(camera.rayThrough(cameraPixel)));
    }

    // Linear light of the camera's picture of what the projector shows. `lamp`: light added
    // everywhere, by row.
    GreyImage seen(const RgbaImage& shown, Rng& rng, const std::function<double(int row)>& lamp = {}) {
        if (samples_.empty()) measure();
        GreyImage picture(camera.size.x, camera.size.y);
        for (const Sample& sample : samples_) {
            double light = ambient + (lamp ? lamp(sample.pixel.y) : 0);
            if (sample.lit) light += strength * (black + (1 - black) * valueAt(shown, sample.projector));
            picture.at(sample.pixel.x, sample.pixel.y) += static_cast<float>(sample.reflectance * light / (kSide * kSide));
        }
        if (blur > 0) picture = blurred(picture, blur);
        for (float& value : picture.pixels()) {
            const double stored = srgbFromLinear(std::min(1.0f, value)) + noise * rng.normal();
            value = linearFromSrgb(static_cast<float>(std::round(255 * std::clamp(stored, 0.0, 1.0)) / 255));
        }
        return picture;
    }

private:
    static constexpr int kSide = 3;  // samples across and down a camera pixel
    struct Sample {
        glm::ivec2 pixel;
        glm::dvec2 projector;
        bool lit;
        double reflectance;
    };
    void measure() {
        for (int y = 0; y < camera.size.y; ++y)
            for (int x = 0; x < camera.size.x; ++x)
                for (int i = 0; i < kSide * kSide; ++i) {
                    const glm::dvec3 point =
                        hit(camera.rayThrough({x + (i % kSide + 0.5) / kSide, y + (i / kSide + 0.5) / kSide}));
                    const auto at = projector.pixelFromWorld(point);
                    samples_.push_back(
                        {{x, y}, at.value_or(glm::dvec2(0)), at && projector.inPicture(*at), reflectance(point.x, point.y)});
                }
    }
    double valueAt(const RgbaImage& shown, glm::dvec2 pixel) const {
        const int x = std::min(static_cast<int>(pixel.x), shown.width() - 1),
                  y = std::min(static_cast<int>(pixel.y), shown.height() - 1);
        return std::pow(shown.at(x, y).r / 255.0, gamma);
    }

    std::vector<Sample> samples_;
};

// A slanted projector and a camera with a lens that bends, six metres from the wall.
inline ProjectedWall slantedWall() {
    ProjectedWall wall;
    wall.camera = *CameraModel::fromFieldOfView(*Pose::lookingAt({0.8, 1.7, 7}, {0, 1.5, 0}), {480, 270}, 0.9, -0.05, 0.01);
    wall.projector = CameraModel::fromThrowRatio(*Pose::lookingAt({-1.6, 2.9, 6}, {0.2, 1.5, 0}), {800, 450}, 1.6, {0, 0});
    return wall;
}

// Bricks with joints and stains, light and dark.
inline double bricks(double x, double y) {
    const double course = std::floor(y / 0.08), along = x / 0.24 + 0.5 * std::fmod(std::abs(course), 2);
    const double joint = std::min(y / 0.08 - course, along - std::floor(along));
    return joint < 0.12 ? 0.75 : 0.25 + 0.12 * std::sin(3 * x + 5 * y) + 0.1 * std::sin(17 * std::floor(along) + 29 * course);
}

}  // namespace fantascope::vision
