// Pictures on surfaces and reliefs: what a camera sees of them, and where they are.

#include "drivers/site/camera_view.h"
#include "drivers/site/objects.h"

#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <numbers>

namespace fantascope::site {
namespace {

using testing::HasSubstr;

constexpr float kPi = std::numbers::pi_v<float>;
const Rectangle kWall{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}};

// A camera that sees just the wall of two metres in 32 x 32 pixels.
vision::CameraModel camera() {
    return vision::CameraModel::fromFieldOfView(Pose::lookingAt({0, 0, 3}, {0, 0, 0}).value(), {32, 32}, 2 * std::atan(1.0 / 3))
        .value();
}

RgbaImage picture(int width, int height, const std::vector<int>& greys) {
    RgbaImage image(width, height);
    for (std::size_t i = 0; i < greys.size(); ++i) {
        const auto grey = static_cast<std::uint8_t>(greys[i]);
        image.pixels()[i] = {grey, grey, grey, 255};
    }
    return image;
}

SceneObject textured(const Rectangle& rectangle, const RgbaImage& image, std::optional<glm::dvec2> tile = {}) {
    SceneObject object{{{rectangle.corner, rectangle.corner + rectangle.right, rectangle.corner + rectangle.right + rectangle.up,
                         rectangle.corner + rectangle.up},
                        {{0, 1, 2}, {0, 2, 3}}},
                       glm::vec3(0.8f)};
    object.texture = std::make_shared<const Texture>(image, rectangle, tile);
    return object;
}

// The share of light that the surface reflects, at each camera pixel.
Image<glm::vec3> reflectances(const Scene& scene, const vision::CameraModel& from) {
    CameraView view(scene, from, glm::dvec3(1), {0, 0, 0});
    Image<glm::vec3> luminance(from.size.x, from.size.y);
    view.render({}, {}, 0, luminance);
    for (glm::vec3& pixel : luminance.pixels()) pixel *= kPi;
    return luminance;
}

SceneObject read(const std::string& text, const std::filesystem::path& folder) {
    return readObject(ConfigNode::parse("name: x\n" + text, folder / "site.yaml").value()).value();
}

// Example failure: the picture is mirrored, or upside down, or its stored values are taken as
// light.
TEST(SiteTexture, covers_its_rectangle_once_and_upright) {
    const Scene scene({textured(kWall, picture(2, 2, {255, 128, 64, 0}))});
    const auto seen = reflectances(scene, camera());
    EXPECT_NEAR(seen.at(3, 3).g, 0.8, 1e-4);
    EXPECT_NEAR(seen.at(28, 3).g, 0.8 * linearFromSrgb(128 / 255.0f), 1e-4);
    EXPECT_NEAR(seen.at(3, 28).g, 0.8 * linearFromSrgb(64 / 255.0f), 1e-4);
    EXPECT_NEAR(seen.at(28, 28).g, 0, 1e-4);
    EXPECT_NEAR((seen.at(15, 3).g + seen.at(16, 3).g) / 2, 0.4 * (1 + linearFromSrgb(128 / 255.0f)), 1e-3)
        << "half way between two pixels";
}

TEST(SiteTexture, repeats_from_the_corner_at_its_size) {
    // A tile of one metre: four pixels of a metre's quarter, of which the first is bright.
    const Scene scene({textured(kWall, picture(4, 1, {255, 0, 0, 0}), glm::dvec2(1, 0.3))});
    const auto seen = reflectances(scene, camera());
    for (const int y : {0, 7, 30})
        for (const int x : {2, 18}) {
            EXPECT_NEAR((seen.at(x - 1, y).g + seen.at(x, y).g + seen.at(x + 1, y).g + seen.at(x + 2, y).g) / 4, 0.5, 0.15);
            EXPECT_NEAR(seen.at(x + 8, y).g, 0, 1e-4) << x << " " << y;
        }
}

// A tile of a millimetre on a rectangle of a kilometre repeats a million times each way. Example
// failure: the number of a pixel overflows.
TEST(SiteTexture, repeats_far_from_the_corner_as_near) {
    const Rectangle field{{0, 0, 0}, {1000, 0, 0}, {0, 1000, 0}};
    const Texture texture(picture(4, 1, {255, 0, 0, 0}), field, glm::dvec2(0.001));
    for (const double x : {0.000125, 500.000125, 999.999125}) {
        EXPECT_NEAR(texture.around({x, 999.9, 0}, glm::dvec3(0), 1e-6).g, 1, 1e-3) << x;
        EXPECT_NEAR(texture.around({x + 0.0005, 999.9, 0}, glm::dvec3(0), 1e-6).g, 0, 1e-3) << x;
    }
    EXPECT_NEAR(texture.around({500, 500, 0}, {0.3, 0, 0}, 0.3).g, 0.25, 1e-3) << "the mean of the tile";
}

// The cells of these checks are far finer than the camera's pixels. One look per pixel would turn
// them into moire, on the ground above all, where a pixel is many times as long as wide.
TEST(SiteTexture, is_even_where_it_is_finer_than_the_camera) {
    RgbaImage checks(301, 299);
    for (int y = 0; y < checks.height(); ++y)
        for (int x = 0; x < checks.width(); ++x)
            if ((x + y) % 2 == 0) checks.at(x, y) = {255, 255, 255, 255};
    const auto wall = reflectances(Scene({textured(kWall, checks)}), camera());
    for (const glm::vec3& pixel : wall.pixels()) EXPECT_NEAR(pixel.g, 0.4, 0.02);

    const Rectangle ground{{-40, 0, 0}, {80, 0, 0}, {0, 0, -80}};
    const auto along =
        vision::CameraModel::fromFieldOfView(Pose::lookingAt({0, 1.5, 0}, {0, 0, -8}).value(), {32, 16}, 0.5).value();
    RgbaImage stripes(8, 8);  // across the view, two centimetres each
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; y += 2) stripes.at(x, y) = {255, 255, 255, 255};
    const auto far = reflectances(Scene({textured(ground, stripes, glm::dvec2(0.16))}), along);
    for (const glm::vec3& pixel : far.pixels()) EXPECT_NEAR(pixel.g, 0.4, 0.02);
}

