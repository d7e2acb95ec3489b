#include "vision/corner_markers.h"

#include "core/random.h"

#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace fantascope::vision {
namespace {

using testing::HasSubstr;

struct Placed {
    std::size_t marker;
    glm::dvec2 middle;  // pixels
    double turn;        // radians
};

// Markers on white paper on a grey wall, averaged over each pixel, with noise.
GreyImage pictureOf(const std::vector<Placed>& markers, double cell, float noise, Rng& rng) {
    constexpr int kSide = 4;  // samples across and down a pixel
    GreyImage picture(320, 240);
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            float& light = picture.at(x, y);
            for (int i = 0; i < kSide * kSide; ++i) {
                const glm::dvec2 at = glm::dvec2(x, y) + (glm::dvec2(i % kSide, i / kSide) + 0.5) / double(kSide);
                float sample = 0.3f;
                for (const Placed& placed : markers) {
                    const glm::dvec2 away = at - placed.middle;
                    const double c = std::cos(placed.turn), s = std::sin(placed.turn);
                    const glm::dvec2 cells =
                        glm::dvec2(c * away.x + s * away.y, -s * away.x + c * away.y) / cell + CornerMarker::kCells / 2.0;
                    if (std::min(cells.x, cells.y) < -1 || std::max(cells.x, cells.y) > CornerMarker::kCells + 1) continue;
                    const glm::ivec2 inside(glm::floor(cells));
                    const bool onMarker =
                        std::min(inside.x, inside.y) >= 0 && std::max(inside.x, inside.y) < CornerMarker::kCells;
                    const auto index = static_cast<std::size_t>(inside.y * CornerMarker::kCells + inside.x);
                    sample = onMarker && CornerMarker::darkCells(placed.marker)[index] ? 0.03f : 0.7f;
                }
                light += sample / (kSide * kSide);
            }
            light = std::max(0.0f, light + noise * static_cast<float>(rng.normal()));
        }
    return picture;
}

const std::vector<Placed> kFour = {
    {0, {60.3, 50.8}, 0.1}, {1, {250.6, 60.2}, -0.2}, {2, {240.1, 190.4}, 0.5}, {3, {70.7, 180.9}, 1.6}};

TEST(CornerMarkers, are_found_to_a_fraction_of_a_pixel_however_they_are_turned) {
    Rng rng(1);
    for (const double cell : {3.0, 4.0, 8.0}) {
        const auto found = findCornerMarkers(pictureOf(kFour, cell, 0.005f, rng));
        ASSERT_TRUE(found) << cell << ": " << found.error().message();
        for (std::size_t i = 0; i < kFour.size(); ++i)
            EXPECT_LT(glm::distance((*found)[i], kFour[i].middle), 0.3) << cell << ' ' << i;
    }
}

TEST(CornerMarkers, are_named_if_they_are_missing_or_twice) {
    Rng rng(1);
    auto markers = kFour;
    markers.erase(markers.begin() + 1);
    EXPECT_THAT(findCornerMarkers(pictureOf(markers, 4, 0, rng)).error().message(), HasSubstr("these markers: top right;"));
    markers[0].marker = 3;
    EXPECT_THAT(findCornerMarkers(pictureOf(markers, 4, 0, rng)).error().message(), HasSubstr("two markers of the bottom left"));
    EXPECT_THAT(findCornerMarkers(GreyImage(320, 240)).error().message(),
                HasSubstr("top left, top right, bottom right, bottom left"));
}

}  // namespace
}  // namespace fantascope::vision
