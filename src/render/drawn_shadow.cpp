#include "render/drawn_shadow.h"

#include "render/facet_mesh.h"
#include "render/gpu/canvas_surface.h"
#include "render/gpu/screen_painter.h"
#include "render/gpu/shadow_caster.h"
#include "theatre/body_mesh.h"
#include "theatre/moving_cast.h"

#include "core/check.h"

#include <glm/geometric.hpp>

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
static_assert(BodyMesh::kInfluences == 4 && BodyMesh::kMostJoints == ShadowCaster::kMostJoints);

ShadowCaster::Piece pieceOf(const BodyMesh& skin) {
    ShadowCaster::Piece piece{{}, skin.atRest.triangles, true};
    for (std::size_t i = 0; i < skin.atRest.vertices.size(); ++i) {
        ShadowCaster::Vertex vertex{skin.atRest.vertices[i], {}, skin.shares[i]};
        for (std::size_t k = 0; k < vertex.joints.size(); ++k) vertex.joints[k] = static_cast<std::uint8_t>(skin.joints[i][k]);
        piece.vertices.push_back(vertex);
    }
    return piece;
}

// A thing that moves as a whole. Artists' meshes need not be closed.
ShadowCaster::Piece pieceOf(const TriangleMesh& thing) {
    ShadowCaster::Piece piece{{}, thing.triangles, false};
    for (const glm::vec3& vertex : thing.vertices) piece.vertices.push_back({vertex, {}, {1, 0, 0, 0}});
    return piece;
}

// Where a lamp shines from: spread evenly over its disc (Vogel 1979), or its middle alone.
std::vector<glm::dvec3> pointsOf(const ShadowSource::Lamp& lamp, int samples) {
    if (lamp.size <= 0) return {lamp.place};
    const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
    std::vector<glm::dvec3> points;
    for (int i = 0; i < samples; ++i) {
        const double radius = 0.5 * lamp.size * std::sqrt((i + 0.5) / samples), angle = i * golden;
        points.push_back(lamp.place + glm::dvec3(radius * std::cos(angle), radius * std::sin(angle), 0));
    }
    return points;
}

// From a point of light onto the screen at z = 0: (X, Y, W) of (x, y, z, 1).
glm::mat4x3 screenFromStage(const glm::dvec3& light) {
    return {{light.z, 0, 0}, {0, light.z, 0}, {-light.x, -light.y, -1}, {0, 0, light.z}};
}

// One lamp, ready to be cast.
struct Shining {
    std::vector<ShadowCaster::Light> points;
    std::vector<glm::vec3> taken;  // of each piece, by each point
    bool alike = true;
};

class DrawnShadow : public DrawnSource {
public:
    static Result<std::unique_ptr<DrawnSource>> create(const ShadowSource& source, const CanvasPlace& place,
                                                       DrawingTools& tools) {
        std::unique_ptr<DrawnShadow> made(new DrawnShadow(source, tools));
        const std::vector<ShadowCaster::Piece> pieces = made->pieces();
        made->caster_.emplace(TRY(ShadowCaster::create(pieces, place.size, tools.samples, tools.bend, tools.programs)));
        made->painter_.emplace(TRY(gpu::ScreenPainter::create(made->caster_->samples(), tools.bend, tools.programs)));
        made->shine(pieces.size());
        made->follow(place);
        made->moveStanding();
        return std::unique_ptr<DrawnSource>(std::move(made));
    }

    void paint(const Moment& moment, gpu::LayerPicture& picture) override {
        tools_.uploads.time([&] { move(frameAt(source_, moment.ofLayer)); });
        caster_->begin();
        for (const Shining& lamp : lamps_)
            for (const ShadowCaster::Light& light : lamp.points) caster_->cast(light, lamp.taken, lamp.alike);
        caster_->end();
        picture.begin();
        painter_->paint(caster_->texture(), dark_, bright_, lit_);
    }

    void follow(const CanvasPlace& place) override {
        painter_->follow(place);
        const glm::dvec2 size = source_.to - source_.from;
        const glm::dmat3 canvasFromScreen(1 / size.x, 0, 0, 0, -1 / size.y, 0, -source_.from.x / size.x, source_.to.y / size.y,
                                          1);
        const glm::mat3 clipFromScreen(clipFromCanvas(1, place) * canvasFromScreen);
        for (Shining& lamp : lamps_)
            for (ShadowCaster::Light& light : lamp.points) light.clipFromScreen = clipFromScreen;
    }

private:
    DrawnShadow(const ShadowSource& source, DrawingTools& tools)
        : source_(source), tools_(tools), cast_(*source.cast, source.play == ShadowSource::Play::Loop) {}

    // Actors first, then what each of them holds, then what stands.
    std::vector<ShadowCaster::Piece> pieces() {
        // A mesh bends triangles at their corners alone.
        const double longest = tools_.bend.any() ? gpu::Bend::kLongestEdge * (source_.to.y - source_.from.y) : INFINITY;
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
            const std::vector<glm::dvec3> points = pointsOf(lamp, source_.samples);
            for (const glm::dvec3& point : points) shining.points.push_back({screenFromStage(point), {}});
            const float share = 1 / static_cast<float>(points.size());
            shining.taken.assign(pieces, share * (lamp.light - lamp.shadow));
            shining.alike = lamp.actors.empty();
            for (std::size_t i = 0; i < lamp.actors.size(); ++i) shining.taken[i] = share * (lamp.light - lamp.actors[i]);
            dark_ += lamp.shadow;
            bright_ += lamp.light - lamp.shadow;
        }
        if (const auto& lit = source_.cast->stage.lit) {
            const glm::dvec2 size = source_.to - source_.from;
            lit_ = {(lit->from.x - source_.from.x) / size.x, (source_.to.y - lit->to.y) / size.y,
                    (lit->to.x - source_.from.x) / size.x, (source_.to.y - lit->from.y) / size.y};
        }
    }

    void give(std::size_t piece, std::span<const theatre::DualQuaternion> motions) {
        std::array<glm::vec4, 2 * BodyMesh::kMostJoints> parts;
        for (std::size_t i = 0; i < motions.size(); ++i)
            for (std::size_t half = 0; half < 2; ++half)
                for (std::size_t k = 0; k < 4; ++k) parts[2 * i + half][static_cast<int>(k)] = motions[i][4 * half + k];
        caster_->move(piece, std::span(parts).first(2 * motions.size()));
    }

    void moveStanding() {
        const theatre::DualQuaternion none = theatre::motionOf({1, 0, 0, 0}, glm::dvec3(0));
        for (std::size_t piece = firstStanding_; piece < lamps_[0].taken.size(); ++piece) give(piece, {&none, 1});
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
    }

    ShadowSource source_;
    DrawingTools& tools_;
    theatre::MovingCast cast_;
    std::vector<theatre::PlacedProp> standing_;
    std::size_t firstStanding_ = 0;
    std::optional<ShadowCaster> caster_;
    std::optional<gpu::ScreenPainter> painter_;
    std::vector<Shining> lamps_;
    glm::vec3 dark_{0}, bright_{0};
    glm::vec4 lit_{-1e6f, -1e6f, 1e6f, 1e6f};  // of the canvas
};

}  // namespace

Result<std::unique_ptr<DrawnSource>> makeDrawnShadow(const ShadowSource& source, const CanvasPlace& place, DrawingTools& tools) {
    return DrawnShadow::create(source, place, tools);
}

}  // namespace fantascope::render
