#include "plot/stage_view.h"

#include "theatre/mask/distance_field.h"

#include "core/check.h"
#include "core/geometry.h"
#include "plot/contact_shade.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace fantascope::plot {
namespace {

constexpr double kFieldOfView = radians(32), kMargin = 0.05;
// The view direction: 50 degrees from the first beam, 20 degrees down.
const glm::dvec3 kFromAbove{-std::sin(radians(50)), -std::tan(radians(20)), -std::cos(radians(50))};
constexpr double kLamp = 0.07;       // radius of the lamp, metres
constexpr double kFloorReach = 9;    // distance from the stage's middle at which the floor has faded, metres
constexpr float kGridLine = 0.008f;  // half a line's width, metres
constexpr double kOutline = 0.006;   // half the outline's width, as a share of the image's height
constexpr double kBase = 0.2;        // half the side of a lamp stand's base, metres
constexpr double kFoot = 0.35;       // length of a screen's feet in front of it and behind it, metres
constexpr double kBar = 0.03;        // thickness of a screen's frame, metres
constexpr double kStrip = 0.1;       // maximum width of the flat strips of a curved screen, metres

// Linear light.
constexpr glm::vec3 kBackground{0.80f, 0.83f, 0.87f}, kFloor{0.50f, 0.50f, 0.49f}, kGrid{0.36f, 0.37f, 0.38f};
constexpr glm::vec3 kCloth{0.97f, 0.93f, 0.83f}, kShadow{0.02f, 0.02f, 0.03f}, kRed{0.80f, 0.02f, 0.03f};
constexpr glm::vec3 kMetal{0.06f, 0.06f, 0.07f}, kGlow{1.0f, 0.72f, 0.25f};

glm::vec3 linear(const glm::dvec3& colour) {
    return {linearFromSrgb(float(colour.r)), linearFromSrgb(float(colour.g)), linearFromSrgb(float(colour.b))};
}

// A parallelogram.
void addFace(TriangleMesh& mesh, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v) {
    const auto first = static_cast<unsigned>(mesh.vertices.size());
    for (const glm::vec3& place : {corner, corner + u, corner + u + v, corner + v}) mesh.vertices.push_back(place);
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

void addBox(TriangleMesh& mesh, const glm::vec3& low, const glm::vec3& high) {
    const glm::vec3 size = high - low, x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    addFace(mesh, low, y, x), addFace(mesh, low + z, x, y);
    addFace(mesh, low, z, y), addFace(mesh, low + x, y, z);
    addFace(mesh, low, x, z), addFace(mesh, low + y, z, x);
}

TriangleMesh ball(const glm::vec3& centre, float radius) {
    constexpr unsigned kAround = 24, kRings = 12;
    TriangleMesh mesh;
    for (unsigned ring = 0; ring <= kRings; ++ring)
        for (unsigned i = 0; i < kAround; ++i) {
            const float down = glm::pi<float>() * float(ring) / kRings, turn = 2 * glm::pi<float>() * float(i) / kAround;
            mesh.vertices.push_back(
                centre + radius * glm::vec3(std::sin(down) * std::cos(turn), std::cos(down), std::sin(down) * std::sin(turn)));
            if (ring == kRings) continue;
            const unsigned a = ring * kAround + i, b = ring * kAround + (i + 1) % kAround;
            mesh.triangles.push_back({a, b, b + kAround});
            mesh.triangles.push_back({a, b + kAround, a + kAround});
        }
    return mesh;
}

// A rectangle of the unrolled screen.
struct Extent {
    glm::dvec2 leftTop, rightBottom;
};

Extent extentOf(const theatre::ScreenFrame& frame) {
    return {frame.metresAt({0, 0}), frame.metresAt({frame.width(), frame.height()})};
}

// The bounding box of the white pixels; all pixels if none is white.
Extent extentOfWhite(const theatre::ScreenFrame& frame, const theatre::BitMask& mask) {
    if (mask.count() == 0) return extentOf(frame);
    int left = mask.width(), right = 0, top = mask.height(), bottom = 0;
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x)
            if (mask.at(x, y)) {
                left = std::min(left, x), right = std::max(right, x + 1);
                top = std::min(top, y), bottom = std::max(bottom, y + 1);
            }
    return {frame.metresAt({left, top}), frame.metresAt({right, bottom})};
}

// A screen with the images on it.
struct ShownScreen {
    const theatre::Screen& screen;
    std::vector<std::size_t> beams;
    Extent extent;  // of all images

