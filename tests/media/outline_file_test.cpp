#include "media/outline_file.h"

#include "core/random.h"
#include "media/image.h"
#include "scratch_folder.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace fantascope {
namespace {

using testing::AllOf;
using testing::HasSubstr;

double area(const Outline& outline) {
    double sum = 0;
    const TriangleMesh mesh = filled(outline);
    for (const glm::uvec3 t : mesh.triangles)
        sum += glm::cross(mesh.vertices[t.y] - mesh.vertices[t.x], mesh.vertices[t.z] - mesh.vertices[t.x]).z / 2.0;
    return sum;
}

// The bounding box: the lower left point and the size.
struct Box {
    glm::dvec2 least{1e9}, most{-1e9};
    glm::dvec2 size() const { return most - least; }
};
Box boxOf(const Outline& outline) {
    Box box;
    for (const auto& ring : outline.rings)
        for (const glm::dvec2 point : ring) box = {glm::min(box.least, point), glm::max(box.most, point)};
    return box;
}

using Inside = std::function<bool(glm::dvec2)>;  // a point in pixels, y down

// A picture of a region, black on white; each pixel's grey is its covered share (on a raster of 8 x
// 8).
GreyImage drawn(int width, int height, const Inside& inside, bool smooth = true) {
    GreyImage image(width, height);
    const int steps = smooth ? 8 : 1;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            int covered = 0;
            for (int i = 0; i < steps * steps; ++i)
                covered += inside({x + (i % steps + 0.5) / steps, y + (i / steps + 0.5) / steps});
            image.at(x, y) = 1 - static_cast<float>(covered) / static_cast<float>(steps * steps);
        }
    return image;
}
Inside disc(double radius, glm::dvec2 centre) {
    return [=](glm::dvec2 point) { return glm::distance(point, centre) < radius; };
}

class OutlineFileTest : public testing::Test {
protected:
    Outline png(const GreyImage& image) const {
        EXPECT_TRUE(writePng(folder_ / "a.png", image));
        return readOutline(folder_ / "a.png").value();
    }
    Outline png(const RgbaImage& image) const {
        EXPECT_TRUE(writePng(folder_ / "a.png", image));
        return readOutline(folder_ / "a.png").value();
    }
    static std::string svgOf(const std::string& body) {
        return R"(<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 200">)" + body + "</svg>";
    }
    Outline svg(const std::string& body) const { return readOutline(folder_.file("a.svg", svgOf(body))).value(); }
    std::string refusal(const std::string& name, std::string_view bytes) const {
        const auto outline = readOutline(folder_.file(name, bytes));
        return outline ? "accepted" : folder_.relative(outline.error().message());
    }
    std::string refusal(const RgbaImage& image) const {
        EXPECT_TRUE(writePng(folder_ / "a.png", image));
        return refusal("a.png", readFile(folder_ / "a.png").value());
    }

    const ScratchFolder folder_;
};

TEST_F(OutlineFileTest, an_ending_says_what_is_an_outline) {
    for (const char* name : {"a.svg", "a.SVG", "a.png", "b/a.jpeg", "a.tif"}) EXPECT_TRUE(isOutlineFile(name)) << name;
    for (const char* name : {"a.obj", "a.fbx", "svg", "a.svg.glb"}) EXPECT_FALSE(isOutlineFile(name)) << name;
}

// Example failure: the outline follows the pixels, with a corner at each.
TEST_F(OutlineFileTest, the_outline_of_a_small_picture_is_smooth_to_a_fraction_of_a_pixel) {
    for (const bool smooth : {true, false}) {
        SCOPED_TRACE(smooth ? "smoothed edges" : "edges of whole pixels");
        const Outline outline = png(drawn(64, 48, disc(18.3, {31.4, 22.7}), smooth));
        ASSERT_EQ(outline.rings.size(), 1u);
        EXPECT_LE(outline.pointCount(), 60u);
        const Box box = boxOf(outline);
        const glm::dvec2 centre = (box.least + box.most) / 2.0;
        const auto& ring = outline.rings[0];
        for (std::size_t i = 0; i < ring.size(); ++i)
            for (const glm::dvec2 point : {ring[i], (ring[i] + ring[(i + 1) % ring.size()]) / 2.0})
                EXPECT_NEAR(glm::distance(point, centre) * 64, 18.3, smooth ? 0.45 : 0.8);
        EXPECT_NEAR(area(outline) * 64 * 64, std::numbers::pi * 18.3 * 18.3, smooth ? 20 : 30);
    }
}

