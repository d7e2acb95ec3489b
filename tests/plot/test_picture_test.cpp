#include "plot/test_picture.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::plot {
namespace {

using Flip = Orientation::Flip;

constexpr glm::ivec2 kSize{1920, 1080};
constexpr double kAspect = 16.0 / 9;
const std::array<glm::dvec2, 4> kKeystone = {{{103.5, 41.25}, {1811, 12.5}, {1702.75, 1033}, {61, 987.125}}};
constexpr std::array<TestPicture, 8> kAll{TestPicture::None, TestPicture::Grid, TestPicture::Corners, TestPicture::Numbers,
                                          TestPicture::Bars, TestPicture::Ramp, TestPicture::Focus,   TestPicture::Identify};

bool hidesTheShow(TestPicture picture) {
    return picture != TestPicture::None && picture != TestPicture::Bars && picture != TestPicture::Ramp;
}

Projection projection(const WarpShape& shape, glm::ivec2 size = kSize) { return {.size = size, .warp = Warp::of(shape).value()}; }
Projection straight(glm::ivec2 size = kSize) { return {.size = size, .warp = Warp::straight(size)}; }

WarpMesh aMesh(WarpMesh::Between between) {
    return {between,
            {4, 3},
            {{0, 0}, {10, -12}, {20, 10}, {0, 0}, {12, 0}, {40, 30}, {-20, -40}, {-15, 5}, {0, 0}, {0, -30}, {5, 10}, {0, 0}}};
}

int alphaOf(const RgbaImage& picture, int x, int y) { return picture.at(x, y).a; }
int lightOf(const RgbaImage& picture, int x, int y) { return picture.at(x, y).r; }

// The rectangle, from .. to (exclusive), of the pixels that a predicate is true of.
struct Extent {
    glm::ivec2 from{1 << 30}, to{-1};
    bool any() const { return to.x > 0; }
    glm::ivec2 size() const { return to - from; }
};
template <class Predicate>
Extent extentOf(glm::ivec2 size, Predicate predicate) {
    Extent extent;
    for (int y = 0; y < size.y; ++y)
        for (int x = 0; x < size.x; ++x)
            if (predicate(x, y)) extent.from = glm::min(extent.from, {x, y}), extent.to = glm::max(extent.to, {x + 1, y + 1});
    return extent;
}
Extent differenceOf(const RgbaImage& a, const RgbaImage& b) {
    return extentOf({a.width(), a.height()}, [&](int x, int y) { return !(a.at(x, y) == b.at(x, y)); });
}

// How far a line of the canvas is drawn from where the warp has it, at a point of it and across the
// pixels; `kNothing` if there is no light, none if more than this line is near.
constexpr double kNothing = 1e9;
std::optional<double> missAt(const RgbaImage& picture, const Warp& warp, glm::dvec2 canvas, glm::dvec2 along) {
    constexpr double kReach = 0.04;
    const glm::dvec2 direction =
        warp.projectorFromCanvas(canvas + 1e-4 * along) - warp.projectorFromCanvas(canvas - 1e-4 * along);
    const int axis = std::abs(direction.y) > std::abs(direction.x) ? 0 : 1,
              other = 1 - axis;  // which the light is looked at along
    const glm::dvec2 near = warp.projectorFromCanvas(canvas);
    if (near.x < 20 || near.y < 20 || near.x > picture.width() - 20 || near.y > picture.height() - 20) return std::nullopt;
    // The line's point in the middle of a row of pixels, by bisection.
    const double row = std::floor(near[other]) + 0.5;
    double low = -kReach, high = kReach;
    const bool grows = direction[other] > 0;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        ((warp.projectorFromCanvas(canvas + middle * along)[other] < row) == grows ? low : high) = middle;
    }
    const double wanted = warp.projectorFromCanvas(canvas + low * along)[axis];
    double light = 0, moment = 0;
    int runs = 0;
    bool was = false;
    for (int i = -8; i <= 8; ++i) {
        glm::ivec2 pixel;
        pixel[axis] = int(std::floor(wanted)) + i, pixel[other] = int(row);
        const double value = lightOf(picture, pixel.x, pixel.y);
        light += value, moment += value * (pixel[axis] + 0.5);
        runs += value > 0 && !was;
        was = value > 0;
    }
    if (light == 0) return kNothing;
    if (runs > 1 || light > 450)
        return std::nullopt;  // a line is 1.5 pixels of 204 at most; a circle that touches it adds to that
    return moment / light - wanted;
}

