#include "render/drawn_mirror_ball.h"

#include "render/canvas_light.h"
#include "render/gpu/paint/spot_painter.h"

#include "core/geometry.h"
#include "core/random.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace fantascope::render {
namespace {

using Facet = gpu::SpotPainter::Facet;

constexpr std::uint64_t kSeed = 1;
constexpr double kAskew = radians(0.6);  // standard deviation of the angle of a mirror glued on by hand

class DrawnMirrorBall : public DrawnSource {
public:
    DrawnMirrorBall(double turn, CanvasLight light, gpu::SpotPainter spots)
        : turn_(turn), light_(std::move(light)), spots_(std::move(spots)) {}

    void paint(const Moment& moment, gpu::LayerPicture& picture) override {
        const auto angle = static_cast<float>(2 * std::numbers::pi * std::fmod(seconds(moment.own) / turn_, 1));
        light_.paint(picture, [&] { spots_.paint(angle); });
    }
    void follow(const CanvasPlace& place) override { light_.follow(place); }

private:
    double turn_;  // seconds
    CanvasLight light_;
    gpu::SpotPainter spots_;
};

}  // namespace

std::vector<Facet> mirrorFacets(double radius, double facet) {
    Rng rng(kSeed);
    std::vector<Facet> facets;
    const auto rings = std::max(1L, std::lround(std::numbers::pi * radius / facet));
    for (long ring = 0; ring < rings; ++ring) {
        const double polar = std::numbers::pi * (static_cast<double>(ring) + 0.5) / static_cast<double>(rings);
        const double around = 2 * std::numbers::pi * radius * std::sin(polar);
        const auto count = std::max(1L, static_cast<long>(around / facet));
        const double begin = rng.uniform();
        for (long i = 0; i < count; ++i) {
            const double angle = 2 * std::numbers::pi * (static_cast<double>(i) + begin) / static_cast<double>(count);
            const glm::dvec3 outwards(std::sin(polar) * std::sin(angle), std::cos(polar), std::sin(polar) * std::cos(angle));
            const glm::dvec3 askew{rng.normal(), rng.normal(), rng.normal()};  // braces keep the order of the draws
            facets.push_back({outwards, glm::normalize(outwards + kAskew * askew)});
        }
    }
    return facets;
}

Result<std::unique_ptr<DrawnSource>> makeDrawnMirrorBall(const MirrorBallSource& source, const CanvasPlace& place,
                                                         DrawingTools& tools) {
    gpu::SpotPainter::Scene scene;
    scene.ball = source.ball;
    scene.lamp = source.lamp;
    scene.ballRadius = static_cast<float>(source.radius);
    scene.halfFacet = static_cast<float>(source.facet / 2);
    scene.lampRadius = static_cast<float>(source.lampRadius);
    scene.canvas = source.size;
    auto light = TRY(CanvasLight::create(source.size.x / source.size.y, source.light, place, tools));
    auto spots = TRY(gpu::SpotPainter::create(mirrorFacets(source.radius, source.facet), scene, tools.programs));
    return std::unique_ptr<DrawnSource>(new DrawnMirrorBall(source.turn, std::move(light), std::move(spots)));
}

}  // namespace fantascope::render
