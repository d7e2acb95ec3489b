#include "drivers/site/camera_view.h"

#include "drivers/site/fog.h"

#include "core/check.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::site {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr float kSkyDistance = 60;  // metres of fog before the sky

constexpr double kGrazing = 1e-3;  // pixels per square metre: a surface seen at a grazing angle
constexpr double kLeastCosine = 0.01;

// What a texture shows in a cone of rays, `angle` radians across.
glm::vec3 textureOf(const Scene::Hit& hit, const vision::Ray& ray, double angle) {
    const glm::dvec3 normal(hit.normal);
    const double cosine = std::max(kLeastCosine, std::abs(glm::dot(normal, ray.direction))), width = hit.distance * angle;
    const glm::dvec3 along = ray.direction - normal * glm::dot(normal, ray.direction);
    const double length = glm::length(along);
    return hit.texture->around(hit.point, length > 0 ? along * (width / cosine / length) : glm::dvec3(0.0), width);
}

struct Illuminance {
    float lux = 0;       // of white light
    float distance = 0;  // from the lamp, metres
};

// What a lamp gives to a surface, without shadows.
Illuminance illuminanceOf(const Lamp& lamp, const Beam& beam, glm::vec3 point, glm::vec3 normal) {
    const glm::vec3 toLamp = glm::vec3(lamp.position) - point;
    const float distance = glm::length(toLamp), cosine = glm::dot(normal, toLamp) / distance;
    if (cosine <= 0) return {};
    return {beam.at(-glm::dot(toLamp, glm::vec3(lamp.aim)) / distance) * cosine / (distance * distance), distance};
}

}  // namespace

CameraView::CameraView(const Scene& scene, const vision::CameraModel& camera, glm::dvec3 ambient, glm::dvec3 sky)
    : scene_(scene), camera_(camera), steady_{Image<glm::vec4>(camera.size.x, camera.size.y), ambient} {
    const auto samples = static_cast<std::uint32_t>(camera.size.x * camera.size.y) * kSamples;
    for (std::uint32_t index = 0; index < samples; ++index) {
        const vision::Ray ray = rayOf(index);
        const auto hit = scene.nearest(ray.origin, ray.direction);
        glm::vec4& steady = steady_.light.pixels()[index / kSamples];
        if (!hit) {
            steady += kShare * glm::vec4(sky, kSkyDistance);
            continue;
        }
        glm::vec3 response = hit->reflectance * (kShare / static_cast<float>(kPi));
        if (hit->texture != nullptr) response *= textureOf(*hit, ray, 1 / (kSide * camera.focal));
        steady += glm::vec4(response * glm::vec3(ambient), kShare * hit->distance);
        const double pixelsPerArea = std::max(kGrazing, camera.pixelsPerArea(hit->point, hit->normal));
        const auto footprint = static_cast<float>(kShare / pixelsPerArea);
        samples_.push_back({index, hit->distance, footprint, hit->point, hit->normal, response});
    }
}

vision::Ray CameraView::rayOf(std::uint32_t sample) const {
    const auto width = static_cast<std::uint32_t>(camera_.size.x), pixel = sample / kSamples, place = sample % kSamples;
    return camera_.rayThrough({pixel % width + (place % kSide + 0.5) / kSide, pixel / width + (place / kSide + 0.5) / kSide});
}

// A disc in the picture, at least a pixel wide, so that the light of a distant head is not lost
// between samples.
template <class Add>
void CameraView::drawHead(const Lamp& lamp, Add add) const {
    const auto centre = camera_.pixelFromWorld(lamp.position);
    if (!centre || scene_.blocked(camera_.pose.position, lamp.position)) return;
    const glm::dvec3 fromLamp = camera_.pose.position - lamp.position;
    const double distance = glm::length(fromLamp), seen = lamp.radius * camera_.focal / distance, drawn = std::max(seen, 1.0);
    const double luminance = lamp.intensity(fromLamp / distance) / (kPi * lamp.radius * lamp.radius) * std::pow(seen / drawn, 2);
    const glm::ivec2 low = glm::max(glm::ivec2(*centre - drawn), glm::ivec2(0));
    const glm::ivec2 high = glm::min(glm::ivec2(*centre + drawn), camera_.size - 1);
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x)
            for (int i = 0; i < kSide * kSide; ++i) {
                const glm::dvec2 at(x + (i % kSide + 0.5) / kSide, y + (i / kSide + 0.5) / kSide);
                if (glm::length(at - *centre) > drawn) continue;
                add(static_cast<std::uint32_t>((y * camera_.size.x + x) * kSide * kSide + i), lamp.colour * (luminance * kShare),
                    distance);
            }
}