    // A place on the screen, or in front of it by `before`, in the stage's frame.
    glm::dvec3 at(double along, double up, double before = 0) const {
        glm::dvec3 place = screen.surface({along, up});
        const double angle = screen.isCurved() ? along / screen.radius : 0;
        place += before * glm::dvec3(-std::sin(angle), 0, std::cos(angle));
        return screen.stageFromScreen(place);
    }
    // Maps a point of the screen to (along, up).
    glm::dvec2 unrolled(const glm::dvec3& point) const {
        const glm::dvec3 p = screen.screenFromStage(point);
        if (!screen.isCurved()) return {p.x, p.y};
        return {screen.radius * std::atan2(p.x / screen.radius, 1 - p.z / screen.radius), p.y};
    }
    // Divides from .. to into strips that are flat enough.
    std::vector<double> cuts(double from, double to) const {
        const int strips = screen.isCurved() ? std::max(1, static_cast<int>(std::ceil((to - from) / kStrip))) : 1;
        std::vector<double> all;
        for (int i = 0; i <= strips; ++i) all.push_back(std::lerp(from, to, double(i) / strips));
        return all;
    }
};

std::vector<ShownScreen> screensOf(const StageView& view) {
    std::vector<ShownScreen> screens;
    for (std::size_t i = 0; i < view.images.size(); ++i) {
        const theatre::Screen& screen = view.stage.screenOf(i);
        const Extent extent = extentOf(view.images[i].frame);
        const auto known =
            std::find_if(screens.begin(), screens.end(), [&](const ShownScreen& other) { return &other.screen == &screen; });
        if (known == screens.end()) {
            screens.push_back({screen, {i}, extent});
            continue;
        }
        Extent& all = known->extent;
        known->beams.push_back(i);
        all.leftTop = {std::min(all.leftTop.x, extent.leftTop.x), std::max(all.leftTop.y, extent.leftTop.y)};
        all.rightBottom = {std::max(all.rightBottom.x, extent.rightBottom.x), std::min(all.rightBottom.y, extent.rightBottom.y)};
    }
    return screens;
}

// Interpolates between pixel centres; beyond the edge, the edge's value.
float sampled(const GreyImage& image, const glm::vec2& pixel) {
    const glm::vec2 p = pixel - 0.5f, low = glm::floor(p), f = p - low;
    const auto at = [&](int x, int y) {
        return image.at(std::clamp(x, 0, image.width() - 1), std::clamp(y, 0, image.height() - 1));
    };
    const int x = static_cast<int>(low.x), y = static_cast<int>(low.y);
    return glm::mix(glm::mix(at(x, y), at(x + 1, y), f.x), glm::mix(at(x, y + 1), at(x + 1, y + 1), f.x), f.y);
}

// The colour of a matt surface under two lights and the sky.
glm::vec3 matt(const glm::vec3& colour, const glm::vec3& normal, const glm::vec3& toCamera) {
    static const glm::vec3 key = glm::normalize(glm::vec3(-0.35f, 0.75f, 0.65f)),
                           fill = glm::normalize(glm::vec3(0.9f, 0.25f, 0.2f));
    const float sky = 0.5f + 0.5f * normal.y;
    const glm::vec3 light = 0.95f * std::max(0.0f, glm::dot(normal, key)) * glm::vec3(1.0f, 0.97f, 0.9f) +
                            0.18f * std::max(0.0f, glm::dot(normal, fill)) * glm::vec3(0.85f, 0.93f, 1.0f) +
                            glm::mix(glm::vec3(0.10f, 0.095f, 0.09f), glm::vec3(0.27f, 0.28f, 0.30f), sky);
    const float rim = std::max(0.0f, glm::dot(normal, toCamera));  // silhouettes are a little darker
    return colour * light * glm::mix(0.72f, 1.0f, glm::smoothstep(0.0f, 0.55f, rim));
}

Surface mattSurface(TriangleMesh mesh, const glm::vec3& colour, const glm::vec3& camera) {
    return {std::move(mesh), [=](const glm::vec3& place, const glm::vec3& normal) {
                return glm::vec4(matt(colour, normal, glm::normalize(camera - place)), 1);
            }};
}

Surface floorOf(const StageView& view, const ContactShade& contact) {
    const glm::vec3 middle(float(view.stage.beams[0].light.x), 0, float(0.45 * view.stage.beams[0].light.z));
    // The floor extends to the farthest light.
    float reach = static_cast<float>(kFloorReach);
    for (const theatre::Stage::Beam& beam : std::span(view.stage.beams).subspan(1))
        reach = std::max(reach, 1.5f * glm::distance(middle, glm::vec3(beam.light)));
    TriangleMesh mesh;
    addFace(mesh, middle + glm::vec3(-reach, 0, reach), {2 * reach, 0, 0}, {0, 0, -2 * reach});
    return {std::move(mesh), [=, &contact](const glm::vec3& place, const glm::vec3&) {
                const float x = std::abs(place.x - std::round(place.x)), z = std::abs(place.z - std::round(place.z));
                const float line = x < kGridLine || z < kGridLine ? 0.6f : 0.0f;
                const glm::vec3 colour = glm::mix(kFloor, kGrid, line) * (1 - 0.9f * std::min(1.0f, contact.at(place)));
                const float far = glm::smoothstep(0.45f * reach, reach, glm::distance(place, middle));
                return glm::vec4(glm::mix(colour, kBackground, far), 1);
            }};
}

// How one beam lights a screen. Places are on the unrolled screen.
struct Lighting {
    theatre::ScreenFrame frame;
    GreyImage shadow, target;  // signed distances, pixels
    bool hasTarget = false;
    glm::dvec3 light;  // in the screen's frame
    float half = 0;    // half the outline's width, metres

