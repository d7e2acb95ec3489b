#include "pattern/search/search_space.h"

#include "pattern/search_helpers.h"

#include "media/image.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>

namespace fantascope::pattern {
namespace {

using testing::HasSubstr;

using Options = PatternSearch::Options;

GreyImage halfWhite() {
    GreyImage guide(96, 54);
    for (int y = 0; y < 54; ++y)
        for (int x = 0; x < 48; ++x) guide.at(x, y) = 1;
    return guide;
}

Options smallSearch(PatternSearch::Method method) {
    Options options;
    options.method = method;
    options.instances = 60;
    options.iterations = 30;
    options.paper.largestAmount = 3;  // wild
    return options;
}

constexpr std::array kMethods = {PatternSearch::Method::Paper, PatternSearch::Method::Refined};

PatternSearch::Found search(const Options& options) {
    return PatternSearch::run(halfWhite(), withShapes({"circle", "leaf", "triangle"}), options, 1, never);
}

// Example failure: only new instances keep the limits, and moves do not.
TEST(SearchSpace, every_shape_keeps_its_own_limits_in_every_method) {
    for (const PatternSearch::Method method : kMethods) {
        SCOPED_TRACE(name(method));
        Options options = smallSearch(method);
        options.size = {0.02, 0.09};
        options.shapes.resize(2);  // the triangle has nothing of its own
        options.shapes[0].size = {0.05, 0.06};
        options.shapes[0].tilt = {0, 0};
        options.shapes[1].tilt = {radians(10), radians(20)};
        options.shapes[1].turn = {radians(150), radians(230)};
        std::array<int, 3> count{};
        constexpr double kStep = 1e-6;
        for (const ShapeInstance& i : search(options).pattern.instances) {
            ++count[i.shape];
            if (i.shape == 0) {
                EXPECT_TRUE(i.size >= 0.05 - kStep && i.size <= 0.06 + kStep) << i.size;
                EXPECT_EQ(i.rotation.x, 0);
                EXPECT_EQ(i.rotation.y, 0);
            } else {
                EXPECT_TRUE(i.size >= 0.02 - kStep && i.size <= 0.09 + kStep) << i.size;
            }
            if (i.shape == 1) {
                for (const double tilt : {i.rotation.x, i.rotation.y})
                    EXPECT_TRUE(tilt >= radians(10) - kStep && tilt <= radians(20) + kStep) << tilt;
                EXPECT_TRUE(i.rotation.z >= radians(150) - kStep && i.rotation.z <= radians(230) + kStep) << i.rotation.z;
            }
        }
        for (const int n : count) EXPECT_GT(n, 0);
    }
}

// 190 degrees and -170 are the same turn. Example failure: -170 clamped to 150 .. 230 becomes 150.
TEST(SearchSpace, the_nearest_of_equal_turns_is_allowed) {
    const GreyImage guide = halfWhite();
    const ShapePattern pattern = withShapes({"leaf"});
    Options options;
    options.shapes.resize(1);
    options.shapes[0].turn = {radians(150), radians(230)};
    const SearchSpace space(guide, pattern.shapes, 1, options);
    const auto allowed = [&](double degrees) {
        ShapeInstance instance;
        instance.rotation.z = radians(degrees);
        return space.allowed(instance).rotation.z * 180 / std::numbers::pi;
    };
    for (const auto& [given, kept] : {std::pair(-170.0, 190.0), {200, 200}, {-20, 230}, {60, 150}, {550, 190}})
        EXPECT_NEAR(allowed(given), kept, 1e-9) << given;
}

std::array<double, 3> sharesOf(const std::vector<ShapeInstance>& instances) {
    std::array<double, 3> shares{};
    for (const ShapeInstance& instance : instances) shares[instance.shape] += 1.0 / static_cast<double>(instances.size());
    return shares;
}

TEST(SearchSpace, shapes_are_drawn_by_their_shares) {
    const GreyImage guide = halfWhite();
    const ShapePattern pattern = withShapes({"circle", "leaf", "triangle"});
    Options options;
    options.shapes.resize(3);
    options.shapes[0].share = 5, options.shapes[1].share = 0.5, options.shapes[2].share = 4.5;
    const SearchSpace space(guide, pattern.shapes, 1, options);
    Rng rng(3);
    std::vector<ShapeInstance> drawn;
    for (int i = 0; i < 4000; ++i) drawn.push_back(space.randomInstance({{0, 0}, {96, 54}}, rng));
    const auto shares = sharesOf(drawn);
    EXPECT_NEAR(shares[0], 0.5, 0.03);
    EXPECT_NEAR(shares[1], 0.05, 0.015);
    EXPECT_NEAR(shares[2], 0.45, 0.03);

    // Given the counts, it makes up for deleted instances: here all circles.
    std::array<std::uint32_t, 3> counts{0, 5, 45};
    for (int i = 0; i < 50; ++i) ++counts[space.randomInstance({{0, 0}, {96, 54}}, rng, counts).shape];
    EXPECT_THAT(counts, testing::ElementsAre(testing::Ge(47u), testing::Le(6u), testing::Le(48u)));
}

// Example failure: instances that fit badly are replaced by any shape, and only circles are left at
// the end.
TEST(SearchSpace, the_refined_pattern_has_the_shares) {
    const GreyImage guide(320, 180, 0.5f);
    Options options = smallSearch(PatternSearch::Method::Refined);
    options.instances = 300;
    options.iterations = 60;
    options.size = {0.02, 0.05};
    options.shapes.resize(3);
    options.shapes[0].share = 1, options.shapes[1].share = 3, options.shapes[2].share = 2;
    const auto found = PatternSearch::run(guide, withShapes({"circle", "leaf", "triangle"}), options, 1, never);
    const auto shares = sharesOf(found.pattern.instances);
    EXPECT_NEAR(shares[0], 1 / 6.0, 0.1);
    EXPECT_NEAR(shares[1], 3 / 6.0, 0.1);
    EXPECT_NEAR(shares[2], 2 / 6.0, 0.1);
}

// The methods set their cells and temperatures by the typical size.
TEST(SearchSpace, the_typical_instance_lies_between_the_shapes) {
    const GreyImage guide = halfWhite();
    const ShapePattern pattern = withShapes({"circle", "square"});
    Options options;
    options.size = {0.01, 0.02};
    EXPECT_EQ(SearchSpace(guide, pattern.shapes, 1, options).sizes(), glm::dvec2(0.01, 0.02));
    options.shapes.resize(1);
    options.shapes[0].size = {0.1, 0.2};
    const SearchSpace space(guide, pattern.shapes, 1, options);
    EXPECT_EQ(space.sizes(0), glm::dvec2(0.1, 0.2));
    EXPECT_EQ(space.sizes(1), glm::dvec2(0.01, 0.02));
    const double typical = space.meanSide() * space.sizes().x;  // each shape has half of the instances
    EXPECT_NEAR(typical, (space.side(0) * 0.1 + space.side(1) * 0.01) / 2, 1e-9);
}

// Example failure: an additional random draw, which changes every pattern made so far.
TEST(SearchSpace, shapes_with_nothing_of_their_own_change_nothing) {
    for (const PatternSearch::Method method : kMethods) {
        Options options = smallSearch(method);
        const auto without = search(options);
        options.shapes.resize(3);
        EXPECT_TRUE(same(search(options).pattern.instances, without.pattern.instances)) << name(method);
        for (Options::Shape& shape : options.shapes) {
            shape.share = 7;
            shape.tilt = {-options.tilt, options.tilt};
            shape.turn = {-options.turn, options.turn};
            shape.colours = options.colours;
        }
        EXPECT_TRUE(same(search(options).pattern.instances, without.pattern.instances)) << name(method);
    }
}

TEST(SearchSpace, a_shape_has_its_own_colours_or_those_of_all) {
    Options options = smallSearch(PatternSearch::Method::Refined);
    options.colours = {{{1, 0, 0}, {1, 0, 0}}};
    options.shapes.resize(2);
    options.shapes[1].colours = {{{0, 1, 0}, {0, 1, 0}}};
    for (const ShapeInstance& i : search(options).pattern.instances)
        EXPECT_EQ(i.colour, i.shape == 1 ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0));
}

// The picture is stretched over the canvas. Its left third is red, the rest a chequerboard of black
// and white pixels, whose mean in linear light is 0.5. Example failures: x is scaled by the
// picture's height; stored values are averaged, which gives .21.
TEST(SearchSpace, colours_are_picked_from_a_picture_at_the_instances_place) {
    RgbaImage picture(300, 50);
    for (int y = 0; y < 50; ++y)
        for (int x = 0; x < 300; ++x) {
            const auto chequer = static_cast<std::uint8_t>((x + y) % 2 * 255);
            picture.at(x, y) = x < 100 ? Rgba8{255, 0, 0, 255} : Rgba8{chequer, chequer, chequer, 255};
        }
    Options options = smallSearch(PatternSearch::Method::Refined);
    options.colours = {{.picture = std::make_shared<RgbaImage>(picture)}};
    int red = 0, grey = 0;
    const auto found = search(options);
    for (const ShapeInstance& i : found.pattern.instances) {
        const double edge = found.pattern.aspect() / 3;
        if (i.centre.x + i.size < edge) {
            EXPECT_EQ(i.colour, glm::vec3(1, 0, 0));
            ++red;
        } else if (i.centre.x - i.size > edge) {
            EXPECT_NEAR(i.colour.g, 0.5, 0.1);
            ++grey;
        }
    }
    EXPECT_GT(red, 5);
    EXPECT_GT(grey, 2);
}

TEST(SearchSpace, limits_that_break_a_rule_are_refused) {
    const auto refusal = [](auto change) {
        Options options;
        options.shapes.resize(2);
        change(options.shapes[1]);
        const auto checked = options.check();
        return checked ? "accepted" : checked.error().message();
    };
    EXPECT_EQ(refusal([](auto&) {}), "accepted");
    EXPECT_EQ(refusal([](auto& shape) { shape.turn = {-2 * std::numbers::pi, 0}; }), "accepted");
    EXPECT_THAT(refusal([](auto& shape) { shape.share = 0; }), HasSubstr("share = 0"));
    EXPECT_THAT(refusal([](auto& shape) { shape.size = {0.2, 0.1}; }), HasSubstr("size = [0.2, 0.1]"));
    EXPECT_THAT(refusal([](auto& shape) { shape.tilt = {1, 0}; }), HasSubstr("tilt = ["));
    EXPECT_THAT(refusal([](auto& shape) { shape.turn = {-4, 4}; }), HasSubstr("to - from <= 360"));
    EXPECT_THAT(refusal([](auto& shape) { shape.turn = {NAN, 4}; }), HasSubstr("turn"));
    EXPECT_THAT(refusal([](auto& shape) { shape.colours.resize(1), shape.colours[0].to.r = 2; }), HasSubstr("colours = 2"));
}

}  // namespace
}  // namespace fantascope::pattern
