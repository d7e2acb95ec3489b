// Compares shadow theatre on an output with independently computed shadows.

#include "render/output_renderer.h"
#include "render/scene.h"
#include "theatre/a_scene.h"
#include "theatre/motion/moving_cast.h"
#include "theatre/stage/cast.h"
#include "theatre/stage/mesh_shadow.h"

#include "core/geometry.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace fantascope::render {
namespace {

using theatre::BitMask;
using theatre::Cast;
using theatre::ScreenFrame;

constexpr glm::ivec2 kSize{640, 360};
constexpr double kPixel = 2.7 / kSize.y;  // metres
const glm::dvec2 kFrom{-0.5 * kSize.x * kPixel, -0.1}, kTo{0.5 * kSize.x * kPixel, 2.6};

std::array<glm::dvec2, 4> upright() { return rectangleCorners(kSize.x, kSize.y); }

// People of three statures in random possible poses, facing all directions, over `frames` frames.
Cast aCast(std::size_t actors, std::size_t frames, std::uint64_t seed) {
    Cast cast;
    cast.stage.beams[0].light = {0.2, 0.3, 7};
    cast.framesPerSecond = 8;
    Rng rng(seed);
    for (std::size_t i = 0; i < actors; ++i) {
        Cast::Actor actor{1.5 + 0.15 * static_cast<double>(i % 3), {}};
        theatre::PoseProblem problem{cast.stage, {theatre::aScene({}).targets[0]}, {theatre::humanBody(actor.stature)}, {}};
        const glm::dvec3 place(-1.2 + 2.4 * static_cast<double>(i) / static_cast<double>(actors), 0.9, rng.uniform(1, 4.5));
        std::vector<double> pose = problem.actors[0].restPose(place, theatre::rotationOf({0, rng.uniform(-3, 3), 0}));
        pose = theatre::nudged(problem, pose, rng, 1.2);
        for (std::size_t frame = 0; frame < frames; ++frame) {
            actor.poses.push_back(theatre::poseOf(problem.actors[0], pose));
            pose = theatre::nudged(problem, pose, rng, 0.2);
        }
        cast.actors.push_back(std::move(actor));
    }
    return cast;
}

// A platform, something that stands, and something that the first actor holds in his left hand.
void furnish(Cast& cast) {
    cast.stage.platforms.push_back({"step", {-1.4, 0.2, 2}, {0.8, 0.4, 0.6}, 0.4});
    theatre::Prop rock = theatre::aBox({0.3, 0.5, 0.2}, {1.5, 0.25, 3});
    rock.turn = theatre::rotationOf({0, 0.3, 0});
    cast.stage.props.push_back(rock);
    theatre::Prop stick = theatre::aBox({0.06, 1.4, 0.06}, {0, 0.2, 0.1});
    stick.holder = {0, theatre::BodyPart::LeftHand};
    stick.turn = theatre::rotationOf({0.2, 0.1, 0.5});
    cast.stage.props.push_back(stick);
}

ShadowSource sourceOf(Cast cast) {
    ShadowSource source;
    source.lamps = {{cast.stage.beams[0].light, 0, glm::vec3(1), glm::vec3(0), {}}};
    source.cast = std::make_shared<const Cast>(std::move(cast));
    source.from = kFrom;
    source.to = kTo;
    return source;
}

// The shadow of the skins as the search for poses computes it.
BitMask solversShadow(const Cast& cast, double frame, bool loops, const ScreenFrame& screen) {
    theatre::MovingCast moving(cast, loops);
    moving.pose(frame);
    BitMask mask(screen.width(), screen.height());
    theatre::MeshShadow shadow;
    std::vector<glm::vec3> skin;
    std::vector<theatre::PlacedProp> props, held;
    theatre::placeStanding(cast.stage, props);
    for (std::size_t i = 0; i < moving.actors(); ++i) {
        const theatre::BodyMesh mesh = theatre::humanMesh(moving.body(i));
        mesh.skin(moving.body(i), moving.posed(i), skin);
        shadow.add(screen, mesh, skin, mask);
        theatre::placeHeld(cast.stage, i, moving.body(i), moving.posed(i), held);
        props.insert(props.end(), held.begin(), held.end());
    }
    for (const theatre::PlacedProp& prop : props) theatre::addShadow(screen, meshOf(prop), mask);
    for (const theatre::Stage::Platform& platform : cast.stage.platforms) theatre::addShadow(screen, meshOf(platform), mask);
    return mask;
}

ScreenFrame screenOf(const Cast& cast, int finer = 1) {
    return {cast.stage, kFrom.x, kTo.y, kPixel / finer, kSize.x * finer, kSize.y * finer};
}

double lightAt(const RgbaImage& image, int x, int y) {
    return double{linearFromSrgb(static_cast<float>(image.at(x, y).g) / 255)};
}

double agreement(const RgbaImage& image, const BitMask& mask) {
    std::int64_t both = 0, either = 0;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            const bool drawn = lightAt(image, x, y) < 0.6;  // at least half of its samples
            both += drawn && mask.at(x, y), either += drawn || mask.at(x, y);
        }
    return static_cast<double>(both) / static_cast<double>(either);
}

