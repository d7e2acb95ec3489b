#include "app/export/light_preview.h"

#include "app/export/off_screen.h"
#include "app/live/programme.h"
#include "app/video_reader.h"

#include "program.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr glm::ivec2 kSize(160, 90), kFrame(64, 36);

// Appends an upright sheet that faces +z.
void addSheet(TriangleMesh& mesh, glm::vec3 middle, float halfWidth, float halfHeight) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const glm::vec2 corner : {glm::vec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
        mesh.vertices.push_back(middle + glm::vec3(corner.x * halfWidth, corner.y * halfHeight, 0));
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    mesh.triangles.emplace_back(first, first + 2, first + 3);
}

TriangleMesh wallWithABoard() {
    TriangleMesh mesh;
    addSheet(mesh, {0, 0, 0}, 3, 3);
    addSheet(mesh, {0, 0, 1}, 0.5f, 0.5f);
    return mesh;
}

std::shared_ptr<const RgbaImage> plain(std::uint8_t value) {
    return std::make_shared<const RgbaImage>(kFrame.x, kFrame.y, Rgba8{value, value, value, 255});
}

RgbaImage drawn(const TriangleMesh& mesh, const PreviewPlaces& places, std::uint8_t frame, int threads = 2) {
    return LightPreview::create(mesh, places, kFrame, kSize, LightPreview::Use::Still, threads).value().draw(plain(frame));
}

// The picture of a viewer at `from` who looks at the origin, asked by points of the world.
struct Seen {
    RgbaImage picture;
    vision::CameraModel viewer;

    Seen(const TriangleMesh& mesh, PreviewPlaces places, std::uint8_t frame)
        : picture(drawn(mesh, places, frame)),
          viewer(
              vision::CameraModel::fromFieldOfView(Pose::lookingAt(*places.viewer, {0, 0, 0}).value(), kSize, places.fieldOfView)
                  .value()) {}
    int at(glm::dvec3 point) const {
        const glm::ivec2 pixel = viewer.pixelFromWorld(point).value();
        return picture.at(pixel.x, pixel.y).g;
    }
};

PreviewPlaces fromTheFront(glm::dvec3 viewer) {
    PreviewPlaces places;
    places.projector = {0, 0, 5};
    places.throwRatio = 0.6;
    places.lookAt = places.viewerLookAt = {0, 0, 0};
    places.viewer = viewer;
    places.fieldOfView = radians(60);
    return places;
}

// Example failures: light through the board, a shadow where the viewer's is and not the
// projector's.
TEST(LightPreview, what_the_projector_does_not_see_gets_no_light) {
    const PreviewPlaces places = fromTheFront({3, 0, 5});
    const Seen lit(wallWithABoard(), places, 255), dark(wallWithABoard(), places, 0);
    // The board of a metre throws a shadow of 1.25 m; the viewer at its side sees its right half.
    for (const glm::dvec3 hidden : {glm::dvec3(0.3, 0, 0), {0.5, 0.5, 0}, {0.5, -0.5, 0}})
        EXPECT_EQ(lit.at(hidden), dark.at(hidden));
    for (const glm::dvec3 open : {glm::dvec3(0.8, 0, 0), {0.3, 0.8, 0}, {0.3, -0.8, 0}, {0, 0, 1}})
        EXPECT_GT(lit.at(open), dark.at(open) + 100);
}

TEST(LightPreview, light_does_not_come_through_to_a_back) {
    TriangleMesh sheet;
    addSheet(sheet, {0, 0, 0}, 3, 3);
    const PreviewPlaces behind = fromTheFront({1, 0, -5}), before = fromTheFront({1, 0, 5});
    EXPECT_EQ(drawn(sheet, behind, 255), drawn(sheet, behind, 0));
    EXPECT_NE(drawn(sheet, before, 255), drawn(sheet, before, 0));
}

// A statue of 200 units in millimetres is no other statue than one of 0.2 in metres.
TEST(LightPreview, does_not_care_for_the_meshs_unit) {
    const RgbaImage metres = drawn(wallWithABoard(), fromTheFront({3, 1, 5}), 255);
    for (const double scale : {1e-3, 1e3}) {
        TriangleMesh mesh = wallWithABoard();
        for (glm::vec3& vertex : mesh.vertices) vertex *= static_cast<float>(scale);
        PreviewPlaces places = fromTheFront({3, 1, 5});
        for (auto* place : {&places.projector, &places.viewer}) **place *= scale;
        const RgbaImage picture = drawn(mesh, places, 255);
        int apart = 0;
        for (std::size_t i = 0; i < picture.pixels().size(); ++i)
            apart += std::abs(picture.pixels()[i].g - metres.pixels()[i].g) > 2;
        EXPECT_LE(apart, 20) << scale << ": pixels on edges";
    }
}

TEST(LightPreview, by_default_all_of_the_mesh_is_seen_and_lit) {
    const RgbaImage picture = drawn(wallWithABoard(), {}, 255), dark = drawn(wallWithABoard(), {}, 0);
    const Rgba8 background = picture.at(0, 0);
    int mesh = 0, lit = 0;
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x) {
            const bool rim = x == 0 || y == 0 || x == kSize.x - 1 || y == kSize.y - 1;
            if (rim) {
                EXPECT_EQ(picture.at(x, y), background);
            }
            mesh += picture.at(x, y) != background;
            lit += picture.at(x, y).g > dark.at(x, y).g + 50;
        }
    EXPECT_GT(mesh, kSize.x * kSize.y / 5);
    EXPECT_GT(lit, 0.85 * mesh) << "all but the board's shadow";
}

