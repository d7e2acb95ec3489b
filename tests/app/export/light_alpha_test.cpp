#include "app/export/light_alpha.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace fantascope::app {
namespace {

// Every brightness of a white, a coloured and a lopsided pixel.
RgbaImage ramps() {
    RgbaImage frame(256, 3);
    for (int x = 0; x < 256; ++x) {
        const auto full = static_cast<std::uint8_t>(x), half = static_cast<std::uint8_t>(x / 2),
                   tenth = static_cast<std::uint8_t>(x / 10);
        frame.at(x, 0) = {full, full, full, 255};
        frame.at(x, 1) = {half, full, tenth, 255};
        frame.at(x, 2) = {0, tenth, full, 255};
    }
    return frame;
}

// What a program shows that lays the picture over black: its own step, in the values that it works
// in.
double overBlack(Alpha alpha, std::uint16_t colour, std::uint16_t cover) {
    const float c = static_cast<float>(colour) / 65535, a = static_cast<float>(cover) / 65535;
    return 255 * (alpha == Alpha::Stored ? a * c : srgbFromLinear(a * linearFromSrgb(c)));
}

// Example failure: alpha for linear light where the program blends stored values, which fattens
// every soft edge.
TEST(LightAlpha, over_black_is_the_frame_again) {
    const RgbaImage frame = ramps();
    for (const Alpha alpha : {Alpha::Stored, Alpha::Linear}) {
        const Rgba16Image picture = withAlpha(frame, alpha);
        for (std::size_t i = 0; i < frame.pixels().size(); ++i) {
            const Rgba8 wanted = frame.pixels()[i];
            const Rgba16 got = picture.pixels()[i];
            EXPECT_NEAR(overBlack(alpha, got.r, got.a), wanted.r, 0.5) << name(alpha) << i;
            EXPECT_NEAR(overBlack(alpha, got.g, got.a), wanted.g, 0.5) << name(alpha) << i;
            EXPECT_NEAR(overBlack(alpha, got.b, got.a), wanted.b, 0.5) << name(alpha) << i;
        }
    }
}

TEST(LightAlpha, black_is_clear_and_full_light_of_any_colour_covers) {
    RgbaImage frame(3, 1);
    frame.at(0, 0) = {0, 0, 0, 255};
    frame.at(1, 0) = {255, 255, 255, 255};
    frame.at(2, 0) = {0, 255, 0, 255};
    for (const Alpha alpha : {Alpha::Stored, Alpha::Linear}) {
        const Rgba16Image picture = withAlpha(frame, alpha);
        EXPECT_EQ(picture.at(0, 0), (Rgba16{0, 0, 0, 0}));
        EXPECT_EQ(picture.at(1, 0), (Rgba16{65535, 65535, 65535, 65535}));
        EXPECT_EQ(picture.at(2, 0), (Rgba16{0, 65535, 0, 65535}));
    }
}

// A grey is white that covers in part, not a grey that covers: else a fading light would show a
// dark edge over a bright picture.
TEST(LightAlpha, a_dim_light_keeps_its_full_colour) {
    const Rgba16Image stored = withAlpha(RgbaImage(1, 1, {100, 100, 100, 255}), Alpha::Stored),
                      linear = withAlpha(RgbaImage(1, 1, {100, 100, 100, 255}), Alpha::Linear);
    EXPECT_EQ(stored.at(0, 0).g, 65535);
    EXPECT_NEAR(stored.at(0, 0).a / 65535.0, 100 / 255.0, 1e-5);
    EXPECT_EQ(linear.at(0, 0).g, 65535);
    EXPECT_NEAR(linear.at(0, 0).a / 65535.0, linearFromSrgb(100 / 255.0f), 1e-5);
}

}  // namespace
}  // namespace fantascope::app
