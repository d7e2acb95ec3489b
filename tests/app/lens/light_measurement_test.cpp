// Measures the light of cameras that are made up: their curve, their dark level and their hot
// pixels are known.

#include "app/lens/light_measurement.h"

#include "vision/camera_light.h"

#include "core/random.h"

#include <gmock/gmock.h>

#include <cmath>
#include <memory>

namespace fantascope::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr glm::ivec2 kSize{96, 72};

// What all openings of one camera share.
struct Made {
    double gamma = 1.7, dark = 9;
    bool lockable = true, followsExposure = true, covered = true;
    std::vector<glm::ivec2> hot{{40, 20}, {3, 70}};
    ManualClock clock;
    std::vector<std::string> told;
};

class MadeCamera final : public LensCamera {
public:
    MadeCamera(Made& made, std::optional<int> exposure) : made_(made), exposure_(exposure) {}
    std::shared_ptr<const CameraFrame> next() override {
        made_.clock.advance(std::chrono::milliseconds(33));
        auto frame = std::make_shared<CameraFrame>();
        frame->image = RgbaImage(kSize.x, kSize.y);
        const double time = made_.followsExposure ? exposure_.value_or(100) / 100.0 : 1;
        for (int y = 0; y < kSize.y; ++y)
            for (int x = 0; x < kSize.x; ++x) {
                // From 1/200 to a little more than full white.
                const double scene = 0.005 * std::pow(240, (x + y / 72.0) / kSize.x);
                const double light = made_.covered ? 0 : std::min(1.0, scene * time);
                const double stored = made_.dark + (255 - made_.dark) * std::pow(light, 1 / made_.gamma) + 0.5 * rng_.normal();
                const auto byte = static_cast<std::uint8_t>(std::lround(std::clamp(stored, 0.0, 255.0)));
                frame->image.at(x, y) = {byte, byte, byte, 255};
            }
        for (const glm::ivec2 pixel : made_.hot) frame->image.at(pixel.x, pixel.y) = {120, 30, 30, 255};
        return frame;
    }
    DeviceStatus status() const override { return {.name = "camera", .driver = "made", .state = DeviceState::Running, .detail = ""}; }
    CameraDescription description() const override {
        CameraDescription description{.card = "Made", .serial = "1", .format = "", .lacks = "", .exposure = {}};
        if (exposure_ && made_.lockable) description.exposure = std::chrono::microseconds(100) * *exposure_;
        return description;
    }

private:
    Made& made_;
    const std::optional<int> exposure_;
    Rng rng_{5};
};

Result<LightResult> measured(Made& made) {
    LightMeasurement measurement(
        [&](std::optional<int> exposure) -> Result<std::unique_ptr<LensCamera>> {
            return std::unique_ptr<LensCamera>(new MadeCamera(made, exposure));
        },
        made.clock,
        {[] { return true; },
         [&](double, const std::string& doing) {
             if (made.told.empty() || made.told.back() != doing) made.told.push_back(doing);
             // The person does what is said.
             if (doing.starts_with("uncover")) made.covered = false;
         }});
    return measurement.measure(100);
}

TEST(LightMeasurement, finds_the_dark_frame_and_the_response) {
    Made made;
    const auto light = measured(made);
    ASSERT_TRUE(light) << light.error().message();
    EXPECT_THAT(light->trouble, IsEmpty());
    EXPECT_NEAR(light->dark, 9, 0.3);
    EXPECT_THAT(light->light.hotPixels, ElementsAre(glm::ivec2(40, 20), glm::ivec2(3, 70)));
    EXPECT_EQ(light->exposures, 6);
    const vision::CameraLight camera(light->light.response, {});
    for (double part = 0.02; part < 1; part += 0.02) {
        const double stored = 9 + 246 * std::pow(part, 1 / made.gamma);
        EXPECT_NEAR(camera.ofStored()[static_cast<std::size_t>(std::lround(stored))], part, 0.03) << part;
    }
    EXPECT_THAT(made.told.front(), HasSubstr("cover the camera's lens"));
}

TEST(LightMeasurement, takes_srgb_where_the_exposure_cannot_be_set_or_does_nothing) {
    Made made;
    made.lockable = false;
    auto light = measured(made);
    ASSERT_TRUE(light);
    EXPECT_THAT(light->trouble, HasSubstr("does not let its exposure be set"));
    EXPECT_EQ(light->exposures, 0);
    EXPECT_EQ(light->light.response.front(), 0);
    EXPECT_NEAR(light->light.response[9], linearFromSrgb(135.0f / 255), 0.01);
    EXPECT_THAT(light->sentence(), HasSubstr("sRGB"));

    Made stubborn;
    stubborn.followsExposure = false;
    light = measured(stubborn);
    ASSERT_TRUE(light);
    EXPECT_THAT(light->trouble, HasSubstr("contradict each other"));
}

TEST(LightMeasurement, refuses_a_lens_that_is_not_covered) {
    Made made;
    for (int i = 0; i < 60; ++i) made.hot.emplace_back(i, 50);
    made.dark = 2;
    EXPECT_TRUE(measured(made)) << "so many may be hot";
    // Nothing darkens the picture: it waits, and can be ended.
    made.covered = false;
    int asked = 0;
    LightMeasurement measurement(
        [&](std::optional<int> exposure) -> Result<std::unique_ptr<LensCamera>> {
            return std::unique_ptr<LensCamera>(new MadeCamera(made, exposure));
        },
        made.clock, {[&] { return ++asked < 40; }, [](double, const std::string&) {}});
    EXPECT_THAT(measurement.measure(100).error().message(), HasSubstr("it was ended"));
    EXPECT_EQ(asked, 40);
}

}  // namespace
}  // namespace fantascope::app