    Lighting(const StageView& view, std::size_t beam)
        : frame(view.images[beam].frame),
          shadow(theatre::signedDistance(view.images[beam].shadow)),
          target(theatre::signedDistance(view.images[beam].target)),
          hasTarget(view.images[beam].target.count() > 0),
          light(view.stage.lightOnScreen(beam)),
          half(static_cast<float>(kOutline * frame.height() * frame.pixel())) {}

    glm::vec3 colour(const theatre::Screen& screen, const glm::dvec2& place) const {
        const glm::dvec2 pixel = frame.pixelAt(place.x, place.y);
        const bool isIn = pixel.x >= 0 && pixel.y >= 0 && pixel.x <= frame.width() && pixel.y <= frame.height();
        const float falloff = glm::distance(glm::vec2(light), glm::vec2(screen.surface(place))) / 6;
        const glm::vec3 cloth = kCloth / (1 + falloff * falloff);
        return isIn ? glm::mix(cloth, kShadow, glm::smoothstep(-0.5f, 0.5f, sampled(shadow, glm::vec2(pixel)))) : cloth;
    }
    // The opacity of the target's outline, 0..1.
    float outline(const glm::dvec2& place) const {
        const auto pixel = static_cast<float>(frame.pixel());
        const float off = std::abs(sampled(target, glm::vec2(frame.pixelAt(place.x, place.y)))) * pixel;
        return hasTarget ? 1 - glm::smoothstep(half - 0.5f * pixel, half + 0.5f * pixel, off) : 0;
    }
};

Surface surfaceOf(const StageView& view, const ShownScreen& shown) {
    const auto [leftTop, rightBottom] = shown.extent;
    TriangleMesh mesh;
    const std::vector<double> cuts = shown.cuts(leftTop.x, rightBottom.x);
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        const glm::vec3 corner(shown.at(cuts[i], rightBottom.y));
        addFace(mesh, corner, glm::vec3(shown.at(cuts[i + 1], rightBottom.y)) - corner,
                glm::vec3(0, leftTop.y - rightBottom.y, 0));
    }
    std::vector<Lighting> lightings;
    for (const std::size_t beam : shown.beams) lightings.emplace_back(view, beam);
    return {std::move(mesh), [shown, lightings = std::move(lightings)](const glm::vec3& point, const glm::vec3&) {
                const glm::dvec2 place = shown.unrolled(point);
                glm::vec3 colour(0);
                for (const Lighting& lighting : lightings)
                    colour += lighting.colour(shown.screen, place) / static_cast<float>(lightings.size());
                for (const Lighting& lighting : lightings) colour = glm::mix(colour, kRed, lighting.outline(place));
                return glm::vec4(colour, 1);
            }};
}