TEST_F(OutlineFileTest, dark_on_light_light_on_dark_and_opaque_on_transparent_are_one) {
    const GreyImage dark = drawn(90, 60, [](glm::dvec2 p) { return p.x > 10 && p.x < 50 && p.y > 20 && p.y < 50; });
    GreyImage light = dark, pale = dark;
    RgbaImage clear(90, 60), coloured(90, 60);
    for (std::size_t i = 0; i < dark.pixels().size(); ++i) {
        const float value = dark.pixels()[i];
        light.pixels()[i] = 1 - value;
        pale.pixels()[i] = 0.9f + 0.1f * value - 0.2f * (1 - value);
        clear.pixels()[i] = {7, 80, 7, static_cast<std::uint8_t>(255 * (1 - value))};
        coloured.pixels()[i] = value > 0.5f ? Rgba8{250, 240, 30, 255} : Rgba8{120, 0, 60, 255};
    }
    for (const Outline& outline : {png(dark), png(light), png(pale), png(clear), png(coloured)}) {
        const Box box = boxOf(outline);
        EXPECT_NEAR(box.size().x * 90, 40, 0.5);
        EXPECT_NEAR(box.size().y * 90, 30, 0.5);
        EXPECT_EQ(outline.rings.size(), 1u);
        EXPECT_LE(outline.pointCount(), 12u);
    }
}

// Example failure: the shape is upside down, because rows run down.
TEST_F(OutlineFileTest, up_in_the_picture_is_up) {
    const Outline tip = png(drawn(80, 80, [](glm::dvec2 p) { return std::abs(p.x - 40) < (p.y - 10) / 2 && p.y < 70; }));
    const Box box = boxOf(tip);
    for (const glm::dvec2 point : tip.rings.at(0))
        if (point.y > box.most.y - 0.1) {
            EXPECT_NEAR(point.x, (box.least.x + box.most.x) / 2, 0.1) << "the tip is above";
        }
}

TEST_F(OutlineFileTest, holes_stay_specks_go_and_an_edge_ends_what_it_cuts) {
    const auto ring = [](glm::dvec2 p) {
        const double r = glm::distance(p, {100, 60});
        return (r > 25 && r < 50) || (p.x < 2 && p.y < 2) || glm::distance(p, {30, 30}) < 1;
    };
    const Outline outline = png(drawn(200, 120, ring));
    EXPECT_EQ(outline.rings.size(), 2u);
    EXPECT_NEAR(area(outline) * 200 * 200, std::numbers::pi * (2500 - 625), 100);
    // Half a disc, cut off by the left edge of the picture.
    const Outline cut = png(drawn(100, 100, disc(30, {0, 50})));
    EXPECT_NEAR(area(cut) * 100 * 100, std::numbers::pi * 900 / 2, 30);
}

// Even-odd filling, a transform, a stroke: what a drawing program displays counts, not how the file
// is written.
TEST_F(OutlineFileTest, an_svg_is_what_it_shows) {
    const std::string frames = "M-20 -20 H20 V20 H-20 Z M-10 -10 H10 V10 H-10 Z";
    const Outline frame =
        svg("<g transform='translate(50 100) rotate(30) scale(2)'><path fill-rule='evenodd' d='" + frames + "'/></g>");
    ASSERT_EQ(frame.rings.size(), 2u);
    EXPECT_EQ(frame.pointCount(), 8u);
    const double side = 80 * (std::cos(std::numbers::pi / 6) + 0.5);  // of the box around the turned square
    EXPECT_NEAR(area(frame) * side * side, 80 * 80 - 40 * 40, 40);

    const Outline stroke = svg(R"(<path d="M10 20 H90" stroke="red" stroke-width="8" fill="none"/>)");
    EXPECT_NEAR(boxOf(stroke).size().y / boxOf(stroke).size().x, 0.1, 0.003);

    const Outline two = svg(R"(<rect x="10" y="10" width="40" height="40"/><rect x="30" y="30" width="40" height="40"/>)");
    EXPECT_EQ(two.rings.size(), 1u) << "what overlaps is one";
    EXPECT_NEAR(area(two), (1600 + 1600 - 400) / 3600.0, 0.01);
}

