#include "render/drawn_shadow.h"

#include "render/canvas/facet_mesh.h"
#include "render/gpu/paint/screen_painter.h"
#include "render/gpu/paint/shadow_caster.h"
#include "render/gpu/paint/shadow_sum.h"
#include "theatre/body/body_mesh.h"
#include "theatre/motion/moving_cast.h"

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::render {
namespace {

using gpu::ShadowCaster;
using theatre::BodyMesh;
static_assert(BodyMesh::kInfluences == 4 && BodyMesh::kMostJoints == ShadowCaster::kMaxJoints);

ShadowCaster::Piece pieceOf(const BodyMesh& skin) {
    ShadowCaster::Piece piece{{}, skin.atRest.triangles, true};
    for (std::size_t i = 0; i < skin.atRest.vertices.size(); ++i) {
        ShadowCaster::Vertex vertex{skin.atRest.vertices[i], {}, skin.shares[i]};
        for (std::size_t k = 0; k < vertex.joints.size(); ++k) vertex.joints[k] = static_cast<std::uint8_t>(skin.joints[i][k]);
        piece.vertices.push_back(vertex);
    }
    return piece;
}

// A rigid thing. Artists' meshes need not be closed.
ShadowCaster::Piece pieceOf(const TriangleMesh& thing) {
    ShadowCaster::Piece piece{{}, thing.triangles, false};
    for (const glm::vec3& vertex : thing.vertices) piece.vertices.push_back({vertex, {}, {1, 0, 0, 0}});
    return piece;
}

// A lamp's points of light in the screen's frame: evenly distributed over its disc (Vogel 1979), or
// only its centre.
std::vector<glm::dvec3> pointsOf(const ShadowSource::Lamp& lamp, int samples, const theatre::Screen& screen) {
    const glm::dvec3 middle = screen.screenFromStage(lamp.place);
    if (lamp.size <= 0) return {middle};
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    std::vector<glm::dvec3> points;
    for (int i = 0; i < samples; ++i) {
        const double radius = 0.5 * lamp.size * std::sqrt((i + 0.5) / samples), angle = i * golden;
        points.push_back(middle + glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), 0));
    }
    return points;
}

// The projection from a point of light onto the flat screen z = 0, in the screen's frame: from (x,
// y, z, 1) to (X, Y, W).
glm::dmat4x3 thrownFrom(const glm::dvec3& light) {
    return {{light.z, 0, 0}, {0, light.z, 0}, {-light.x, -light.y, -1}, {0, 0, light.z}};
}

// A lamp as it is drawn.
struct Shining {
    std::vector<ShadowCaster::Light> points;
    // Per piece: its shadow's colour as a layer picture holds it, or what its shadow takes away of
    // each point's light.
    std::vector<glm::vec3> colours;
    bool alike = true;  // all colours are equal
};

class DrawnShadow : public DrawnSource {
public:
    static Result<std::unique_ptr<DrawnSource>> create(const ShadowSource& source, const CanvasPlace& place,
                                                       DrawingTools& tools) {
        std::unique_ptr<DrawnShadow> made(new DrawnShadow(source, tools));
        const std::vector<ShadowCaster::Piece> pieces = made->pieces();
        made->caster_.emplace(TRY(ShadowCaster::create(pieces, made->onto_.isCurved(), tools.bend, tools.programs)));
        // The shadow of one point of light is painted directly, clipped by straight edges. Those of
        // several are summed first.
        const bool sums = source.lamps.size() > 1 || (source.lamps[0].size > 0 && source.samples > 1) ||
                          (made->onto_.isCurved() && made->beam_.lit);
        if (sums) made->sum_.emplace(TRY(gpu::ShadowSum::create(place.size, tools.samples)));
        made->painter_.emplace(TRY(
            gpu::ScreenPainter::create(sums ? made->sum_->samples() : 0, made->onto_.isCurved(), tools.bend, tools.programs)));
        made->shine(pieces.size());
        made->follow(place);
        made->moveStanding(pieces.size());
        return std::unique_ptr<DrawnSource>(std::move(made));
    }

    void paint(const Moment& moment, gpu::LayerPicture& picture) override {
        tools_.uploads.time([&] { move(frameAt(source_, moment.ofLayer)); });
        if (sum_) {
            sum_->begin();
            for (const Shining& lamp : lamps_)
                for (const ShadowCaster::Light& light : lamp.points) sum_->add(*caster_, light, lamp.colours, lamp.alike);
            sum_->end();
        }
        picture.begin();
        painter_->paint(screen_, sum_ ? sum_->texture() : 0);
        if (!sum_) caster_->paint(lamps_[0].points[0], lamps_[0].colours, inside_);
    }

    void follow(const CanvasPlace& place) override {
        painter_->follow(place);
        const glm::dmat3 clip = clipFromCanvas(1, place);
        const glm::dvec2 size = source_.to - source_.from;
        const glm::dmat3 canvasFromScreen(1 / size.x, 0, 0, 0, -1 / size.y, 0, -source_.from.x / size.x, source_.to.y / size.y,
                                          1);
        for (Shining& lamp : lamps_)
            for (ShadowCaster::Light& light : lamp.points) light.clipFromScreen = glm::mat3(clip * canvasFromScreen);
        // A homography H maps the line e, dot(e, (x, y, 1)) = 0, to inverse(H)^T e.
        const CanvasPart part = place.warp.shown();
        const glm::dmat3 clipFromEdge = glm::transpose(glm::inverse(clip));
        glm::dvec2 low = part.low, high = part.high;
        if (beam_.lit && !onto_.isCurved()) {
            const glm::dvec2 from = (beam_.lit->from - source_.from) / size, to = (beam_.lit->to - source_.from) / size;
            low = glm::max(low, glm::dvec2(from.x, 1 - to.y)), high = glm::min(high, glm::dvec2(to.x, 1 - from.y));
        }
        const std::array<glm::dvec3, 4> edges = {{{1, 0, -low.x}, {-1, 0, high.x}, {0, 1, -low.y}, {0, -1, high.y}}};
        std::transform(edges.begin(), edges.end(), inside_.begin(),
                       [&](const glm::dvec3& edge) { return glm::vec3(clipFromEdge * edge); });
    }

private:
    DrawnShadow(const ShadowSource& source, DrawingTools& tools)
        : source_(source),
          tools_(tools),
          cast_(*source.cast, source.play == ShadowSource::Play::Loop),
          beam_(source.cast->stage.beams[source.beam]),
          onto_(source.cast->stage.screenOf(source.beam)) {}