// Example failures: a skin collapses at bent joints, a held prop is left behind, an actor is
// mirrored, half of a body is not drawn.
TEST(Shadow, is_the_one_that_the_poses_were_found_for) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        Cast cast = aCast(9, 1, seed);
        if (seed > 3) furnish(cast);
        DrawnOutput output(kSize, upright(), {sourceOf(cast)});
        const BitMask wanted = solversShadow(cast, 0, false, screenOf(cast));
        ASSERT_GT(wanted.count(), 10'000);
        EXPECT_GT(agreement(output.frame({{0, 1}}), wanted), 0.99) << seed;
    }
}

// It also holds between two frames, and after the last.
TEST(Shadow, moves_as_its_poses_do) {
    Cast cast = aCast(3, 4, 7);
    furnish(cast);
    ShadowSource source = sourceOf(cast);
    for (const auto play : {ShadowSource::Play::Once, ShadowSource::Play::Loop, ShadowSource::Play::ToAndFro}) {
        source.play = play;
        DrawnOutput output(kSize, upright(), {source});
        for (const double second : {0.0, 0.06, 0.31, 0.44, 0.7}) {
            const Time time(static_cast<std::int64_t>(1e9 * second));
            const BitMask wanted = solversShadow(cast, frameAt(source, time), play == ShadowSource::Play::Loop, screenOf(cast));
            EXPECT_GT(agreement(output.frame({{0, 1}}, time), wanted), 0.99) << second;
        }
    }
}

TEST(Shadow, plays_once_in_a_loop_or_to_and_fro) {
    ShadowSource source = sourceOf(aCast(1, 5, 1));  // 8 frames a second
    const auto at = [&](double second) { return frameAt(source, Time(static_cast<std::int64_t>(1e9 * second))); };
    source.speed = 2;
    EXPECT_DOUBLE_EQ(at(-1), 0);
    EXPECT_DOUBLE_EQ(at(0.125), 2);
    EXPECT_DOUBLE_EQ(at(9), 4);
    EXPECT_EQ(lengthOf(source), std::chrono::milliseconds(250));
    source.play = ShadowSource::Play::Loop;
    EXPECT_DOUBLE_EQ(at(0.28125), 4.5) << "between the last and the first";
    EXPECT_DOUBLE_EQ(at(0.375), 1);
    source.play = ShadowSource::Play::ToAndFro;
    EXPECT_DOUBLE_EQ(at(0.03125), 0.125) << "from rest";
    EXPECT_DOUBLE_EQ(at(0.15625), 2);
    EXPECT_DOUBLE_EQ(at(0.3125), 4);
    EXPECT_DOUBLE_EQ(at(0.46875), 2);
    EXPECT_DOUBLE_EQ(at(0.625), 0);
    EXPECT_DOUBLE_EQ(at(0.78125), 2);
    EXPECT_EQ(lengthOf(source), std::chrono::milliseconds(625));
    for (double second = 0; second < 1.3; second += 0.001)
        EXPECT_LE(std::abs(at(second + 0.001) - at(second)), 0.016 + 1e-9) << "never faster than its frame rate";
    source.cast = std::make_shared<const Cast>(aCast(1, 1, 1));
    for (const auto play : {ShadowSource::Play::Once, ShadowSource::Play::Loop, ShadowSource::Play::ToAndFro}) {
        source.play = play;
        EXPECT_DOUBLE_EQ(at(3.3), 0);
        EXPECT_EQ(lengthOf(source), Time{});
    }
}