// Adds a box given in another frame, which `toStage` maps to the stage.
template <class ToStage>
void addBox(TriangleMesh& mesh, const glm::vec3& low, const glm::vec3& high, ToStage toStage) {
    const std::size_t first = mesh.vertices.size();
    addBox(mesh, low, high);
    for (std::size_t i = first; i < mesh.vertices.size(); ++i) mesh.vertices[i] = toStage(mesh.vertices[i]);
}

// The screens' frames and feet, and the lamps' stands.
TriangleMesh standsOf(const StageView& view) {
    TriangleMesh mesh;
    const auto bar = static_cast<float>(kBar), foot = static_cast<float>(kFoot);
    for (const ShownScreen& shown : screensOf(view)) {
        const auto toStage = [&](const glm::vec3& v) { return glm::vec3(shown.at(v.x, v.y, v.z)); };
        const auto add = [&](const glm::vec3& low, const glm::vec3& high) { addBox(mesh, low, high, toStage); };
        const float left = float(shown.extent.leftTop.x), right = float(shown.extent.rightBottom.x),
                    top = float(shown.extent.leftTop.y);
        add({left - bar, 0, -bar}, {left, top + bar, bar});
        add({right, 0, -bar}, {right + bar, top + bar, bar});
        const std::vector<double> cuts = shown.cuts(left, right);
        for (std::size_t i = 0; i + 1 < cuts.size(); ++i) add({float(cuts[i]), top, -bar}, {float(cuts[i + 1]), top + bar, bar});
        for (const float x : {left - bar, right}) add({x, 0, -foot}, {x + bar, bar, foot});
    }
    const float lamp = static_cast<float>(kLamp);
    for (std::size_t i = 0; i < view.stage.beams.size(); ++i) {
        const theatre::Screen& screen = view.stage.screenOf(i);
        const glm::vec3 light(view.stage.lightOnScreen(i));
        const auto toStage = [&](const glm::vec3& v) { return glm::vec3(screen.stageFromScreen(v)); };
        const auto add = [&](const glm::vec3& low, const glm::vec3& high) { addBox(mesh, low, high, toStage); };
        add(light + glm::vec3(-1.5f * lamp, -1.5f * lamp, 1.2f * lamp), light + glm::vec3(1.5f * lamp, 1.5f * lamp, 3.2f * lamp));
        if (light.y <= 3 * lamp) continue;
        add({light.x - 0.015f, 0, light.z + 2 * lamp}, {light.x + 0.015f, light.y, light.z + 2 * lamp + 0.03f});
        const glm::vec3 below(light.x, 0, light.z + 2 * lamp);
        add(below - glm::vec3(kBase, 0, kBase), below + glm::vec3(kBase, 0.02, kBase));
    }
    return mesh;
}

