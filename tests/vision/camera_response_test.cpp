// Finds how a camera stores light from exposures of a scene that it does not know, and reads light
// from frames by it.

#include "vision/camera_response.h"

#include "vision/camera_light.h"

#include "core/random.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

namespace fantascope::vision {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Stored values of a camera with this curve, 0..1 to 0..1, that stores `dark` without light.
std::vector<ExposedValues> exposed(const std::function<double(double)>& curve, double dark, Rng& rng, double most = 1.5) {
    std::vector<double> lights;
    for (int i = 0; i < 300; ++i) lights.push_back(0.004 * std::exp(rng.uniform() * std::log(most / 0.004)));
    std::vector<ExposedValues> exposures;
    for (const double time : {0.125, 0.25, 0.5, 1.0, 2.0, 4.0}) {
        ExposedValues values{time, {}};
        for (const double light : lights) {
            const double stored = dark + (255 - dark) * curve(std::min(1.0, light * time)) + 0.4 * rng.normal();
            values.stored.push_back(std::clamp(stored, 0.0, 255.0));
        }
        exposures.push_back(values);
    }
    return exposures;
}

double worstOf(const std::vector<double>& response, const std::function<double(double)>& curve, double dark) {
    const CameraLight light(response, {});
    double worst = 0;
    for (double part = 0; part <= 1; part += 0.01) {
        const auto stored = static_cast<std::size_t>(std::lround(dark + (255 - dark) * curve(part)));
        worst = std::max(worst, std::abs(light.ofStored()[stored] - part));
    }
    return worst;
}

// A curve that is sRGB's already would be found by a fit that does nothing.
TEST(CameraResponse, is_found_for_curves_that_are_not_srgb) {
    const std::vector<std::pair<const char*, std::function<double(double)>>> curves = {
        {"sRGB", [](double light) { return double(srgbFromLinear(float(light))); }},
        {"linear", [](double light) { return light; }},
        {"gamma 1.6", [](double light) { return std::pow(light, 1 / 1.6); }},
        {"gamma 2.8", [](double light) { return std::pow(light, 1 / 2.8); }},
        {"a film's shoulder", [](double light) { return std::pow(1.4 * light / (light + 0.4), 0.7); }},
    };
    for (const auto& [name, curve] : curves) {
        SCOPED_TRACE(name);
        Rng rng(11);
        const auto fit = fitResponse(exposed(curve, 0, rng), 0);
        ASSERT_TRUE(fit) << fit.error().message();
        EXPECT_EQ(fit->response.front(), 0);
        EXPECT_EQ(fit->response.back(), 1);
        EXPECT_TRUE(std::ranges::is_sorted(fit->response));
        EXPECT_LT(worstOf(fit->response, curve, 0), 0.04);
        EXPECT_LT(fit->rms, 0.08);
    }
}

TEST(CameraResponse, begins_at_the_dark_level) {
    const auto curve = [](double light) { return std::pow(light, 1 / 1.8); };
    Rng rng(12);
    const auto fit = fitResponse(exposed(curve, 16, rng), 16);
    ASSERT_TRUE(fit);
    EXPECT_EQ(fit->response[1], 0) << "15 is below the dark level";
    EXPECT_LT(worstOf(fit->response, curve, 16), 0.04);
    EXPECT_EQ(srgbResponse(16)[1], 0);
    EXPECT_EQ(srgbResponse(0)[17], 1);
    EXPECT_NEAR(srgbResponse(0)[9], linearFromSrgb(135.0f / 255), 1e-4);
}

TEST(CameraResponse, is_refused_where_the_exposures_tell_too_little) {
    const auto curve = [](double light) { return light; };
    Rng rng(13);
    EXPECT_THAT(fitResponse({}, 0).error().message(), HasSubstr("too few values"));
    EXPECT_THAT(fitResponse(exposed(curve, 0, rng, 0.01), 0).error().message(), HasSubstr("dark, middle and bright parts"));
    // A camera that undoes its exposure by itself contradicts the times.
    auto same = exposed(curve, 0, rng);
    for (ExposedValues& values : same) values.stored = same[3].stored;
    const auto fit = fitResponse(same, 0);
    EXPECT_TRUE(!fit || fit->rms > 0.2);
}

TEST(DarkFrame, finds_the_level_and_the_hot_pixels) {
    Rng rng(14);
    GreyImage stored(80, 60);
    for (float& value : stored.pixels()) value = static_cast<float>(std::max(0.0, 5 + 0.6 * rng.normal()));
    stored.at(7, 3) = 90;
    stored.at(79, 59) = 30;
    const DarkFrame dark = darkFrameOf(stored);
    EXPECT_NEAR(dark.level, 5, 0.2);
    EXPECT_THAT(dark.hotPixels, ElementsAre(glm::ivec2(7, 3), glm::ivec2(79, 59)));
}

TEST(CameraLight, is_straight_between_the_numbers_of_a_response) {
    const CameraLight light(std::vector<double>{0, 0.1, 1}, {});
    EXPECT_EQ(light.ofStored()[0], 0);
    EXPECT_NEAR(light.ofStored()[51], 0.04, 1e-6);
    EXPECT_NEAR(light.ofStored()[204], 0.64, 1e-6);
    EXPECT_EQ(light.ofStored()[255], 1);
    EXPECT_EQ(CameraLight().ofStored(), linearOfBytes());
}

TEST(CameraLight, shows_a_sound_neighbour_in_place_of_a_hot_pixel) {
    RgbaImage frame(4, 2);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 4; ++x) frame.at(x, y) = {static_cast<std::uint8_t>(40 * x), 0, 0, 255};
    const std::vector<glm::ivec2> hot = {{1, 0}, {0, 1}, {1, 1}, {99, 99}};
    const CameraLight light({}, hot);
    const auto& linear = linearOfBytes();
    EXPECT_EQ(light.at(frame, 1, 0).r, linear[0]);
    EXPECT_EQ(light.at(frame, 2, 0).r, linear[80]);
    EXPECT_EQ(light.at(frame, 0, 1).r, linear[80]) << "its neighbour is hot too";
    EXPECT_EQ(light.at(frame, -5, 1).r, linear[80]) << "beside the picture";
    GreyImage sum(4, 2, 1.0f);
    light.addTo(sum, frame);
    EXPECT_NEAR(sum.at(1, 0), 1 + linear[0] / 3, 1e-6);
    EXPECT_NEAR(sum.at(1, 1), 1 + linear[80] / 3, 1e-6);
    EXPECT_NEAR(sum.at(3, 1), 1 + linear[120] / 3, 1e-6);
}

}  // namespace
}  // namespace fantascope::vision