// A keystone, also with a mesh: every pixel of the output is looked up on the screen.
// Example failure: a platform's long edges stay straight under the mesh.
TEST(Shadow, goes_through_the_outputs_warp) {
    Cast cast = aCast(4, 1, 2);
    furnish(cast);
    for (const bool mesh : {false, true}) {
        Projection projection = projectionTo(kSize, keystone(kSize));
        if (mesh) {
            WarpShape shape = projection.warp.shape();
            shape.mesh.points = {4, 3};
            for (int i = 0; i < 12; ++i) shape.mesh.offsets.emplace_back(9 * std::sin(1.7 * i), 9 * std::cos(2.3 * i));
            projection.warp = Warp::of(shape).value();
        }
        DrawnOutput output(projection, {sourceOf(cast)});
        const RgbaImage& image = output.frame({{0, 1}});
        constexpr int kFiner = 2;
        const BitMask screen = solversShadow(cast, 0, false, screenOf(cast, kFiner));
        std::int64_t both = 0, either = 0;
        for (int y = 0; y < kSize.y; ++y)
            for (int x = 0; x < kSize.x; ++x) {
                const auto canvas = projection.warp.canvasFromProjector({x + 0.5, y + 0.5});
                if (!canvas || canvas->x < 0 || canvas->y < 0 || canvas->x >= 1 || canvas->y >= 1) {
                    if (canvas && glm::distance(*canvas, glm::clamp(*canvas, 0.0, 1.0)) > 0.01) {
                        ASSERT_EQ(image.at(x, y).g, 0) << "light beyond the canvas at " << x << ", " << y;
                    }
                    continue;
                }
                const bool drawn = lightAt(image, x, y) < 0.5;
                const bool wanted =
                    screen.at(static_cast<int>(canvas->x * kSize.x * kFiner), static_cast<int>(canvas->y * kSize.y * kFiner));
                both += drawn && wanted, either += drawn || wanted;
            }
        // Pixels at the canvas's edge are partly dark anyway.
        EXPECT_GT(static_cast<double>(both) / static_cast<double>(either), 0.985) << mesh;
    }
}

// A stage with only a wall, whose edges are straight.
Cast aWall(double z) {
    Cast cast = aCast(1, 1, 1);
    cast.stage.beams[0].light = {0, 1.25, 6};
    cast.actors[0].poses[0].root = {30, 1, 1};  // out of sight
    cast.stage.platforms.push_back({"wall", {0.4, 2, z}, {0.8, 4, 0.001}, 0});
    return cast;
}

// The part of a lamp's disc that a straight edge hides is a circular segment.
// Example failures: a penumbra of the wrong width, such as twice as wide because a radius is taken
// for the diameter; visible steps.
TEST(Shadow, has_edges_as_soft_as_the_lamp_is_wide) {
    for (const double z : {0.5, 2.0, 3.5}) {
        ShadowSource source = sourceOf(aWall(z));
        source.lamps[0].size = 0.3;
        source.samples = 64;
        DrawnOutput output(kSize, upright(), {source});
        const RgbaImage& image = output.frame({{0, 1}});
        const double shadow = 0.0, radius = 0.15 * z / (6 - z);  // of the lamp's image about the wall's left edge at x = 0
        for (int x = 0; x < kSize.x; ++x) {
            const double off = std::clamp((kFrom.x + (x + 0.5) * kPixel - shadow) / radius, -1.0, 1.0);
            if (kFrom.x + x * kPixel > 0.5) break;  // the penumbra of the other edge
            const double seen = (std::acos(off) - off * std::sqrt(1 - off * off)) / std::numbers::pi;
            EXPECT_NEAR(lightAt(image, x, kSize.y / 2), seen, 0.05) << z << " at " << x;
        }
        EXPECT_EQ(image.at(kSize.x / 2 + 60, kSize.y / 2).g, 0) << "full shadow is black";
    }
}