TEST(LightPreview, is_the_same_on_any_number_of_threads_and_as_a_film) {
    const RgbaImage one = drawn(wallWithABoard(), {}, 200, 1);
    EXPECT_EQ(one, drawn(wallWithABoard(), {}, 200, 3));
    auto film = LightPreview::create(wallWithABoard(), {}, kFrame, kSize, LightPreview::Use::Film, 2).value();
    film.draw(plain(10));
    const RgbaImage second = film.draw(plain(200));
    double sum = 0;
    for (std::size_t i = 0; i < one.pixels().size(); ++i) sum += std::abs(one.pixels()[i].g - second.pixels()[i].g);
    EXPECT_LT(sum / static_cast<double>(one.pixels().size()), 1.0) << "fewer samples, at the edges";
}

class PreviewCommand : public testing::Test {
protected:
    // 3.2 m x 1.8 m, in z = 0.
    PreviewCommand() { folder_.file("wall.obj", "v -1.6 -0.9 0\nv 1.6 -0.9 0\nv 1.6 0.9 0\nv -1.6 0.9 0\nf 1 2 3 4\n"); }
    Outcome preview(const std::string& file, const std::vector<std::string>& more) const {
        std::vector<std::string> arguments = {"preview", kPattern, "--scene", "wall.obj", "--size", "320x180", "-o", file};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return runProgram(arguments, folder_.path());
    }
    const std::string kPattern = sourceFolder() + "/shows/light-movement/left.pattern.yaml";
    // Projector and viewer on one spot in front of the wall, each with a picture that just fits it:
    // atan(1.6 / 4) to either side.
    const std::vector<std::string> kSquarely = {"--projector",     "0,0,4",        "--throw",   "1.25", "--viewer",  "0,0,4",
                                                "--field-of-view", "43.602818972", "--seconds", "3",    "--ambient", "0.05"};
    const ScratchFolder folder_;
};

// Example failures: mirrored, upside down, stretched, or another moment.
TEST_F(PreviewCommand, a_wall_that_faces_the_projector_shows_the_pattern_as_it_is) {
    const Outcome done = preview("p.png", kSquarely);
    ASSERT_THAT(done, exits(0));
    const RgbaImage picture = readRgba(folder_ / "p.png").value();
    const auto source = readPatternSource(kPattern).value();
    const RgbaImage pattern = OffScreen::open(glm::ivec2(320, 180), render::PictureSources::numbered({source}))
                                  .value()
                                  ->draw({{{0, 1.0f}}}, {}, std::chrono::seconds(3));
    const auto apart = [&](auto columnOf) {
        double sum = 0;
        for (int y = 0; y < 180; ++y)
            for (int x = 0; x < 320; ++x) {
                const float light = linearFromSrgb(picture.at(x, y).g / 255.0f);
                sum += std::abs(light - 0.95f * linearFromSrgb(pattern.at(columnOf(x), y).g / 255.0f));
            }
        return sum / (320 * 180);
    };
    const double mirrored = apart([](int x) { return 319 - x; });
    EXPECT_LT(apart([](int x) { return x; }), 0.06) << "the ambient light, a twentieth, and the edges";
    EXPECT_GT(mirrored, 0.15);
    EXPECT_GT(apart([](int x) { return std::min(x + 2, 319); }), 1.3 * apart([](int x) { return x; }));
}

TEST_F(PreviewCommand, films_the_sway) {
    std::vector<std::string> arguments = kSquarely;
    arguments[9] = "0.5";  // --seconds
    const Outcome done = preview("p.mp4", arguments);
    ASSERT_THAT(done, exits(0));
    const Video film = readVideo(folder_ / "p.mp4");
    ASSERT_EQ(film.frames.size(), 15u);
    EXPECT_NEAR(film.seconds, 0.5, 1e-3);
    EXPECT_NE(film.frames[0], film.frames[14]);
}

TEST_F(PreviewCommand, takes_a_picture_for_a_pattern) {
    ASSERT_TRUE(writePng(folder_ / "white.png", RgbaImage(32, 18, {255, 255, 255, 255})));
    std::vector<std::string> arguments = {"preview", "white.png", "--scene", "wall.obj", "--size", "320x180", "-o", "p.png"};
    arguments.insert(arguments.end(), kSquarely.begin(), kSquarely.end());
    ASSERT_THAT(runProgram(arguments, folder_.path()), exits(0));
    EXPECT_GT(readRgba(folder_ / "p.png").value().at(160, 90).g, 240);
}

TEST_F(PreviewCommand, refuses_with_advice) {
    EXPECT_THAT(preview("p.gif", {}).errors, HasSubstr("FILE.png"));
    folder_.file("wall.obj", "v 0 0 0\n");
    EXPECT_THAT(preview("p.png", {}).errors, HasSubstr("wall.obj"));
    EXPECT_THAT(preview("p.png", {}), exits(1));
    EXPECT_THAT(preview("p.png", {"--projector", "1,2"}), exits(2));
    folder_.file("wall.obj", "v -1.6 -0.9 0\nv 1.6 -0.9 0\nv 1.6 0.9 0\nf 1 2 3\n");
    EXPECT_THAT(preview("p.png", {"--viewer", "0,0,0", "--viewer-look-at", "0,0,0"}).errors, HasSubstr("the viewer"));
    EXPECT_FALSE(fs::exists(folder_ / "p.png"));
}

}  // namespace
}  // namespace fantascope::app