Surface glowing(TriangleMesh mesh, const glm::vec3& colour, float opacity) {
    return {std::move(mesh), [=](const glm::vec3&, const glm::vec3&) { return glm::vec4(colour, opacity); }, opacity < 1};
}

// Adds a thin three-sided bar.
void addRay(TriangleMesh& mesh, const glm::vec3& from, const glm::vec3& to) {
    constexpr float kWidth = 0.012f;
    const glm::vec3 along = glm::normalize(to - from), side = kWidth * glm::normalize(glm::cross(along, glm::vec3(0, 1, 0)));
    const glm::vec3 up = glm::cross(side, along);
    const std::array<glm::vec3, 3> around{0.5f * side - 0.3f * up, -0.5f * side - 0.3f * up, 0.6f * up};
    for (std::size_t i = 0; i < 3; ++i) addFace(mesh, from + around[i], to - from, around[(i + 1) % 3] - around[i]);
}

// Adds the pyramid from a lamp to the bounding box of its target: faint sides, and edges.
void addBeam(const StageView& view, const ShownScreen& shown, std::size_t beam, std::vector<Surface>& surfaces) {
    const Extent box = extentOfWhite(view.images[beam].frame, view.images[beam].target);
    const glm::vec3 light(view.stage.beams[beam].light);
    std::vector<glm::vec3> around;  // the box's border, clockwise from its top left
    const std::vector<double> cuts = shown.cuts(box.leftTop.x, box.rightBottom.x);
    for (const double x : cuts) around.emplace_back(shown.at(x, box.leftTop.y));
    for (auto x = cuts.rbegin(); x != cuts.rend(); ++x) around.emplace_back(shown.at(*x, box.rightBottom.y));
    TriangleMesh sides, edges;
    for (std::size_t i = 0; i < around.size(); ++i) {
        const auto first = static_cast<unsigned>(sides.vertices.size());
        for (const glm::vec3& place : {light, around[i], around[(i + 1) % around.size()]}) sides.vertices.push_back(place);
        sides.triangles.push_back({first, first + 1, first + 2});
    }
    for (const double x : {box.leftTop.x, box.rightBottom.x})
        for (const double y : {box.leftTop.y, box.rightBottom.y}) addRay(edges, light, glm::vec3(shown.at(x, y + 0.006, 0.002)));
    surfaces.push_back(glowing(std::move(sides), kGlow, 0.045f));
    surfaces.push_back(glowing(std::move(edges), kGlow, 0.5f));
}

// A disc that faces the camera and fades outwards.
Surface haloOf(const glm::vec3& light, const glm::vec3& camera) {
    constexpr float kRadius = 0.55f;
    const glm::vec3 towards = glm::normalize(camera - light), side = glm::normalize(glm::cross(towards, glm::vec3(0, 1, 0)));
    const glm::vec3 u = kRadius * side, v = kRadius * glm::cross(side, towards);
    TriangleMesh mesh;
    addFace(mesh, light - u - v, 2.0f * u, 2.0f * v);
    return {std::move(mesh),
            [=](const glm::vec3& place, const glm::vec3&) {
                const float inside = std::max(0.0f, 1 - glm::distance(place, light) / kRadius);
                return glm::vec4(kGlow, 0.75f * inside * inside * inside);
            },
            true};
}

// Points that must be in every camera's picture.
std::vector<glm::dvec3> peopleAndScreens(const StageView& view) {
    std::vector<glm::dvec3> points;
    for (const ShownScreen& shown : screensOf(view)) {
        const Extent& extent = shown.extent;
        for (const double x : shown.cuts(extent.leftTop.x, extent.rightBottom.x))
            for (const double y : {extent.leftTop.y, extent.rightBottom.y}) points.push_back(shown.at(x, y));
        for (const double x : {extent.leftTop.x - kBar, extent.rightBottom.x + kBar})
            for (const double z : {-kFoot, kFoot}) points.push_back(shown.at(x, 0, z));
    }
    for (const auto* things : {&view.actors, &view.props})
        for (const StageView::Actor& thing : *things)
            points.insert(points.end(), thing.mesh.vertices.begin(), thing.mesh.vertices.end());
    return points;
}