// A technician moves a mesh point until a line lies on a ledge: the line has to be where the show
// will be.
TEST(TestPictureGrid, lies_where_the_warp_puts_the_canvas) {
    struct Case {
        const char* what;
        WarpShape shape;
        double aspect = kAspect;
    };
    const std::array<Case, 6> cases{{
        {"keystone", {.corners = kKeystone}},
        {"smooth mesh", {.corners = kKeystone, .mesh = aMesh(WarpMesh::Between::Smooth)}},
        {"straight mesh", {.corners = kKeystone, .mesh = aMesh(WarpMesh::Between::Straight)}},
        {"rear projection",
         {.orientation = {Flip::Horizontal, 0}, .corners = kKeystone, .mesh = aMesh(WarpMesh::Between::Smooth)}},
        {"on its side",
         {.orientation = {Flip::Vertical, 1}, .corners = kKeystone, .mesh = aMesh(WarpMesh::Between::Smooth)},
         9.0 / 16},
        {"a part of a wide canvas", {.part = {{0.3, 0}, {0.75, 1}}, .corners = kKeystone}, 4.1},
    }};
    for (const Case& test : cases) {
        SCOPED_TRACE(test.what);
        const Projection output = projection(test.shape);
        const RgbaImage picture = drawEditView({.projection = output, .aspect = test.aspect, .picture = TestPicture::Grid});
        const CanvasPart& part = test.shape.part;
        int measured = 0, unclear = 0;
        const auto look = [&](glm::dvec2 canvas, glm::dvec2 along) {
            const auto miss = missAt(picture, output.warp, canvas, along);
            if (!miss) return void(++unclear);
            ++measured;
            EXPECT_LT(std::abs(*miss), 0.25) << "at " << canvas.x << ", " << canvas.y << " of the canvas";
        };
        for (int i = 0; i < 100; ++i)
            for (int j = 0; j < 100; ++j) {
                // Halfway between two crossings.
                const glm::dvec2 upright(0.1 * i / test.aspect, 0.1 * j + 0.05), level((0.1 * i + 0.05) / test.aspect, 0.1 * j);
                const auto isInside = [&](glm::dvec2 p) {
                    return glm::all(glm::greaterThan(p, part.low + 0.02)) && glm::all(glm::lessThan(p, part.high - 0.02));
                };
                if (isInside(upright)) look(upright, {0, 1});
                if (isInside(level)) look(level, {1, 0});
            }
        EXPECT_GT(measured, 100);
        EXPECT_LT(unclear, measured / 6);
    }
}

TEST(TestPictureGrid, has_circles_that_are_round_whatever_part_of_the_canvas_is_shown) {
    // Half of a canvas of 32 : 9 fills 16 : 9.
    const Projection output = projection({.part = {{0.5, 0}, {1, 1}}, .corners = rectangleCorners(kSize.x, kSize.y)});
    const RgbaImage picture = drawEditView({.projection = output, .aspect = 2 * kAspect, .picture = TestPicture::Grid});
    for (int i = 0; i < 40; ++i) {
        const double angle = 2 * std::numbers::pi * i / 40;
        const glm::ivec2 at(glm::dvec2(kSize) / 2.0 + 0.4 * kSize.y * glm::dvec2(std::cos(angle), std::sin(angle)));
        int brightest = 0;
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) brightest = std::max(brightest, lightOf(picture, at.x + x, at.y + y));
        EXPECT_GT(brightest, 170) << "at " << i * 9 << " degrees";
    }
}