    // Actors first, then the props that each holds, then platforms and standing props.
    std::vector<ShadowCaster::Piece> pieces() {
        // A mesh and a curved screen bend triangles only at their corners, so triangles must be
        // small.
        const double longest =
            tools_.bend.any() || onto_.isCurved() ? gpu::Bend::kLongestEdge * (source_.to.y - source_.from.y) : INFINITY;
        const auto thing = [&](const TriangleMesh& mesh) { return pieceOf(cutUp(mesh, longest)); };
        std::vector<ShadowCaster::Piece> pieces;
        for (std::size_t i = 0; i < cast_.actors(); ++i) pieces.push_back(pieceOf(theatre::humanMesh(cast_.body(i))));
        for (std::size_t i = 0; i < cast_.actors(); ++i)
            for (const theatre::PlacedProp& prop : cast_.held(i)) pieces.push_back(thing(prop.prop->shape->mesh));
        firstStanding_ = pieces.size();
        theatre::placeStanding(source_.cast->stage, standing_);
        for (const theatre::PlacedProp& prop : standing_) pieces.push_back(thing(meshOf(prop)));
        for (const theatre::Stage::Platform& platform : source_.cast->stage.platforms) pieces.push_back(thing(meshOf(platform)));
        return pieces;
    }

    void shine(std::size_t pieces) {
        for (const ShadowSource::Lamp& lamp : source_.lamps) {
            Shining& shining = lamps_.emplace_back();
            for (const glm::dvec3& light : pointsOf(lamp, source_.samples, onto_))
                shining.points.push_back({glm::mat4x3(thrownFrom(light) * source_.cast->stage.screenFromStage(source_.beam)),
                                          {},
                                          glm::vec4(light, onto_.radius)});
            shining.alike = lamp.actors.empty();
            shining.colours.assign(pieces, lamp.shadow);
            std::copy(lamp.actors.begin(), lamp.actors.end(), shining.colours.begin());
            const float share = 1 / static_cast<float>(shining.points.size());
            for (glm::vec3& colour : shining.colours) colour = sum_ ? share * (lamp.light - colour) : glm::sqrt(colour);
            screen_.dark += lamp.shadow;
            screen_.bright += lamp.light - lamp.shadow;
        }
        screen_.canvas = {source_.from, source_.to};
        if (beam_.lit) screen_.lit = {beam_.lit->from, beam_.lit->to};
        screen_.curve = glm::vec4(onto_.screenFromStage(source_.lamps[0].place), onto_.radius);
    }

    void give(std::size_t piece, std::span<const theatre::DualQuaternion> motions) {
        std::array<glm::vec4, 2 * BodyMesh::kMostJoints> parts;
        for (std::size_t i = 0; i < motions.size(); ++i)
            for (std::size_t half = 0; half < 2; ++half)
                for (std::size_t k = 0; k < 4; ++k) parts[2 * i + half][static_cast<int>(k)] = motions[i][4 * half + k];
        caster_->move(piece, std::span(parts).first(2 * motions.size()));
    }

    void moveStanding(std::size_t pieces) {
        const theatre::DualQuaternion none = theatre::motionOf({1, 0, 0, 0}, glm::dvec3(0));
        for (std::size_t piece = firstStanding_; piece < pieces; ++piece) give(piece, {&none, 1});
    }

    void move(double frame) {
        cast_.pose(frame);
        std::array<theatre::DualQuaternion, BodyMesh::kMostJoints> motions;
        std::size_t held = cast_.actors();
        for (std::size_t i = 0; i < cast_.actors(); ++i) {
            const theatre::Body& body = cast_.body(i);
            theatre::jointMotions(body, cast_.posed(i), motions);
            give(i, std::span(motions).first(body.joints.size()));
            for (const theatre::PlacedProp& prop : cast_.held(i)) {
                const theatre::DualQuaternion motion = theatre::motionOf(prop.turn, prop.place);
                give(held++, {&motion, 1});
            }
        }
        caster_->moved();
    }

    ShadowSource source_;
    DrawingTools& tools_;
    theatre::MovingCast cast_;
    theatre::Stage::Beam beam_;
    theatre::Screen onto_;
    std::vector<theatre::PlacedProp> standing_;
    std::size_t firstStanding_ = 0;
    std::optional<ShadowCaster> caster_;
    std::optional<gpu::ShadowSum> sum_;
    std::optional<gpu::ScreenPainter> painter_;
    std::vector<Shining> lamps_;
    gpu::ScreenPainter::Screen screen_;
    std::array<glm::vec3, 4> inside_{};  // of the canvas's shown part and the lit part of the screen
};

}  // namespace

Result<std::unique_ptr<DrawnSource>> makeDrawnShadow(const ShadowSource& source, const CanvasPlace& place, DrawingTools& tools) {
    return DrawnShadow::create(source, place, tools);
}

}  // namespace fantascope::render
