#include "drivers/site/sensor.h"

#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::site {
namespace {

constexpr Sensor::Settings kNoiseless{40, 0, 0};

Image<glm::vec3> even(float luminance, int width = 320, int height = 180) { return {width, height, glm::vec3(luminance)}; }

struct Statistics {
    double mean = 0, deviation = 0;
};

Statistics linearStatistics(const RgbaImage& image) {
    double sum = 0, squares = 0;
    for (const Rgba8 pixel : image.pixels()) {
        const double linear = linearFromSrgb(static_cast<float>(pixel.g) / 255);
        sum += linear;
        squares += linear * linear;
    }
    const auto count = static_cast<double>(image.pixels().size());
    return {sum / count, std::sqrt(squares / count - sum / count * sum / count)};
}

TEST(Sensor, stores_srgb_of_luminance_over_white) {
    const Sensor sensor(kNoiseless, 1);
    const auto stored = [&](float luminance) { return sensor.expose(even(luminance, 1, 1), 0).at(0, 0).r; };
    EXPECT_EQ(stored(0), 0);
    EXPECT_EQ(stored(40), 255);
    EXPECT_EQ(stored(400), 255) << "brighter than white is white";
    EXPECT_EQ(stored(40 * 0.2158605f), 128) << "half of the stored range is a fifth of the light";
    const RgbaImage colour = sensor.expose(Image<glm::vec3>(1, 1, glm::vec3(40, 0, 8)), 0);
    EXPECT_EQ(colour.at(0, 0), (Rgba8{255, 0, 124, 255}));
}

// Variance grows linearly with the light: read^2 + shot^2 v.
TEST(Sensor, noise_has_the_deviation_that_was_asked_for) {
    const Sensor sensor({40, 0.01, 0.04}, 7);
    for (const float share : {0.1f, 0.5f, 0.8f}) {
        const Statistics found = linearStatistics(sensor.expose(even(40 * share), 3));
        const double expected = std::sqrt(0.01 * 0.01 + 0.04 * 0.04 * share);
        EXPECT_NEAR(found.mean, share, 0.002) << share;
        EXPECT_NEAR(found.deviation, expected, 0.05 * expected) << share;
    }
}

// Each row reads the table of normal values from its own place. Example failure: every frame or row
// has the same noise, a pattern that averaging over time would never remove.
TEST(Sensor, noise_differs_from_frame_to_frame_and_from_row_to_row) {
    const Sensor sensor({40, 0.02, 0}, 7);
    const RgbaImage one = sensor.expose(even(20), 1), two = sensor.expose(even(20), 2);
    const auto correlation = [](const RgbaImage& a, int rowA, const RgbaImage& b, int rowB) {
        double ab = 0, aa = 0, bb = 0;
        for (int y = 0; y + 1 < a.height(); ++y)
            for (int x = 0; x < a.width(); ++x) {
                const double u = a.at(x, y + rowA).g - 188.0, v = b.at(x, y + rowB).g - 188.0;  // 188 stored is half of white
                ab += u * v;
                aa += u * u;
                bb += v * v;
            }
        return ab / std::sqrt(aa * bb);
    };
    EXPECT_NEAR(correlation(one, 0, two, 0), 0, 0.03);
    EXPECT_NEAR(correlation(one, 0, one, 1), 0, 0.03);
    EXPECT_NEAR(correlation(one, 0, one, 0), 1, 1e-9);
}

TEST(Sensor, noise_is_the_same_for_the_same_seed_and_frame) {
    const Sensor::Settings noisy{40, 0.02, 0.02};
    const Sensor sensor(noisy, 7), same(noisy, 7), other(noisy, 8);
    (void)sensor.expose(even(10), 4);  // earlier exposures leave no trace
    EXPECT_EQ(sensor.expose(even(20), 5), same.expose(even(20), 5));
    EXPECT_NE(sensor.expose(even(20), 5), sensor.expose(even(20), 6));
    EXPECT_NE(sensor.expose(even(20), 5), other.expose(even(20), 5));
}

}  // namespace
}  // namespace fantascope::site
