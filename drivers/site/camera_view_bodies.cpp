// How bodies change what the camera sees: they hide, they are lit, and they stand in the
// projectors' light.

#include "drivers/site/camera_view.h"
#include "drivers/site/fog.h"

#include "core/check.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace fantascope::site {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLeastCosine = 0.01;
constexpr float kFarAway = std::numeric_limits<float>::infinity();

// The rectangle of a picture that may show a body; empty if it cannot.
struct Bounds {
    glm::dvec2 low{0.0}, high{0.0};
    bool empty() const { return low.x >= high.x || low.y >= high.y; }
    bool contain(glm::vec2 pixel) const { return low.x <= pixel.x && pixel.x <= high.x && low.y <= pixel.y && pixel.y <= high.y; }
};

Bounds boundsOf(const Body& body, const vision::CameraModel& model) {
    const glm::dvec2 size(model.size);
    const glm::dvec3 low = glm::min(body.around.from, body.around.to) - body.around.radius;
    const glm::dvec3 high = glm::max(body.around.from, body.around.to) + body.around.radius;
    Bounds bounds{glm::dvec2(1e9), glm::dvec2(-1e9)};
    int behind = 0, unseen = 0;
    for (int i = 0; i < 8; ++i) {
        const glm::dvec3 corner = glm::mix(low, high, glm::dvec3(i & 1, (i >> 1) & 1, i >> 2));
        behind += model.pose.localFromWorld(corner).z <= 0;
        const auto pixel = model.pixelFromWorld(corner);
        unseen += !pixel;
        if (!pixel) continue;
        bounds.low = glm::min(bounds.low, *pixel);
        bounds.high = glm::max(bounds.high, *pixel);
    }
    if (behind == 8) return {};
    if (unseen > 0) return {glm::dvec2(0), size};
    const glm::dvec2 spare = (bounds.high - bounds.low) * 0.1 + 2.0;  // a lens with distortion bends the box's edges outwards
    return {glm::max(bounds.low - spare, glm::dvec2(0)), glm::min(bounds.high + spare, size)};
}

// How much of a light reaches a body past the scene. It is looked up at three places of each part,
// so that it takes no ray for each sample.
class Openness {
public:
    Openness(const Scene& scene, const Body& body, glm::dvec3 light) {
        for (std::size_t part = 0; part < Body::kParts; ++part)
            for (std::size_t i = 0; i < kPlaces; ++i) {
                const double along = static_cast<double>(i) / (kPlaces - 1);
                const glm::dvec3 place = glm::mix(body.parts[part].from, body.parts[part].to, along);
                open_[part][i] = scene.blocked(place, light) ? 0 : 1;
            }
    }
    // `along`: the part's line, 0..1.
    double at(std::size_t part, double along) const {
        const double place = along * (kPlaces - 1);
        const auto below = std::min(static_cast<std::size_t>(place), kPlaces - 2);
        return glm::mix(open_[part][below], open_[part][below + 1], place - static_cast<double>(below));
    }

private:
    static constexpr std::size_t kPlaces = 3;
    std::array<std::array<double, kPlaces>, Body::kParts> open_{};
};

}  // namespace

void CameraView::expectBodies() {
    sights_.resize(static_cast<std::size_t>(camera_.size.x * camera_.size.y) * kSamples);
    for (std::uint32_t i = 0; i < sights_.size(); ++i) sights_[i] = {rayOf(i).direction, kFarAway};
    for (const Sample& sample : samples_) sights_[sample.index].distance = sample.distance;
    for (Projector& projector : projectors_) noteLitPoints(projector);
}

void CameraView::noteLitPoints(Projector& projector) const {
    projector.lit.clear();
    auto sample = samples_.begin();
    for (const Tap& tap : projector.taps) {
        while (sample->index != tap.index) ++sample;  // both are in the order of the picture
        projector.lit.push_back({projector.model.pixelFromWorld(sample->point).value(), sample->point});
    }
}

