#include "vision/projector_response.h"

#include "core/random.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::vision {
namespace {

// Seven greys of a projector as a camera sees them. `excess`: light that it sees too much of in
// black, as a share of white.
std::vector<GreyLight> greysOf(double gamma, double excess = 0) {
    std::vector<GreyLight> greys;
    for (int i = 1; i < 8; ++i) greys.push_back({i / 8.0, (std::pow(i / 8.0, gamma) - excess) / (1 - excess)});
    return greys;
}

TEST(FitGamma, finds_the_exponent_also_if_black_looks_too_bright) {
    for (const double gamma : {1.2, 1.8, 2.2, 2.6, 3.4})
        for (const double excess : {0.0, 0.01, -0.01}) EXPECT_NEAR(fitGamma(greysOf(gamma, excess)).value_or(0), gamma, 0.002);
}

TEST(FitGamma, leaves_out_greys_that_somebody_stood_before) {
    auto greys = greysOf(2.2);
    greys[6].light *= 0.6;
    greys[3].light += 0.3;
    EXPECT_NEAR(fitGamma(greys).value_or(0), 2.2, 0.002);
    greys[1].light += 0.5;
    EXPECT_FALSE(fitGamma(greys)) << "four greys do not say which of them are right";
}

TEST(FitGamma, knows_when_light_follows_no_exponent) {
    EXPECT_FALSE(fitGamma({}));
    EXPECT_FALSE(fitGamma(greysOf(0.6)));
    EXPECT_FALSE(fitGamma(greysOf(5)));
    auto steps = greysOf(2.2);
    for (GreyLight& grey : steps) grey.light = grey.stored < 0.5 ? 0 : 1;
    EXPECT_FALSE(fitGamma(steps));
}

// Outputs that light a wall of many colours side by side, and a camera whose channels each see
// something of every primary.
class PlainColours : public testing::Test {
protected:
    static constexpr int kWidth = 60, kHeight = 20;
    struct Output {
        int low = 0, high = kWidth;  // columns of the camera's picture that it lights
        glm::vec3 white{1};
    };
    glm::mat3 camera = {{0.8f, 0.15f, 0.02f}, {0.12f, 0.7f, 0.1f}, {0.03f, 0.2f, 0.9f}};  // by primary
    float noise = 0.004f, strength = 0.7f;
    Rng rng{1};

    Image<glm::vec3> seen(const Output& output, glm::vec3 shown) {
        Image<glm::vec3> picture(kWidth, kHeight);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const glm::vec3 wall(0.5f + 0.3f * std::sin(0.7f * float(x)), 0.4f + 0.2f * std::cos(1.1f * float(y)),
                                     0.4f + 0.2f * std::sin(0.9f * float(x + y)));
                glm::vec3 light(0.01f);
                if (x >= output.low && x < output.high) light += strength * (camera * (shown * output.white));
                for (int i = 0; i < 3; ++i)
                    picture.at(x, y)[i] = std::clamp(wall[i] * light[i] + noise * static_cast<float>(rng.normal()), 0.0f, 1.0f);
            }
        return picture;
    }
    static GreyImage grey(const Image<glm::vec3>& colours) {
        GreyImage picture(colours.width(), colours.height());
        for (std::size_t i = 0; i < picture.pixels().size(); ++i)
            picture.pixels()[i] = glm::dot(colours.pixels()[i], glm::vec3(1)) / 3;
        return picture;
    }
    PrimarySight sightOf(const Output& output) {
        LightDecoder decoder(StructuredLight({64, 32}, 2), {kWidth, kHeight});
        for (int i = 0; i < 3; ++i) decoder.take(0, grey(seen(output, glm::vec3(1))), grey(seen(output, glm::vec3(0))));
        return PrimarySight(decoder);
    }
    PrimarySight::Pictures pictures(const Output& output) {
        PrimarySight::Pictures made;
        for (std::size_t i = 0; i < made.size(); ++i) made[i] = seen(output, glm::vec3(PrimarySight::kColours[i]));
        return made;
    }
    std::vector<PrimaryLight> lightOf(const Output& output) {
        PrimarySight sight = sightOf(output);
        sight.take(pictures(output));
        EXPECT_LT(sight.undecided(), 0.05);
        return sight.light();
    }
    static void expectNear(const glm::dvec3& found, const glm::dvec3& wanted, double tolerance = 0.01) {
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], wanted[i], tolerance) << i;
    }
};

TEST_F(PlainColours, match_the_whites_of_outputs_through_a_camera_that_mixes_colours) {
    const std::vector<std::vector<PrimaryLight>> lights = {
        lightOf({0, 28, {1, 0.9f, 0.8f}}), lightOf({18, 48, {0.7f, 0.8f, 0.9f}}), lightOf({40, 60, {0.9f, 0.9f, 0.5f}})};
    const auto whites = matchedWhites(lights);
    ASSERT_TRUE(whites);
    expectNear((*whites)[0], {0.7, 0.8 / 0.9, 0.5 / 0.8});
    expectNear((*whites)[1], {1, 1, 0.5 / 0.9});
    expectNear((*whites)[2], {0.7 / 0.9, 0.8 / 0.9, 1});
    EXPECT_FALSE(matchedWhites(std::vector{lights[0], lights[2]})) << "they do not overlap";
}

TEST_F(PlainColours, match_the_brightness_alone_if_the_camera_sees_no_colours) {
    for (int i = 0; i < 3; ++i) camera[i] = glm::vec3(0.3f);
    const auto whites = matchedWhites(std::vector{lightOf({0, 40, {1, 1, 0.7f}}), lightOf({20, 60, {0.6f, 0.6f, 0.6f}})});
    ASSERT_TRUE(whites);
    expectNear((*whites)[0], glm::dvec3(1.8 / 2.7));
    expectNear((*whites)[1], glm::dvec3(1));
}

// Somebody stands before a third of the picture while red is shown. The next try sees all of it.
TEST_F(PlainColours, are_decided_by_a_later_try_where_somebody_stood) {
    const Output output;
    PrimarySight sight = sightOf(output);
    auto disturbed = pictures(output);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth / 3; ++x) disturbed[1].at(x, y) = glm::vec3(0.9f);
    sight.take(disturbed);
    EXPECT_NEAR(sight.undecided(), 1 / 3.0, 0.05);
    EXPECT_EQ(sight.light().front().pixel, static_cast<std::size_t>(kWidth / 3));
    sight.take(pictures(output));
    EXPECT_LT(sight.undecided(), 0.02);
}

// Of a pixel that the white picture saturates nothing is known, and no further try helps. Light
// just below saturation would come out too weak: the noise above it is cut off.
TEST_F(PlainColours, leave_out_what_they_saturate) {
    noise = 0.02f;
    strength = 1.8f;
    const std::vector<Output> outputs = {{0, 60, {1, 1, 1}}, {0, 60, {0.8f, 0.8f, 0.8f}}};
    std::vector<std::vector<PrimaryLight>> lights;
    for (const Output& output : outputs) {
        lights.push_back(lightOf(output));
        EXPECT_GT(lights.back().size(), 100u);
        EXPECT_LT(lights.back().size(), static_cast<std::size_t>(kWidth * kHeight * 9 / 10));
    }
    const auto whites = matchedWhites(lights);
    ASSERT_TRUE(whites);
    expectNear((*whites)[0], glm::dvec3(0.8), 0.02);
}

}  // namespace
}  // namespace fantascope::vision
