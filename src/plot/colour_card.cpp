#include "core/check.h"
#include "plot/sheet.h"
#include "plot/test_picture.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace fantascope::plot {
namespace {

// Rounds so that neighbouring patches leave no gap, whatever the card's size.
void patch(RgbaImage& card, glm::dvec2 low, glm::dvec2 high, Rgba8 colour) {
    const glm::dvec2 size(card.width(), card.height());
    const glm::ivec2 from(glm::round(low * size)), to(glm::round(high * size));
    for (int y = from.y; y < to.y; ++y)
        for (int x = from.x; x < to.x; ++x) card.at(x, y) = colour;
}

RgbaImage bars(glm::ivec2 size) {
    RgbaImage card(size.x, size.y);
    constexpr std::uint8_t k75 = 191;
    // `bits`: bit 2 is red, bit 1 green, bit 0 blue.
    const auto colour = [](int bits, std::uint8_t value) {
        const auto of = [&](int bit) { return (bits >> bit & 1) != 0 ? value : std::uint8_t{0}; };
        return Rgba8{of(2), of(1), of(0), 255};
    };
    constexpr std::array<int, 7> kBars{7, 6, 3, 2, 5, 4, 1}, kReverse{1, 0, 5, 0, 3, 0, 7}, kFull{7, 0, 4, 2, 1, 0, 0};
    for (int i = 0; i < 7; ++i) {
        const auto at = static_cast<std::size_t>(i);
        patch(card, {i / 7.0, 0}, {(i + 1) / 7.0, 2 / 3.0}, colour(kBars[at], k75));
        patch(card, {i / 7.0, 2 / 3.0}, {(i + 1) / 7.0, 0.75}, colour(kReverse[at], k75));
        patch(card, {i / 7.0, 0.75}, {(i + 1) / 7.0, 1}, colour(kFull[at], 255));
    }
    for (int i = 0; i < 3; ++i)
        patch(card, {(18 + i) / 21.0, 0.75}, {(19 + i) / 21.0, 1}, colour(7, static_cast<std::uint8_t>(5 * (i + 1))));
    return card;
}

RgbaImage ramp(glm::ivec2 size) {
    struct Row {
        int from, to, steps;
        bool labelled;
    };
    constexpr std::array<Row, 4> kRows{{{0, 255, 17, true}, {0, 255, 256, false}, {0, 32, 33, true}, {223, 255, 33, true}}};
    RgbaImage card(size.x, size.y);
    Sheet letters(size);
    for (std::size_t r = 0; r < kRows.size(); ++r) {
        const Row& row = kRows[r];
        const double low = double(r) / kRows.size(), high = double(r + 1) / kRows.size();
        for (int i = 0; i < row.steps; ++i) {
            const double left = double(i) / row.steps, right = double(i + 1) / row.steps;
            const long stored = std::lround(row.from + double(row.to - row.from) * i / (row.steps - 1));
            const auto value = static_cast<std::uint8_t>(stored);
            patch(card, {left, low}, {right, high}, {value, value, value, 255});
            const double font = std::min(24 * letters.unit(), (right - left) * size.x / 2.4);
            if (!row.labelled || font < 7) continue;
            // Labels are no brighter than necessary: next to a bright letter the darkest steps are
            // invisible.
            letters.text(std::to_string(stored), glm::dvec2((left + right) / 2 * size.x, high * size.y - 1.2 * font), font,
                         (stored < 128 ? stored + 56 : stored - 72) / 255.0);
        }
    }
    const RgbaImage over = letters.image(size, {0, 0}, {1, 0}, {0, 1});
    for (std::size_t i = 0; i < over.pixels().size(); ++i) {
        const Rgba8 above = over.pixels()[i];
        Rgba8& below = card.pixels()[i];
        const auto value = static_cast<std::uint8_t>(above.r + (below.r * (255 - above.a) + 127) / 255);
        below = {value, value, value, 255};
    }
    return card;
}

}  // namespace

RgbaImage drawColourCard(TestPicture picture, glm::ivec2 size) {
    FANTASCOPE_CHECK(picture == TestPicture::Bars || picture == TestPicture::Ramp, "only bars and ramp are colour cards");
    FANTASCOPE_CHECK(std::min(size.x, size.y) > 0, "a picture has pixels");
    return picture == TestPicture::Bars ? bars(size) : ramp(size);
}

}  // namespace fantascope::plot