// What a projector's overscan would cut.
TEST(TestPictureCorners, lights_all_outermost_pixels) {
    const Projection output = projection({.corners = kKeystone});
    for (const TestPicture which : {TestPicture::Corners, TestPicture::Identify, TestPicture::Focus}) {
        const RgbaImage picture = drawEditView({.projection = output, .picture = which});
        for (int x = 0; x < kSize.x; ++x)
            ASSERT_EQ(std::pair(lightOf(picture, x, 0), lightOf(picture, x, kSize.y - 1)), std::pair(255, 255)) << x;
        for (int y = 0; y < kSize.y; ++y)
            ASSERT_EQ(std::pair(lightOf(picture, 0, y), lightOf(picture, kSize.x - 1, y)), std::pair(255, 255)) << y;
        // A single line of them.
        EXPECT_TRUE(which == TestPicture::Focus || lightOf(picture, 20, 1) == 0);
    }
}

// The last pixel of the picture, not the one beside it.
TEST(TestPictureCorners, crosses_the_pixels_in_which_the_corners_lie) {
    const Projection output = projection({.corners = kKeystone});
    const RgbaImage picture = drawEditView({.projection = output, .picture = TestPicture::Corners});
    const std::array<glm::ivec2, 4> pixels{{{103, 41}, {1810, 12}, {1702, 1032}, {61, 987}}},
        outwards{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    for (std::size_t i = 0; i < 4; ++i) {
        // An arm outside the picture, where nothing else is: a pixel wide.
        const glm::ivec2 arm = pixels[i] + glm::ivec2(45 * outwards[i].x, 0);
        EXPECT_EQ(lightOf(picture, arm.x, arm.y), 255) << "corner " << i;
        EXPECT_EQ(lightOf(picture, arm.x, arm.y - 1), 0) << "corner " << i;
        EXPECT_EQ(lightOf(picture, arm.x, arm.y + 1), 0) << "corner " << i;
        const int end = pixels[i].y + 45 * outwards[i].y;
        if (end < 2 || end > kSize.y - 3) continue;
        EXPECT_EQ(lightOf(picture, pixels[i].x, end), 255) << "corner " << i;
        EXPECT_EQ(lightOf(picture, pixels[i].x - 1, end), 0) << "corner " << i;
        EXPECT_EQ(lightOf(picture, pixels[i].x + 1, end), 0) << "corner " << i;
    }
}

// Blurred by a pixel these turn grey; drawn through the warp they would be so already.
TEST(TestPictureFocus, has_pairs_of_lines_a_pixel_wide_in_both_directions_whatever_the_warp) {
    const Projection output = projection({.corners = kKeystone, .mesh = aMesh(WarpMesh::Between::Smooth)});
    const RgbaImage picture = drawEditView({.projection = output, .picture = TestPicture::Focus});
    int upright = 0, level = 0, looks = 0;
    for (int y = 12; y < kSize.y - 12; y += 20)
        for (int x = 12; x < kSize.x - 12; x += 20, ++looks) {
            const auto alternate = [&](glm::ivec2 step) {
                for (int i = 0; i < 6; ++i) {
                    const glm::ivec2 a = glm::ivec2(x, y) + i * step, b = a + step;
                    if (lightOf(picture, a.x, a.y) + lightOf(picture, b.x, b.y) != 255) return false;
                }
                return true;
            };
            upright += alternate({1, 0}), level += alternate({0, 1});
        }
    EXPECT_GT(upright, looks / 4);
    EXPECT_GT(level, looks / 4);
}

TEST(EditView, is_transparent_but_for_what_it_says_and_opaque_where_a_picture_hides_the_show) {
    const Projection output = projection({.corners = kKeystone});
    for (const TestPicture which : kAll) {
        SCOPED_TRACE(int(which));
        const RgbaImage picture = drawEditView({.projection = output,
                                                .name = "tower",
                                                .picture = which,
                                                .handles = {{{400.25, 300}, "a", false}, {{900, 300}, "b", true}},
                                                .pointer = glm::dvec2(700, 700),
                                                .lines = {"a headline", "and a line"}});
        std::size_t clear = 0, partly = 0;
        for (const Rgba8 pixel : picture.pixels()) {
            ASSERT_LE(std::max({pixel.r, pixel.g, pixel.b}), pixel.a) << "colours are multiplied by alpha";
            clear += pixel.a == 0, partly += pixel.a > 0 && pixel.a < 255;
        }
        if (hidesTheShow(which)) {
            EXPECT_EQ(clear + partly, 0u);
        } else {
            EXPECT_GT(double(clear), 0.9 * kSize.x * kSize.y);
            EXPECT_GT(partly, 1000u) << "the plate lets some of the show through";
        }
    }
}

TEST(EditView, draws_nothing_but_the_frame_for_no_picture_or_one_that_does_not_exist) {
    const Projection output = projection({.corners = kKeystone});
    const RgbaImage none = drawEditView({.projection = output, .name = "tower"});
    EXPECT_EQ(none, drawEditView({.projection = output, .name = "tower", .picture = TestPicture(99)}));
    for (int y = 60; y < 960; ++y)
        for (int x = 140; x < 1680; ++x) ASSERT_EQ(none.at(x, y), (Rgba8{0, 0, 0, 0})) << x << ", " << y;
    // Across the top edge: light, with a dark rim on both sides.
    const int x = 960, edge = int(41.25 + (12.5 - 41.25) * (960 - 103.5) / (1811 - 103.5));
    const Extent seen = extentOf({1, 60}, [&](int, int y) { return alphaOf(none, x, y) > 0; });
    EXPECT_LE(std::abs((seen.from.y + seen.to.y) / 2 - edge), 1);
    EXPECT_GT(lightOf(none, x, edge), 240);
    EXPECT_LT(lightOf(none, x, seen.from.y), 100);
    EXPECT_LT(lightOf(none, x, seen.to.y - 1), 100);
}

TEST(EditView, is_dim_where_the_output_is_not_the_one_that_is_edited) {
    const Projection output = projection({.corners = kKeystone});
    for (const TestPicture which : {TestPicture::None, TestPicture::Identify}) {
        EditView view{.projection = output, .name = "tower", .picture = which, .lines = {"a headline"}};
        const auto white = [&] {
            const RgbaImage picture = drawEditView(view);
            std::size_t count = 0;  // beside the rim
            for (int y = 1; y < kSize.y - 1; ++y)
                for (int x = 1; x < kSize.x - 1; ++x) count += lightOf(picture, x, y) > 130;
            return count;
        };
        EXPECT_GT(white(), 5000u);
        view.chosen = false;
        EXPECT_EQ(white(), 0u);
    }
}

// Alpha's centroid of what a handle adds to a picture.
glm::dvec2 middleOf(const RgbaImage& with, const RgbaImage& without) {
    double sum = 0;
    glm::dvec2 moment(0);
    for (int y = 0; y < with.height(); ++y)
        for (int x = 0; x < with.width(); ++x) {
            const double added = alphaOf(with, x, y) - alphaOf(without, x, y);
            sum += added, moment += added * (glm::dvec2(x, y) + 0.5);
        }
    return moment / sum;
}

TEST(EditView, has_its_handles_where_they_are_and_the_chosen_one_of_another_shape) {
    for (const int scale : {1, 3, 6}) {
        const glm::ivec2 size = scale * glm::ivec2(640, 360);
        const Projection output = straight(size);
        const RgbaImage without = drawEditView({.projection = output});
        const glm::dvec2 at = glm::dvec2(scale * 200) + glm::dvec2(0.25, 0.6);
        std::array<Extent, 2> extents;
        for (const bool chosen : {false, true}) {
            const RgbaImage with = drawEditView({.projection = output, .handles = {{at, "", chosen}}});
            EXPECT_LT(glm::distance(middleOf(with, without), at), 0.1) << scale << chosen;
            extents[std::size_t(chosen)] = differenceOf(with, without);
            // Light and dark, to be seen on any picture.
            int light = 0, dark = 0;
            for (const Rgba8 pixel : with.pixels()) light += pixel.r > 180, dark += pixel.a > 180 && pixel.r < 40;
            for (const Rgba8 pixel : without.pixels()) light -= pixel.r > 180, dark -= pixel.a > 180 && pixel.r < 40;
            EXPECT_GT(light, 15) << scale << chosen;
            EXPECT_GT(dark, 15) << scale << chosen;
        }
        EXPECT_GT(extents[1].size().x, 1.8 * extents[0].size().x);
        EXPECT_NEAR(extents[1].size().x, size.y / 15.0, size.y / 60.0) << "it grows with the picture";
    }
}

// Where light ends is seen while it is set, whichever way up the picture is; a picture as a mask
// has no outline.
TEST(EditView, outlines_the_masks_where_these_are_set) {
    for (const int turns : {0, 1}) {
        Projection output =
            projection({.orientation = {Orientation::Flip::Horizontal, turns}, .corners = rectangleCorners(kSize.x, kSize.y)});
        output.masks = {{.polygon = {{100, 60}, {300, 60}, {300, 160}, {100, 160}}},
                        {.image = std::make_shared<const GreyImage>(4, 4)}};
        const RgbaImage without = drawEditView({.projection = output}),
                        with = drawEditView({.projection = output, .masks = true});
        for (const glm::ivec2 on : {glm::ivec2(200, 60), {300, 110}, {200, 160}, {100, 110}}) {
            int light = 0;
            for (int i = -1; i <= 0; ++i) light = std::max(light, lightOf(with, on.x + i, on.y + i));
            EXPECT_GT(light, 130) << turns << " at " << on.x << ", " << on.y;
        }
        const Extent changed = differenceOf(with, without);
        EXPECT_LT(glm::distance(glm::dvec2(changed.from + changed.to) / 2.0, glm::dvec2(200, 110)), 1) << turns;
        EXPECT_LT(changed.size().x, 210) << turns;
        EXPECT_LT(changed.size().y, 110) << turns;
    }
}

TEST(EditView, points_at_a_handle_outside_the_picture_from_the_edge) {
    const Projection output = straight();
    const RgbaImage without = drawEditView({.projection = output});
    for (const bool chosen : {false, true})
        for (const char* label : {"", "top left"}) {
            const Extent left =
                differenceOf(drawEditView({.projection = output, .handles = {{{-500, 540}, label, chosen}}}), without);
            ASSERT_TRUE(left.any());
            EXPECT_LT(left.from.x, 6);
            EXPECT_LT(left.to.x, 320);
            EXPECT_GT(left.from.y, 480);
            EXPECT_LT(left.to.y, 620);
        }
}

// Whoever moves a point looks at that point.
TEST(EditView, never_lays_its_words_over_the_chosen_handle) {
    for (const glm::ivec2 size : {glm::ivec2(64, 36), glm::ivec2(640, 360), glm::ivec2(450, 800)})
        for (const TestPicture which : {TestPicture::None, TestPicture::Grid, TestPicture::Identify})
            for (int i = 0; i < 25; ++i) {
                const Projection output = straight(size);
                EditView view{.projection = output, .name = "tower", .picture = which};
                const glm::dvec2 at = glm::dvec2(size) * glm::dvec2(0.1 + 0.2 * (i % 5), 0.1 + 0.2 * (i / 5));
                view.handles = {{at, "", true}};
                // Identify's number makes way for the words: the two must have it in the same
                // place.
                view.lines = {" "};
                const RgbaImage silent = drawEditView(view);
                view.lines = {"tower: the corner at the top right", "1811.0, 12.5   step 1 px", "arrows move, Tab next",
                              "Esc done"};
                const RgbaImage said = drawEditView(view);
                EXPECT_TRUE(differenceOf(silent, said).any());
                const int reach = std::max(2, std::min(size.x, size.y) / 40);
                for (int y = -reach; y <= reach; ++y)
                    for (int x = -reach; x <= reach; ++x) {
                        const glm::ivec2 pixel = glm::ivec2(at) + glm::ivec2(x, y);
                        if (glm::any(glm::lessThan(pixel, glm::ivec2(0))) || glm::any(glm::greaterThanEqual(pixel, size)))
                            continue;
                        ASSERT_EQ(silent.at(pixel.x, pixel.y), said.at(pixel.x, pixel.y)) << size.x << " wide, handle " << i;
                    }
            }
}

// A capital L: all of its left edge and all of its foot, and nothing at the top right.
TEST(EditView, writes_upright_from_left_to_right) {
    const Projection output = straight();
    const RgbaImage picture = drawEditView({.projection = output, .lines = {"L"}});
    const Extent seen = extentOf(kSize, [&](int x, int y) {
        return x > 20 && y > 20 && x < kSize.x - 20 && y < kSize.y - 20 && lightOf(picture, x, y) > 128;
    });
    ASSERT_TRUE(seen.any());
    EXPECT_NEAR((seen.from.x + seen.to.x) / 2, 960, 6);
    EXPECT_NEAR((seen.from.y + seen.to.y) / 2, 540, 6);
    EXPECT_GT(lightOf(picture, seen.from.x + 2, seen.from.y + 2), 128);
    EXPECT_GT(lightOf(picture, seen.from.x + 2, seen.to.y - 2), 128);
    EXPECT_GT(lightOf(picture, seen.to.x - 2, seen.to.y - 2), 128);
    EXPECT_LT(lightOf(picture, seen.to.x - 2, seen.from.y + 2), 128);
}

// From behind, from above or on its side: the wall shows the same. Turned are the pixels, so what
// is compared are all of them.
TEST(EditView, reads_the_same_on_the_wall_whichever_way_the_picture_leaves_the_projector) {
    constexpr glm::ivec2 kUpright{640, 360};
    struct Way {
        Orientation orientation;
        std::array<std::size_t, 4> corners{0, 1, 2, 3};  // whose places a technician gave to top left, top right, ...
    };
    std::vector<Way> ways;
    for (const Flip flip : {Flip::None, Flip::Horizontal, Flip::Vertical})
        for (int turns = 0; turns < 4; ++turns) ways.push_back({{flip, turns}});
    ways.push_back({{}, {1, 0, 3, 2}});  // mirrored by hand
    ways.push_back({{}, {2, 3, 0, 1}});  // stood on its head by hand
    const auto view = [](const Projection& output, TestPicture which) {
        EditView made{.projection = output, .aspect = kAspect, .name = "tower", .number = 2, .picture = which};
        const auto place = [&](double x, double y) { return output.warp.projectorFromCanvas({x, y}); };
        made.handles = {{place(0.2, 0.3), "a", false}, {place(0.7, 0.3), "b", true}};
        made.pointer = place(0.6, 0.9);
        made.lines = {"a headline", "and a line"};
        return made;
    };
    for (const Way& way : ways) {
        const bool turned = way.orientation.quarterTurns % 2 != 0;
        const glm::ivec2 size = turned ? glm::ivec2(kUpright.y, kUpright.x) : kUpright;
        const auto edges = rectangleCorners(size.x, size.y);
        WarpShape shape{.orientation = way.orientation};
        for (std::size_t i = 0; i < 4; ++i) shape.corners[i] = edges[way.corners[i]];
        const Projection upright = straight(kUpright), output = projection(shape, size);
        for (const TestPicture which : kAll) {
            // These two also say how the projector's pixels lie.
            if (turned && (which == TestPicture::Numbers || which == TestPicture::Identify)) continue;
            const RgbaImage wanted = drawEditView(view(upright, which)), drawn = drawEditView(view(output, which));
            int most = 0;
            for (int y = 0; y < kUpright.y; ++y)
                for (int x = 0; x < kUpright.x; ++x) {
                    const glm::ivec2 at(output.warp.projectorFromCanvas((glm::dvec2(x, y) + 0.5) / glm::dvec2(kUpright)));
                    most = std::max({most, std::abs(lightOf(wanted, x, y) - lightOf(drawn, at.x, at.y)),
                                     std::abs(alphaOf(wanted, x, y) - alphaOf(drawn, at.x, at.y))});
                }
            EXPECT_LE(most, 4) << "flip " << int(way.orientation.flip) << ", turns " << way.orientation.quarterTurns
                               << ", corner " << way.corners[0] << ", picture " << int(which);
        }
    }
}

TEST(EditView, is_drawn_in_every_size_and_gives_the_same_bytes_every_time) {
    for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(64, 36), glm::ivec2(37, 64), glm::ivec2(640, 360),
                                  glm::ivec2(1200, 1920), glm::ivec2(3840, 2160)})
        for (const TestPicture which : kAll) {
            const Projection output = straight(size);
            const EditView view{
                .projection = output,
                .name = "the tower at the far end of the square",
                .number = 117,
                .picture = which,
                .handles = {{glm::dvec2(size) / 3.0, "a", true}, {glm::dvec2(size) * 2.0, "beyond", false}, {{-9, 2}, "b", true}},
                .pointer = glm::dvec2(size) / 2.0,
                .lines = {"a headline that is much longer than any technician would have the patience to read", ""}};
            const RgbaImage picture = drawEditView(view);
            ASSERT_EQ(glm::ivec2(picture.width(), picture.height()), size);
            EXPECT_TRUE(size.x == 1 || extentOf(size, [&](int x, int y) { return lightOf(picture, x, y) > 60; }).any())
                << size.x << ", " << int(which);
            EXPECT_EQ(picture, drawEditView(view));
        }
}