CameraView::Covering CameraView::coveringOf(std::span<const Body> bodies, Rows rows) const {
    Covering covering;
    if (bodies.empty()) return covering;
    FANTASCOPE_CHECK(!sights_.empty(), "expectBodies() comes before bodies");
    const auto width = static_cast<std::uint32_t>(camera_.size.x);
    covering.first = static_cast<std::uint32_t>(rows.first) * width * kSamples;
    covering.seenBy.assign(static_cast<std::size_t>(rows.end - rows.first) * width * kSamples, Covering::kNobody);
    const glm::dvec3 eye = camera_.pose.position;
    for (std::uint32_t body = 0; body < bodies.size(); ++body) {
        const Bounds bounds = boundsOf(bodies[body], camera_);
        if (bounds.empty()) continue;
        const auto top = static_cast<std::uint32_t>(std::max<int>(static_cast<int>(bounds.low.y), rows.first));
        const auto bottom = static_cast<std::uint32_t>(std::min(static_cast<int>(std::ceil(bounds.high.y)), rows.end));
        const auto left = static_cast<std::uint32_t>(bounds.low.x), right = static_cast<std::uint32_t>(std::ceil(bounds.high.x));
        for (std::uint32_t y = top; y < bottom; ++y)
            for (std::uint32_t i = (y * width + left) * kSamples; i < (y * width + right) * kSamples; ++i) {
                const auto hit = bodies[body].metBy(eye, sights_[i].direction);
                if (!hit || hit->distance >= sights_[i].distance) continue;
                std::uint32_t& seen = covering.seenBy[i - covering.first];
                if (seen != Covering::kNobody && covering.seen[seen].distance <= hit->distance) continue;
                if (seen == Covering::kNobody) {
                    seen = static_cast<std::uint32_t>(covering.seen.size());
                    covering.seen.emplace_back();
                }
                covering.seen[seen] = {i, hit->distance, body, hit->part};
            }
    }
    return covering;
}

// Ambient light and lamps are known by the pixel alone, so a pixel keeps the share of them that its
// free samples have.
void CameraView::hideBehind(const Covering& covering, Image<glm::vec3>& luminance) const {
    for (const Covering::Seen& seen : covering.seen) {
        const std::uint32_t pixel = seen.index / kSamples;
        std::uint32_t free = 0, firstHidden = seen.index;
        for (std::uint32_t i = pixel * kSamples; i < (pixel + 1) * kSamples; ++i)
            if (covering.hides(i))
                firstHidden = std::min(firstHidden, i);
            else
                ++free;
        if (firstHidden == seen.index) luminance.pixels()[pixel] *= kShare * static_cast<float>(free);
    }
}

void CameraView::addProjector(std::size_t index, const Lighting& lighting, const Covering& covering, Rows rows,
                              Image<glm::vec3>& luminance) const {
    const Projector& projector = projectors_[index];
    const ProjectedLight& frame = lighting.frames[index];
    const auto sampleOfRow = [&](int row) { return static_cast<std::uint32_t>(row * camera_.size.x) * kSamples; };
    const auto tapOfRow = [&](int row) {
        return std::lower_bound(projector.taps.begin(), projector.taps.end(), sampleOfRow(row),
                                [](const Tap& tap, std::uint32_t sample) { return tap.index < sample; });
    };
    std::vector<std::pair<const Body*, Bounds>> inTheLight;
    for (const Body& body : lighting.bodies)
        if (const Bounds bounds = boundsOf(body, projector.model); !bounds.empty()) inTheLight.emplace_back(&body, bounds);
    const auto shadowed = [&](const LitPoint& lit) {
        return std::any_of(inTheLight.begin(), inTheLight.end(), [&](const auto& each) {
            return each.second.contain(lit.pixel) && each.first->blocks(projector.model.pose.position, lit.point);
        });
    };
    const auto out = luminance.pixels();
    const auto add = [&](const Tap& tap) {
        out[tap.index / kSamples] += tap.weight * glm::vec3(frame.at(tap.place)) * transmitted(lighting.fog, tap.path);
    };
    const auto first = tapOfRow(rows.first), end = tapOfRow(rows.end);
    if (covering.seen.empty() && inTheLight.empty()) {
        std::for_each(first, end, add);
        return;
    }
    for (auto tap = first; tap != end; ++tap) {
        if (covering.hides(tap->index)) continue;
        if (!inTheLight.empty() && shadowed(projector.lit[static_cast<std::size_t>(tap - projector.taps.begin())])) continue;
        add(*tap);
    }
}