void CameraView::addLamp(const Lamp& lamp) {
    Layer layer{Image<glm::vec4>(camera_.size.x, camera_.size.y), glm::vec3(0)};
    const auto add = [&](std::uint32_t pixel, glm::vec3 luminance, float path) {
        // The path is the mean over the samples, weighted by their light.
        layer.light.pixels()[pixel] += glm::vec4(luminance, (luminance.r + luminance.g + luminance.b) * path);
    };
    for (const Sample& sample : samples_) {
        const glm::vec3 toLamp = glm::vec3(lamp.position) - sample.point;
        const float distance = glm::length(toLamp), cosine = glm::dot(sample.normal, toLamp) / distance;
        if (cosine <= 0) continue;
        const double intensity = lamp.intensity(-glm::dvec3(toLamp) / static_cast<double>(distance));
        const glm::vec3 illuminance = lamp.colour * (intensity * cosine / (distance * distance));
        if (scene_.blocked(sample.point, lamp.position)) continue;
        add(sample.index / kSamples, illuminance * sample.response, distance + sample.distance);
        layer.meanIlluminance += illuminance / static_cast<float>(samples_.size());
    }

    drawHead(lamp, [&](std::uint32_t sample, glm::vec3 luminance, double distance) {
        add(sample / kSamples, luminance, static_cast<float>(distance));
    });
    for (glm::vec4& light : layer.light.pixels())
        if (const float sum = light.r + light.g + light.b; sum > 0) light.w /= sum;
    lampLayers_.push_back(std::move(layer));
    lamps_.push_back(lamp);
}

void CameraView::addProjector(const vision::CameraModel& projector, double lumens) {
    projectors_.push_back({lumens});
    moveProjector(projectors_.size() - 1, projector);
}

void CameraView::moveProjector(std::size_t index, const vision::CameraModel& model) {
    Projector& projector = projectors_[index];
    projector.model = model;
    projector.taps.clear();
    projector.meanIlluminance = 0;
    const double lumensPerPixel = projector.lumens / (model.size.x * model.size.y);
    for (const Sample& sample : samples_) {
        const auto pixel = model.pixelFromWorld(sample.point);
        if (!pixel || !model.inPicture(*pixel)) continue;
        const double pixelsPerArea = model.pixelsPerArea(sample.point, sample.normal);
        if (pixelsPerArea <= 0 || scene_.blocked(sample.point, model.pose.position)) continue;
        const double illuminance = lumensPerPixel * pixelsPerArea;
        const auto path = static_cast<float>(glm::distance(model.pose.position, glm::dvec3(sample.point))) + sample.distance;
        projector.taps.push_back({sample.index,
                                  ProjectedLight::placeOf(model.size, *pixel, std::sqrt(sample.footprint * pixelsPerArea)),
                                  sample.response * static_cast<float>(illuminance), path});
        projector.meanIlluminance += static_cast<float>(illuminance / static_cast<double>(samples_.size()));
    }
    if (!sights_.empty()) noteLitPoints(projector);
}

glm::vec3 CameraView::airlight(const Lighting& lighting) const {
    // Fog scatters light evenly in all directions, once.
    glm::vec3 inTheAir = steady_.meanIlluminance * lighting.ambient;
    for (std::size_t i = 0; i < lamps_.size(); ++i) inTheAir += lighting.levels[i] * lampLayers_[i].meanIlluminance;
    for (std::size_t i = 0; i < projectors_.size(); ++i)
        if (const ProjectedLight& frame = lighting.frames[i]; !frame.dark())
            inTheAir += glm::vec3(frame.mean()) * projectors_[i].meanIlluminance;
    if (lighting.fog > 0)
        for (const Lamp& lamp : lighting.passing) inTheAir += meanIlluminanceOf(lamp);
    return inTheAir / static_cast<float>(4 * kPi);
}