TEST(ColourCard, has_the_bars_of_the_standard_at_75_percent_over_patches_at_100) {
    for (const glm::ivec2 size : {glm::ivec2(64, 36), glm::ivec2(640, 360), glm::ivec2(1920, 1080), glm::ivec2(3840, 2160)}) {
        const RgbaImage card = drawColourCard(TestPicture::Bars, size);
        ASSERT_EQ(glm::ivec2(card.width(), card.height()), size);
        const auto at = [&](double x, double y) { return card.at(int(x * size.x), int(y * size.y)); };
        const std::array<Rgba8, 7> bars{
            {{191, 191, 191}, {191, 191, 0}, {0, 191, 191}, {0, 191, 0}, {191, 0, 191}, {191, 0, 0}, {0, 0, 191}}},
            reverse{{{0, 0, 191}, {0, 0, 0}, {191, 0, 191}, {0, 0, 0}, {0, 191, 191}, {0, 0, 0}, {191, 191, 191}}},
            full{{{255, 255, 255}, {0, 0, 0}, {255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {0, 0, 0}, {10, 10, 10}}};
        for (std::size_t i = 0; i < 7; ++i) {
            const double x = (double(i) + 0.5) / 7;
            for (const double y : {0.0, 0.3, 0.65}) EXPECT_EQ(at(x, y), bars[i]) << i;
            EXPECT_EQ(at(x, 0.71), reverse[i]) << i;
            for (const double y : {0.78, 0.99}) EXPECT_EQ(at(x, y), full[i]) << i;
        }
        EXPECT_EQ(at(18.5 / 21, 0.9), (Rgba8{5, 5, 5}));
        EXPECT_EQ(at(20.5 / 21, 0.9), (Rgba8{15, 15, 15}));
    }
}

TEST(ColourCard, has_ramps_of_known_values) {
    for (const glm::ivec2 size : {glm::ivec2(64, 36), glm::ivec2(640, 360), glm::ivec2(1920, 1080), glm::ivec2(3840, 2160)}) {
        const RgbaImage card = drawColourCard(TestPicture::Ramp, size);
        for (const Rgba8 pixel : card.pixels()) ASSERT_TRUE(pixel.a == 255 && pixel.r == pixel.g && pixel.g == pixel.b);
        const auto row = [&](double y) {
            std::vector<int> values;  // without those that come again
            for (int x = 0; x < size.x; ++x)
                if (const int value = lightOf(card, x, int(y * size.y)); values.empty() || values.back() != value)
                    values.push_back(value);
            return values;
        };
        std::vector<int> steps, all, dark, light;
        for (int i = 0; i <= 16; ++i) steps.push_back(int(std::lround(255 * i / 16.0)));
        for (int i = 0; i < 256; ++i) all.push_back(i);
        for (int i = 0; i <= 32; ++i) dark.push_back(i), light.push_back(223 + i);
        EXPECT_EQ(row(0.01), steps);
        EXPECT_EQ(row(0.4) == all, size.x >= 256);
        EXPECT_EQ(row(0.52), dark);
        EXPECT_EQ(row(0.77), light);
        // The steps bear their values where there is room.
        EXPECT_EQ(row(0.22) == steps && row(0.2) == steps && row(0.21) == steps && row(0.23) == steps, size.y < 360);
        EXPECT_EQ(card, drawColourCard(TestPicture::Ramp, size));
    }
}

}  // namespace
}  // namespace fantascope::plot