void CameraView::addBodies(const Lighting& lighting, const Covering& covering, glm::vec3 inTheAir,
                           Image<glm::vec3>& luminance) const {
    std::vector<BodyPoints> points(lighting.bodies.size());
    for (const Covering::Seen& seen : covering.seen) {
        const Capsule& part = lighting.bodies[seen.body].parts[seen.part];
        const glm::dvec3 direction = sights_[seen.index].direction;
        const glm::dvec3 point = camera_.pose.position + direction * seen.distance, normal = part.normalAt(point);
        const glm::vec3 ambient =
            steady_.meanIlluminance * lighting.ambient * transmitted(lighting.fog, static_cast<float>(seen.distance));
        points[seen.body].push_back({seen.index, seen.distance, seen.part, part.shareAlong(point), point, normal,
                                     std::max(kLeastCosine, -glm::dot(normal, direction)), ambient});
    }
    for (std::size_t body = 0; body < points.size(); ++body) {
        if (points[body].empty()) continue;
        for (std::size_t i = 0; i < lamps_.size(); ++i)
            if (lighting.levels[i] != glm::vec3(0))
                lightByLamp(points[body], lighting.bodies[body], lamps_[i], lighting.levels[i], lighting.fog);
        for (const Lamp& lamp : lighting.passing)
            lightByLamp(points[body], lighting.bodies[body], lamp, glm::vec3(1), lighting.fog);
        for (std::size_t i = 0; i < projectors_.size(); ++i)
            if (!lighting.frames[i].dark()) lightByProjector(points[body], body, i, lighting);
        const glm::vec3 response = lighting.bodies[body].reflectance * (kShare / kPi);
        for (const BodyPoint& each : points[body]) {
            const float left = transmitted(lighting.fog, static_cast<float>(each.distance));
            luminance.pixels()[each.index / kSamples] += each.light * response + kShare * (1 - left) * inTheAir;
        }
    }
}

void CameraView::lightByLamp(BodyPoints& points, const Body& body, const Lamp& lamp, glm::vec3 level, double fog) const {
    const Openness open(scene_, body, lamp.position);
    for (BodyPoint& each : points) {
        const glm::dvec3 toLamp = lamp.position - each.point;
        const double distance = glm::length(toLamp), cosine = glm::dot(each.normal, toLamp) / distance;
        if (cosine <= 0) continue;
        const double illuminance =
            lamp.intensity(-toLamp / distance) * cosine / (distance * distance) * open.at(each.part, each.along);
        each.light +=
            level * glm::vec3(lamp.colour * illuminance) * transmitted(fog, static_cast<float>(distance + each.distance));
    }
}

void CameraView::lightByProjector(BodyPoints& points, std::size_t body, std::size_t index, const Lighting& lighting) const {
    const Projector& projector = projectors_[index];
    const vision::CameraModel& model = projector.model;
    const Openness open(scene_, lighting.bodies[body], model.pose.position);
    const double lumensPerPixel = projector.lumens / (model.size.x * model.size.y);
    for (BodyPoint& each : points) {
        const auto pixel = model.pixelFromWorld(each.point);
        if (!pixel || !model.inPicture(*pixel)) continue;
        const double pixelsPerArea = model.pixelsPerArea(each.point, each.normal);
        if (pixelsPerArea <= 0) continue;
        const glm::dvec3 lens = model.pose.position;
        if (std::any_of(lighting.bodies.begin(), lighting.bodies.end(),
                        [&](const Body& other) { return other.blocks(lens, each.point); }))
            continue;
        const double width = each.distance / (camera_.focal * kSide), footprint = width * width / each.cosine;
        const auto place = ProjectedLight::placeOf(model.size, *pixel, std::sqrt(footprint * pixelsPerArea));
        const double illuminance = lumensPerPixel * pixelsPerArea * open.at(each.part, each.along);
        const auto path = static_cast<float>(glm::distance(lens, each.point) + each.distance);
        each.light +=
            glm::vec3(lighting.frames[index].at(place)) * static_cast<float>(illuminance) * transmitted(lighting.fog, path);
    }
}

}  // namespace fantascope::site