// Two people stand in line with the lamp: the one nearer to it sets the colour, whatever their
// order in the cast.
TEST(Shadow, has_the_colour_of_who_is_nearest_to_the_lamp) {
    for (const bool swapped : {false, true})
        for (const double size : {0.0, 0.02}) {
            Cast cast = aCast(2, 1, 3);
            cast.stage.beams[0].light = {0, 1.2, 7};
            for (std::size_t i = 0; i < 2; ++i) {
                const theatre::Body body = theatre::humanBody(cast.actors[i].stature);
                const double z = (i == 1) != swapped ? 4 : 1;
                cast.actors[i].poses[0] = theatre::poseOf(body, body.restPose({0, 1, z}, {1, 0, 0, 0}));
            }
            ShadowSource source = sourceOf(cast);
            source.lamps[0].size = size;
            source.lamps[0].light = {0.8f, 0.8f, 0.8f};
            source.lamps[0].actors = {{0.5f, 0, 0}, {0, 0, 0.5f}};
            DrawnOutput output(kSize, upright(), {source});
            const RgbaImage& image = output.frame({{0, 1}});
            const glm::ivec2 breast(kSize.x / 2, static_cast<int>((kTo.y - 1.2) / kPixel));
            const auto half = static_cast<int>(std::lround(255 * srgbFromLinear(0.5f)));
            for (int y = -9; y <= 9; ++y)
                for (int x = -9; x <= 9; ++x) {
                    const Rgba8 pixel = image.at(breast.x + x, breast.y + y);
                    ASSERT_NEAR(pixel.r, swapped ? half : 0, 3);
                    ASSERT_NEAR(pixel.b, swapped ? 0 : half, 3);
                    ASSERT_EQ(pixel.g, 0);
                }
        }
}

TEST(Shadow, of_several_lamps_is_where_each_of_them_is_kept_off) {
    ShadowSource source = sourceOf(aWall(2));
    source.lamps[0].light = {0.5f, 0.3f, 0.1f};
    source.lamps[0].shadow = {0, 0, 0.05f};
    source.lamps.push_back({{-2, 1.25, 6}, 0, {0.2f, 0.4f, 0.3f}, glm::vec3(0), {}});
    DrawnOutput output(kSize, upright(), {source});
    const RgbaImage& image = output.frame({{0, 1}});
    const auto colourAt = [&](double x) {
        const Rgba8 pixel = image.at(static_cast<int>((x - kFrom.x) / kPixel), kSize.y / 2);
        glm::vec3 light;
        for (int i = 0; i < 3; ++i)
            light[i] =
                linearFromSrgb(static_cast<float>(std::array{pixel.r, pixel.g, pixel.b}[static_cast<std::size_t>(i)]) / 255);
        return light;
    };
    // The wall is at x 0 .. 0.8, z = 2. Its shadow is x 0 .. 1.2 for the middle lamp, and x 1 ..
    // 2.2 for the left one.
    const auto near = [](glm::vec3 a, glm::vec3 b) { return glm::distance(a, b) < 0.01f; };
    EXPECT_TRUE(near(colourAt(-1), {0.7f, 0.7f, 0.4f}));
    EXPECT_TRUE(near(colourAt(0.5), {0.2f, 0.4f, 0.35f}));
    EXPECT_TRUE(near(colourAt(1.1), {0, 0, 0.05f}));
    EXPECT_TRUE(near(colourAt(1.8), {0.5f, 0.3f, 0.1f}));
}

