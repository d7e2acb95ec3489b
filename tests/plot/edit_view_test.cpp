#include "edit_views.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fantascope::plot {
namespace {

using Flip = Orientation::Flip;

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
            EXPECT_GT(partly, 1000u) << "the plate is translucent";
        }
    }
}

TEST(EditView, draws_nothing_but_the_frame_for_no_picture_or_one_that_does_not_exist) {
    const Projection output = projection({.corners = kKeystone});
    const RgbaImage none = drawEditView({.projection = output, .name = "tower"});
    EXPECT_EQ(none, drawEditView({.projection = output, .name = "tower", .picture = TestPicture(99)}));
    for (int y = 60; y < 960; ++y)
        for (int x = 140; x < 1680; ++x) ASSERT_EQ(none.at(x, y), (Rgba8{0, 0, 0, 0})) << x << ", " << y;
    // Across the top edge, the frame is light with a dark rim on both sides.
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
            std::size_t count = 0;  // of bright pixels besides the rim
            for (int y = 1; y < kSize.y - 1; ++y)
                for (int x = 1; x < kSize.x - 1; ++x) count += lightOf(picture, x, y) > 130;
            return count;
        };
        EXPECT_GT(white(), 5000u);
        view.chosen = false;
        EXPECT_EQ(white(), 0u);
    }
}

// The centroid of the alpha that a handle adds to a picture.
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
            // It is light and dark, to be visible on any picture.
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

// The outlines are right whichever way the picture is turned. A mask that is an image has no
// outline.
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

// A technician who moves a point must see that point.
TEST(EditView, never_lays_its_words_over_the_chosen_handle) {
    for (const glm::ivec2 size : {glm::ivec2(64, 36), glm::ivec2(640, 360), glm::ivec2(450, 800)})
        for (const TestPicture which : {TestPicture::None, TestPicture::Grid, TestPicture::Identify})
            for (int i = 0; i < 25; ++i) {
                const Projection output = straight(size);
                EditView view{.projection = output, .name = "tower", .picture = which};
                const glm::dvec2 at = glm::dvec2(size) * glm::dvec2(0.1 + 0.2 * (i % 5), 0.1 + 0.2 * (i / 5));
                view.handles = {{at, "", true}};
                // Identify's number makes way for the lines, so both pictures need some.
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

// A capital L has light along its left edge and its foot, and none at the top right.
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

// The wall shows the same whether the projector throws from behind, hangs upside down or lies on
// its side. All pixels are compared, since only pixels are rearranged.
TEST(EditView, reads_the_same_on_the_wall_whichever_way_the_picture_leaves_the_projector) {
    constexpr glm::ivec2 kUpright{640, 360};
    struct Way {
        Orientation orientation;
        std::array<std::size_t, 4> corners{0, 1, 2, 3};  // which corners a technician moved to top left, top right, ...
    };
    std::vector<Way> ways;
    for (const Flip flip : {Flip::None, Flip::Horizontal, Flip::Vertical})
        for (int turns = 0; turns < 4; ++turns) ways.push_back({{flip, turns}});
    ways.push_back({{}, {1, 0, 3, 2}});  // mirrored by hand
    ways.push_back({{}, {2, 3, 0, 1}});  // turned upside down by hand
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
            // These two also show the projector's size in pixels.
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

}  // namespace
}  // namespace fantascope::plot
