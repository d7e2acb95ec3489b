// Light whose way through the lens can be computed by hand.

#include "drivers/site/optics.h"

#include <gmock/gmock.h>

#include <cmath>

namespace fantascope::site {
namespace {

TEST(SiteOptics, a_blurred_point_is_a_gaussian_with_the_same_light) {
    Image<glm::vec3> light(41, 31);
    light.at(20, 15) = {100, 50, 0};
    blurLight(light, 2);
    double sum = 0;
    for (const glm::vec3& pixel : light.pixels()) sum += pixel.r;
    EXPECT_NEAR(sum, 100, 1e-3);
    const double peak = light.at(20, 15).r;
    EXPECT_NEAR(peak, 100 / (2 * 3.14159265 * 4), 0.01);
    EXPECT_NEAR(light.at(22, 15).r, peak * std::exp(-0.5), 1e-4 * peak);
    EXPECT_NEAR(light.at(20, 12).r, peak * std::exp(-9.0 / 8), 1e-4 * peak);
    EXPECT_NEAR(light.at(23, 19).g, peak / 2 * std::exp(-25.0 / 8), 1e-4 * peak);
}

// Example failure: the picture's edge darkens, because what is beyond it counts as black.
TEST(SiteOptics, even_light_stays_even_when_it_is_blurred) {
    Image<glm::vec3> light(9, 3, glm::vec3(5));
    blurLight(light, 20);
    for (const glm::vec3& pixel : light.pixels()) EXPECT_NEAR(pixel.g, 5, 1e-4);
}

TEST(SiteOptics, vignetting_takes_light_with_the_square_of_the_distance) {
    Image<glm::vec3> light(80, 60, glm::vec3(1));
    const Image<glm::vec3> before = light;
    vignette(light, 0);
    EXPECT_EQ(light, before);
    vignette(light, 0.4);
    EXPECT_NEAR(light.at(40, 30).g, 1 - 0.4 * 0.5 / 2500, 1e-6) << "half a pixel from the middle both ways";
    EXPECT_NEAR(light.at(0, 0).g, 1 - 0.4 * (39.5 * 39.5 + 29.5 * 29.5) / 2500, 1e-6);
    EXPECT_NEAR(light.at(0, 30).g, 1 - 0.4 * (39.5 * 39.5 + 0.25) / 2500, 1e-6);
    EXPECT_EQ(light.at(79, 59), light.at(0, 0));
}

}  // namespace
}  // namespace fantascope::site