// Outside a projector's picture the screen is black, whatever the light's colour.
TEST(Shadow, is_seen_in_the_projectors_picture_alone) {
    Cast cast = aWall(2);
    cast.stage.beams[0].lit = theatre::Stage::Area{{-1.5, 0.2}, {1.9, 2.2}};
    ShadowSource source = sourceOf(cast);
    source.lamps[0].shadow = glm::vec3(0.2f);
    DrawnOutput output(kSize, upright(), {source});
    const RgbaImage& image = output.frame({{0, 1}});
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x) {
            const glm::dvec2 at(kFrom.x + (x + 0.5) * kPixel, kTo.y - (y + 0.5) * kPixel);
            const bool inside = at.x > -1.5 + kPixel && at.x < 1.9 - kPixel && at.y > 0.2 + kPixel && at.y < 2.2 - kPixel;
            const bool outside = at.x < -1.5 - kPixel || at.x > 1.9 + kPixel || at.y < 0.2 - kPixel || at.y > 2.2 + kPixel;
            if (inside) {
                ASSERT_GT(lightAt(image, x, y), 0.15) << x << ", " << y;
            }
            if (outside) {
                ASSERT_EQ(image.at(x, y).g, 0) << x << ", " << y;
            }
        }
}

// Screens of further beams, and curved screens, which the canvas shows unrolled: every pixel is
// compared with the ray from the lamp to its place. Example failures: a second screen shows the
// image of the first; a screen is turned the wrong way round; a curve has the wrong sign.
TEST(Shadow, falls_on_the_screen_of_its_beam) {
    for (const double radius : {0.0, 3.5, -4.0})
        for (const std::size_t beam : {std::size_t{0}, std::size_t{1}}) {
            Cast cast = aCast(6, 1, 11);
            furnish(cast);
            cast.stage.screens[0].radius = radius;
            cast.stage.screens.push_back({{2.6, 2.2}, -1.4, radius});
            cast.stage.beams.push_back({{-5.5, 0.6, 1.6}, 1, {}});
            if (radius > 0) cast.stage.beams[0].lit = cast.stage.beams[1].lit = theatre::Stage::Area{{-2.1, 0.1}, {1.7, 2.3}};
            const glm::dvec3 lamp = cast.stage.beams[beam].light;
            ShadowSource source = sourceOf(cast);
            source.beam = beam;
            source.lamps[0].place = lamp;
            const theatre::Screen& screen = cast.stage.screenOf(beam);
            DrawnOutput output(kSize, upright(), {source});
            const RgbaImage& image = output.frame({{0, 1}});

            // A finer mask of the flat screen, looked up where the ray to the place on the curved
            // screen meets it.
            constexpr double kFine = 0.004;
            const ScreenFrame flat(cast.stage, -6, 5, kFine, 3000, 1400, beam);
            const BitMask mask = solversShadow(cast, 0, false, flat);
            const glm::dvec3 light = cast.stage.lightOnScreen(beam);
            std::int64_t both = 0, either = 0;
            for (int y = 0; y < kSize.y; ++y)
                for (int x = 0; x < kSize.x; ++x) {
                    const glm::dvec2 place(kFrom.x + (x + 0.5) * kPixel, kTo.y - (y + 0.5) * kPixel);
                    const auto onFlat = theatre::flatFromUnrolled(screen, light, place);
                    bool wanted = true;  // dark where no light reaches
                    if (onFlat) {
                        const glm::ivec2 pixel(glm::floor(flat.pixelAt(onFlat->x, onFlat->y)));
                        const auto& lit = cast.stage.beams[beam].lit;
                        wanted = (lit && lit->outside(*onFlat) > 0) ||
                                 (pixel.x >= 0 && pixel.y >= 0 && pixel.x < 3000 && pixel.y < 1400 && mask.at(pixel.x, pixel.y));
                    }
                    const bool drawn = lightAt(image, x, y) < 0.6;
                    both += drawn && wanted, either += drawn || wanted;
                }
            ASSERT_GT(either, 5000);
            EXPECT_GT(static_cast<double>(both) / static_cast<double>(either), 0.985) << "radius " << radius << ", beam " << beam;
        }
}

// Actors behind the lamp or far beside the screen throw no shadow.
TEST(Shadow, of_what_is_behind_the_lamp_is_none) {
    Cast cast = aCast(2, 1, 5);
    for (Cast::Actor& actor : cast.actors) actor.poses[0].root.z = 8.5;
    DrawnOutput output(kSize, upright(), {sourceOf(cast)});
    for (const Rgba8 pixel : output.frame({{0, 1}}).pixels()) ASSERT_EQ(pixel.g, 255);
}

}  // namespace
}  // namespace fantascope::render