// Grey 0 .. 1 over two pixels: flat up to the first centre, then a slope to the second.
TEST(SiteRelief, moves_the_grid_along_the_normal_by_the_grey_value) {
    const ScratchFolder folder;
    ASSERT_TRUE(writePng(folder / "bumps.png", picture(2, 1, {0, 255})));
    const SceneObject object = read(
        "rectangle: {corner: [0, 1, 0], right: [4, 0, 0], up: [0, 0, -2], relief: {picture: bumps.png, depth: 0.5, grid: [8, "
        "1]}}",
        folder.path());
    EXPECT_EQ(object.mesh.vertices.size(), 18u);
    EXPECT_EQ(object.mesh.triangles.size(), 16u);
    const Scene scene({object});
    const auto heightAt = [&](float x) { return scene.nearest({x, 10, -0.7f}, {0, -1, 0}).value().point.y; };
    EXPECT_NEAR(heightAt(0.5f), 1, 1e-5);
    EXPECT_NEAR(heightAt(1.5f), 1.125, 1e-5);
    EXPECT_NEAR(heightAt(2), 1.25, 1e-5);
    EXPECT_NEAR(heightAt(2.75f), 1.4375, 1e-5);
    EXPECT_NEAR(heightAt(3.5f), 1.5, 1e-5);
}

// Example failure: the picture is stretched over the slope.
TEST(SiteRelief, leaves_the_texture_where_it_is_on_the_rectangle) {
    const ScratchFolder folder;
    ASSERT_TRUE(writePng(folder / "bumps.png", picture(2, 1, {0, 255})));
    ASSERT_TRUE(writePng(folder / "paint.png", picture(4, 1, {0, 255, 0, 255})));
    const SceneObject object = read(
        "rectangle: {corner: [0, 0, 0], right: [4, 0, 0], up: [0, 0, -2], texture: paint.png, "
        "relief: {picture: bumps.png, depth: -1.5, grid: [64, 2]}}",
        folder.path());
    const Scene scene({object});
    const auto hit = scene.nearest({2.5f, 10, -1}, {0, -1, 0}).value();
    EXPECT_LT(hit.point.y, -0.8);
    ASSERT_NE(hit.texture, nullptr);
    EXPECT_NEAR(hit.texture->around(hit.point, glm::dvec3(0), 0.001).g, 0, 1e-4);
    EXPECT_NEAR(hit.texture->around({3.5, hit.point.y, -1}, glm::dvec3(0), 0.001).g, 1, 1e-4);
}

TEST(SiteTexture, refuses_what_cannot_be_laid_on_a_rectangle) {
    const ScratchFolder folder;
    ASSERT_TRUE(writePng(folder / "grey.png", picture(2, 1, {0, 255})));
    const auto refusal = [&](const std::string& more) {
        const std::string text = "name: x\nrectangle: {corner: [0, 0, 0], right: [1, 0, 0], up: [0, 1, 0], " + more + "}\n";
        const auto object = readObject(ConfigNode::parse(text, folder / "site.yaml").value());
        return object ? "accepted" : object.error().message();
    };
    EXPECT_EQ(refusal("texture: grey.png, texture_size: [1, 2]"), "accepted");
    EXPECT_THAT(refusal("texture_size: [1, 2]"), HasSubstr("'texture_size' needs a 'texture'"));
    EXPECT_THAT(refusal("texture: grey.png, texture_size: [1, 0]"), HasSubstr("rectangle.texture_size[1]: 0 is out of range"));
    EXPECT_THAT(refusal("texture: none.png"), HasSubstr("none.png"));
    EXPECT_THAT(refusal("relief: {picture: grey.png, depth: 1}"), HasSubstr("'grid' is missing"));
    EXPECT_THAT(refusal("relief: {picture: grey.png, depth: 1, grid: [300, 1]}"),
                HasSubstr("relief.grid[0]: 300 is out of range"));
    EXPECT_THAT(refusal("relief: {picture: none.png, depth: 1, grid: [3, 1]}"), HasSubstr("none.png"));
}

}  // namespace
}  // namespace fantascope::site
