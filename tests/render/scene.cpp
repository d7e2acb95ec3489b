#include "render/scene.h"

#include "drivers/registry.h"

#include "pattern/shape/grouping.h"

#include "core/check.h"
#include "core/random.h"
#include "source_folder.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace fantascope::render {
namespace {

constexpr int kWidth = 320, kHeight = 180;

pattern::ElementalShape flatPolygon(const std::string& name, std::uint32_t corners) {
    pattern::ElementalShape shape{name, {}};
    for (std::uint32_t i = 0; i < corners; ++i) {
        const double angle = 2 * M_PI * (i + 0.5) / corners;
        shape.mesh.vertices.push_back({std::cos(angle), std::sin(angle), 0});
        if (i >= 2) shape.mesh.triangles.push_back({0, i - 1, i});
    }
    return shape;
}

pattern::ElementalShape crystal() {
    return {"crystal",
            {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
             {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}}};
}

pattern::ElementalShape roof() {
    return {"roof",
            {{{-0.7f, 0.6f, 0.2f},
              {0.7f, 0.6f, 0.2f},
              {0.7f, -0.6f, 0.2f},
              {-0.7f, -0.6f, 0.2f},
              {-0.7f, 0, -0.5f},
              {0.7f, 0, -0.5f}},
             {{0, 4, 5}, {0, 5, 1}, {4, 3, 2}, {4, 2, 5}}}};
}

template <class T>
T valueOf(Result<T> result) {
    FANTASCOPE_CHECK(result.has_value(), result.error().message());
    return std::move(result).value();
}

}  // namespace

pattern::ShapePattern smallPattern() {
    pattern::ShapePattern pattern;
    pattern.width = kWidth;
    pattern.height = kHeight;
    pattern.seed = 7;
    pattern.shapes = {flatPolygon("triangle", 3), flatPolygon("square", 4), crystal(), roof()};
    // Set explicitly, so that golden frames do not depend on defaults.
    pattern.motion.instancesPerGroup = 10;
    pattern.motion.groupMajor = {2, 0.25, 0.35, 0.05, 0.02};
    pattern.motion.groupMinor = {2, 0.25, 0.35, 0.015, 0.006};
    pattern.motion.localTranslation = {1, 1.0, 0.2, 0.01, 0.004};
    pattern.motion.localTilt = {1, 0.8, 0.2, radians(35), radians(20)};
    pattern.motion.localTurn = {1, 0.8, 0.2, radians(23), radians(14)};
    Rng rng(11);
    for (std::uint32_t id = 0; id < 40; ++id) {
        pattern::ShapeInstance instance;
        instance.id = id;
        instance.shape = id % 4;
        instance.centre = {rng.uniform(0, pattern.aspect()), rng.uniform()};
        instance.size = rng.uniform(0.06, 0.16);
        instance.rotation = {rng.uniform(-0.6, 0.6), rng.uniform(-0.6, 0.6), rng.uniform(-3, 3)};
        instance.colour = {rng.uniform(0.2, 1), rng.uniform(0.2, 1), rng.uniform(0.2, 1)};
        pattern.instances.push_back(instance);
    }
    pattern::assignGroups(pattern);
    return pattern;
}

PatternSource resting(pattern::ShapePattern pattern) {
    return {std::make_shared<const pattern::ShapePattern>(std::move(pattern)), nullptr};
}

PatternSource moving(pattern::ShapePattern pattern) {
    PatternSource source = resting(std::move(pattern));
    source.motion = std::make_shared<const pattern::PatternMotion>(*source.pattern);
    return source;
}

pattern::ShapePattern squareAt(glm::dvec2 centre, double size, glm::vec3 colour, double aspect) {
    pattern::ShapePattern pattern;
    pattern.height = 900;
    pattern.width = static_cast<int>(std::lround(pattern.height * aspect));
    pattern.shapes = {flatPolygon("square", 4)};
    pattern::ShapeInstance instance;
    instance.centre = centre;
    instance.size = size;
    instance.colour = colour;
    pattern.instances = {instance};
    return pattern;
}

std::array<glm::dvec2, 4> keystone(glm::ivec2 size) {
    const auto at = [&](double x, double y) { return glm::dvec2(x * size.x, y * size.y); };
    return {at(0.12, 0.05), at(0.93, 0.16), at(0.98, 0.91), at(0.04, 0.97)};
}

Projection projectionTo(glm::ivec2 size, const std::array<glm::dvec2, 4>& corners) {
    Projection projection{size, Warp::of({.corners = corners}).value()};
    projection.light.dither = false;
    return projection;
}

DrawnOutput::DrawnOutput(const Projection& projection, const std::vector<PictureSource>& sources,
                         std::shared_ptr<const BlendMap> blend, const std::string& driver,
                         std::shared_ptr<const GreyImage> gain) {
    const glm::ivec2 size = projection.size;
    const ConfigNode options = valueOf(ConfigNode::parse("driver: " + driver, "site.yaml"));
    sink_ = valueOf(drivers::openDisplay(options, {"output", size, 30}, {clock_}));
    const Result<void> current = sink_->makeCurrent();
    FANTASCOPE_CHECK(current.has_value(), current.error().message());
    renderer_ = valueOf(OutputRenderer::create({projection, std::move(blend), 4, shaderFolder(), nullptr, std::move(gain)},
                                               PictureSources::numbered(sources)));
    tap_ = std::make_unique<FrameTap>(0, size);
    newest_ = &tap_->addNewest(std::numeric_limits<double>::infinity());
}

DrawnOutput::~DrawnOutput() {
    FANTASCOPE_CHECK(sink_->makeCurrent().has_value(), "OpenGL objects are destroyed while their context is current");
    tap_.reset();
    renderer_.reset();
}

const RgbaImage& DrawnOutput::frame(const show::OutputState& state, Time time, const Wind& wind) {
    FANTASCOPE_CHECK(sink_->makeCurrent().has_value(), "nobody unplugs it");
    renderer_->draw(state, wind, time, sink_->framebuffer());
    tap_->capture(sink_->framebuffer(), time);
    FANTASCOPE_CHECK(sink_->finish().has_value(), "nobody unplugs it");
    tap_->publish(valueOf(sink_->present()));
    tap_->finish();
    const ShownFrame* const frame = newest_->next(Time::max());
    FANTASCOPE_CHECK(frame != nullptr, "a presented frame is published");
    return frame->image;
}

Difference difference(const RgbaImage& a, const RgbaImage& b) {
    FANTASCOPE_CHECK(a.width() == b.width() && a.height() == b.height(), "only pictures of the same size are compared");
    Difference difference;
    for (std::size_t i = 0; i < a.pixels().size(); ++i) {
        const Rgba8 p = a.pixels()[i], q = b.pixels()[i];
        for (const int apart : {p.r - q.r, p.g - q.g, p.b - q.b}) {
            difference.rms += apart * apart;
            difference.most = std::max(difference.most, std::abs(apart));
        }
    }
    difference.rms = std::sqrt(difference.rms / (3.0 * static_cast<double>(a.pixels().size())));
    return difference;
}

std::filesystem::path shaderFolder() { return sourceFolder() + "/assets/shaders"; }

}  // namespace fantascope::render