// Every sixteenth sample is enough for a mean.
glm::vec3 CameraView::meanIlluminanceOf(const Lamp& lamp) const {
    constexpr std::size_t kStep = 16;
    const Beam beam(lamp);
    float sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < samples_.size(); i += kStep, ++count)
        sum += illuminanceOf(lamp, beam, samples_[i].point, samples_[i].normal).lux;
    return glm::vec3(lamp.colour) * (count > 0 ? sum / static_cast<float>(count) : 0.0f);
}

void CameraView::addPassing(const Lamp& lamp, const Lighting& lighting, const Covering& covering, Rows rows,
                            Image<glm::vec3>& luminance) const {
    const Beam beam(lamp);
    const glm::vec3 colour(lamp.colour);
    const auto out = luminance.pixels();
    const auto first = static_cast<std::uint32_t>(rows.first * camera_.size.x) * kSamples;
    const auto end = static_cast<std::uint32_t>(rows.end * camera_.size.x) * kSamples;
    auto sample = std::lower_bound(samples_.begin(), samples_.end(), first,
                                   [](const Sample& each, std::uint32_t index) { return each.index < index; });
    for (; sample != samples_.end() && sample->index < end; ++sample) {
        const auto [lux, distance] = illuminanceOf(lamp, beam, sample->point, sample->normal);
        if (lux <= 0 || covering.hides(sample->index)) continue;
        out[sample->index / kSamples] += lux * colour * sample->response * transmitted(lighting.fog, distance + sample->distance);
    }
    drawHead(lamp, [&](std::uint32_t index, glm::vec3 light, double distance) {
        if (index < first || index >= end || covering.hides(index, distance)) return;
        out[index / kSamples] += light * transmitted(lighting.fog, static_cast<float>(distance));
    });
}

void CameraView::render(const Lighting& lighting, Rows rows, Image<glm::vec3>& luminance) const {
    FANTASCOPE_CHECK(lighting.levels.size() == lamps_.size() && lighting.frames.size() == projectors_.size(),
                     "one level per lamp, one frame per projector");
    FANTASCOPE_CHECK(luminance.width() == camera_.size.x && luminance.height() == camera_.size.y,
                     "a picture of the camera's size");
    FANTASCOPE_CHECK(0 <= rows.first && rows.first <= rows.end && rows.end <= camera_.size.y, "rows of the picture");

    const double fog = lighting.fog;
    const glm::vec3 inTheAir = airlight(lighting);
    const auto out = luminance.pixels();
    const auto pixelOfRow = [&](int row) { return static_cast<std::uint32_t>(row * camera_.size.x); };
    const std::uint32_t first = pixelOfRow(rows.first), end = pixelOfRow(rows.end);
    for (std::uint32_t i = first; i < end; ++i) {
        const glm::vec4 steady = steady_.light.pixels()[i];
        const float left = transmitted(fog, steady.w);
        out[i] = glm::vec3(steady) * (lighting.ambient * left) + inTheAir * (1 - left);
    }
    for (std::size_t lamp = 0; lamp < lamps_.size(); ++lamp) {
        const glm::vec3 level = lighting.levels[lamp];
        if (level == glm::vec3(0)) continue;
        for (std::uint32_t i = first; i < end; ++i) {
            const glm::vec4 light = lampLayers_[lamp].light.pixels()[i];
            out[i] += level * glm::vec3(light) * transmitted(fog, light.w);
        }
    }
    const Covering covering = coveringOf(lighting.bodies, rows);
    hideBehind(covering, luminance);
    for (std::size_t i = 0; i < projectors_.size(); ++i)
        if (!lighting.frames[i].dark()) addProjector(i, lighting, covering, rows, luminance);
    for (const Lamp& lamp : lighting.passing) addPassing(lamp, lighting, covering, rows, luminance);
    addBodies(lighting, covering, inTheAir, luminance);
}

}  // namespace fantascope::site