TEST_F(OutlineFileTest, an_svg_may_fill_its_page_or_lie_on_a_ground_or_be_a_speck_on_it) {
    EXPECT_NEAR(area(svg(R"(<rect width="100" height="200"/>)")), 0.5, 0.003);
    const Outline onGround = svg(R"(<rect width="100" height="200" fill="#fff"/><circle cx="50" cy="50" r="40" fill="#333"/>)");
    EXPECT_NEAR(area(onGround) * 200 * 200, std::numbers::pi * 1600, 75);
    const Outline small = svg(R"(<circle cx="3" cy="190" r=".5"/>)");
    const glm::dvec2 box = boxOf(small).size();
    EXPECT_NEAR(area(small) / (box.x * box.y), std::numbers::pi / 4, 0.02);
    EXPECT_GE(small.pointCount(), 20u) << "drawn as large as it can be before it is traced";
}

// Every point costs a triangle in each of a thousand copies.
TEST_F(OutlineFileTest, points_are_few_however_intricate_the_drawing) {
    std::string path = "M50 100";
    for (int i = 0; i < 300; ++i) {
        const double angle = i * 2 * std::numbers::pi / 300, radius = i % 2 == 0 ? 45 : 40;
        path += " L" + std::to_string(50 + radius * std::cos(angle)) + " " + std::to_string(100 + radius * std::sin(angle));
    }
    EXPECT_LE(svg("<path d=\"" + path + "\"/>").pointCount(), 80u);
}

TEST_F(OutlineFileTest, what_shows_no_shape_is_refused_with_the_reason) {
    EXPECT_THAT(refusal(RgbaImage(40, 30, {200, 10, 10, 255})), HasSubstr("a.png: is of one colour; draw the shape on"));
    EXPECT_THAT(refusal(RgbaImage(40, 30, {200, 10, 10, 0})), HasSubstr("a.png: shows nothing that has an area"));
    EXPECT_THAT(refusal(RgbaImage(1, 1)), HasSubstr("of one colour"));
    EXPECT_THAT(refusal("a.svg", svgOf("")), HasSubstr("a.svg: draws nothing that has an area"));
    EXPECT_THAT(refusal("a.svg", svgOf(R"(<path d="M10 10 H90"/>)")), HasSubstr("a.svg: draws nothing that has an area"));
    EXPECT_THAT(refusal("a.svg", svgOf(R"(<path d="M1 1 H9" stroke="red" stroke-width=".001"/>)")),
                HasSubstr("nothing that has an area"));
    EXPECT_THAT(refusal("a.svg", svgOf(R"(<path d="MNaN inf LZ"/>)")), HasSubstr("draws nothing"));

    RgbaImage noise(400, 400);
    Rng rng(3);
    for (Rgba8& pixel : noise.pixels()) pixel.a = rng.below(100) < 40 ? 255 : 0;
    EXPECT_THAT(refusal(noise), HasSubstr("a.png: is too intricate"));
}

TEST_F(OutlineFileTest, what_is_no_drawing_is_refused_with_its_name) {
    EXPECT_THAT(refusal("a.svg", ""), HasSubstr("a.svg: not an SVG that can be read"));
    EXPECT_THAT(refusal("a.svg", "words"), HasSubstr("a.svg: not an SVG that can be read"));
    EXPECT_THAT(refusal("a.svg", "<html><body/></html>"), HasSubstr("a.svg: not an SVG that can be read"));
    const std::string whole = svgOf(R"(<circle cx="3" cy="190" r=".5"/>)");
    EXPECT_THAT(refusal("a.svg", whole.substr(0, whole.size() - 8)),
                AllOf(HasSubstr("a.svg: not an SVG"), testing::Not(HasSubstr("\n"))));
    EXPECT_THAT(refusal("a.png", "words"), HasSubstr("a.png: not a picture"));
    ASSERT_TRUE(writePng(folder_ / "b.png", drawn(64, 64, disc(20, {32, 32}))));
    const std::string png = readFile(folder_ / "b.png").value();
    EXPECT_THAT(refusal("a.png", png.substr(0, png.size() / 2)), HasSubstr("truncated"));
    EXPECT_THAT(readOutline(folder_ / "none.svg").error().message(), HasSubstr("none.svg: cannot be read"));
}

}  // namespace
}  // namespace fantascope