void addLamps(const StageView& view, std::vector<glm::dvec3>& points) {
    for (std::size_t i = 0; i < view.stage.beams.size(); ++i) {
        const theatre::Screen& screen = view.stage.screenOf(i);
        const glm::dvec3 light = view.stage.lightOnScreen(i);
        points.push_back(view.stage.beams[i].light);
        for (const double x : {-kBase, kBase})
            for (const double z : {-kBase, kBase})
                points.push_back(screen.stageFromScreen({light.x + x, 0, light.z + 2 * kLamp + z}));
    }
}

// The view direction from the side that shows more screens from the front.
glm::dvec3 fromAbove(const StageView& view) {
    const glm::dvec3 mirrored(-kFromAbove.x, kFromAbove.y, kFromAbove.z);
    const auto seen = [&](const glm::dvec3& look) {
        return std::count_if(view.stage.screens.begin(), view.stage.screens.end(),
                             [&](const theatre::Screen& screen) { return screen.turnedFromStage(look).z < 0; });
    };
    return seen(mirrored) > seen(kFromAbove) ? mirrored : kFromAbove;
}

}  // namespace

Camera StageView::overview(double aspect) const {
    std::vector<glm::dvec3> points = peopleAndScreens(*this);
    addLamps(*this, points);
    return Camera::fitting(points, fromAbove(*this), kFieldOfView, aspect, kMargin);
}

Camera StageView::closeUp(double aspect) const {
    return Camera::fitting(peopleAndScreens(*this), fromAbove(*this), kFieldOfView, aspect, kMargin);
}

Camera StageView::fromTheSide(double aspect) const {
    std::vector<glm::dvec3> points = peopleAndScreens(*this);
    addLamps(*this, points);
    return Camera::fitting(points, {-1, -0.1, -0.12}, kFieldOfView, aspect, kMargin);
}

RgbaImage StageView::draw(const Camera& camera, int width, int height) const {
    FANTASCOPE_CHECK(images.size() == stage.beams.size(), "each beam of the stage has its image");
    for (const auto& [frame, shadow, target] : images)
        FANTASCOPE_CHECK(shadow.width() == frame.width() && shadow.height() == frame.height() &&
                             target.width() == frame.width() && target.height() == frame.height(),
                         "shadow and target are masks of the frame's size");
    const glm::vec3 eye(camera.position);
    const ContactShade contact(*this);
    std::vector<Surface> surfaces;
    for (const Actor& actor : actors) surfaces.push_back(mattSurface(actor.mesh, linear(actor.colour), eye));
    for (const Actor& prop : props) surfaces.push_back(mattSurface(prop.mesh, linear(prop.colour), eye));
    surfaces.push_back(mattSurface(standsOf(*this), kMetal, eye));
    for (std::size_t i = 0; i < stage.beams.size(); ++i)
        surfaces.push_back(glowing(ball(glm::vec3(stage.beams[i].light), static_cast<float>(kLamp)), {1, 0.95f, 0.8f}, 1));
    const std::vector<ShownScreen> screens = screensOf(*this);
    for (const ShownScreen& shown : screens) surfaces.push_back(surfaceOf(*this, shown));
    surfaces.push_back(floorOf(*this, contact));
    for (const ShownScreen& shown : screens)
        for (const std::size_t beam : shown.beams) addBeam(*this, shown, beam, surfaces);
    for (std::size_t i = 0; i < stage.beams.size(); ++i) surfaces.push_back(haloOf(glm::vec3(stage.beams[i].light), eye));
    return rendered(surfaces, camera, kBackground, width, height);
}

}  // namespace fantascope::plot
