#include "drivers/cue_controller/key_picture.h"

#include "media/glyph.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

namespace fantascope::drivers {
namespace {

using State = ButtonLight::State;

constexpr int kSamples = 4;                                   // per pixel and direction
constexpr double kGap = 0.12;                                 // between letters, in ems
constexpr double kMaxWordWidth = 0.84, kMaxWordHeight = 0.4;  // of the key
constexpr std::size_t kBmpHead = 54;

Rgba8 inkOf(State state) {
    if (state == State::Off) return {96, 96, 96, 255};  // just visible in the dark
    return state == State::Active ? Rgba8{0, 0, 0, 255} : Rgba8{255, 255, 255, 255};
}

struct Box {
    glm::dvec2 low{std::numeric_limits<double>::max()}, high{std::numeric_limits<double>::lowest()};
};
Box boxOf(const Outline& outline) {
    Box box;
    for (const auto& ring : outline.rings)
        for (const glm::dvec2& point : ring) box = {glm::min(box.low, point), glm::max(box.high, point)};
    return box;
}

// The letters side by side, x right, y up. Letters that the font lacks are left out.
Outline written(const std::string& word) {
    Outline all;
    double x = 0;
    for (const char letter : word) {
        const auto glyph = glyphOutline(static_cast<unsigned char>(letter));
        if (!glyph) continue;
        const Box box = boxOf(*glyph);
        for (auto ring : glyph->rings) {
            for (glm::dvec2& point : ring) point.x += x - box.low.x;
            all.rings.push_back(std::move(ring));
        }
        x += box.high.x - box.low.x + kGap;
    }
    return all;
}

// Fills the region inside an odd number of rings. Points are pixels, y down.
void fill(RgbaImage& image, const Outline& outline, Rgba8 ink) {
    std::vector<int> covered(static_cast<std::size_t>(image.width()));
    for (int y = 0; y < image.height(); ++y) {
        std::fill(covered.begin(), covered.end(), 0);
        for (int sample = 0; sample < kSamples; ++sample) {
            const double at = y + (sample + 0.5) / kSamples;
            std::vector<double> crossings;
            for (const auto& ring : outline.rings)
                for (std::size_t i = 0; i < ring.size(); ++i) {
                    const glm::dvec2 a = ring[i], b = ring[(i + 1) % ring.size()];
                    if ((a.y <= at) != (b.y <= at)) crossings.push_back(a.x + (b.x - a.x) * (at - a.y) / (b.y - a.y));
                }
            std::sort(crossings.begin(), crossings.end());
            for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
                // The samples whose centres lie between.
                const auto sampleAfter = [&](double x) {
                    return std::clamp(static_cast<int>(std::ceil(x * kSamples - 0.5)), 0, image.width() * kSamples);
                };
                for (int s = sampleAfter(crossings[i]); s < sampleAfter(crossings[i + 1]); ++s)
                    ++covered[static_cast<std::size_t>(s / kSamples)];
            }
        }
        for (int x = 0; x < image.width(); ++x) {
            const int share = covered[static_cast<std::size_t>(x)];
            const auto mixed = [&](std::uint8_t from, std::uint8_t to) {
                constexpr int kAll = kSamples * kSamples;
                return static_cast<std::uint8_t>((from * (kAll - share) + to * share + kAll / 2) / kAll);
            };
            Rgba8& pixel = image.at(x, y);
            pixel = {mixed(pixel.r, ink.r), mixed(pixel.g, ink.g), mixed(pixel.b, ink.b), 255};
        }
    }
}

RgbaImage turned(const RgbaImage& image, KeyPictureFormat::Turn turn) {
    using Turn = KeyPictureFormat::Turn;
    const int last = image.width() - 1;
    RgbaImage result(image.width(), image.height());
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x)
            result.at(x, y) = turn == Turn::None   ? image.at(x, y)
                              : turn == Turn::Half ? image.at(last - x, last - y)
                                                   : image.at(y, x);
    return result;
}

std::vector<std::uint8_t> bmpOf(const RgbaImage& image) {
    const auto pixels = static_cast<std::uint32_t>(image.width() * image.height() * 3);
    std::vector<std::uint8_t> bytes = {'B', 'M'};
    const auto put = [&](std::uint64_t value, int size) {
        for (int i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> 8 * i & 0xff));
    };
    put(kBmpHead + pixels, 4);
    put(0, 4);
    put(kBmpHead, 4);
    // BITMAPINFOHEADER
    put(40, 4);
    put(static_cast<std::uint32_t>(image.width()), 4);
    put(static_cast<std::uint32_t>(image.height()), 4);
    put(1, 2);
    put(24, 2);
    put(0, 4);
    put(pixels, 4);
    put(3780, 4);  // pixels per metre, as sent by Elgato's own program
    put(3780, 4);
    put(0, 8);
    for (int y = image.height() - 1; y >= 0; --y)
        for (const Rgba8& pixel : image.row(y)) bytes.insert(bytes.end(), {pixel.b, pixel.g, pixel.r});
    return bytes;
}

}  // namespace

Rgba8 colourOf(State state) {
    switch (state) {
        case State::Off:
            return {0, 0, 0, 255};
        case State::Ready:
            return {0, 112, 40, 255};
        case State::Active:
            return {232, 144, 0, 255};
        case State::Alarm:
            return {208, 0, 0, 255};
    }
    return {};
}

RgbaImage keyPicture(const ButtonLight& light, int side) {
    RgbaImage image(side, side, colourOf(light.state));
    Outline word = written(light.word);
    if (word.rings.empty()) return image;
    const Box box = boxOf(word);
    const glm::dvec2 size = box.high - box.low, middle = (box.low + box.high) / 2.0;
    const double scale = side * std::min(kMaxWordWidth / size.x, kMaxWordHeight / size.y);
    for (auto& ring : word.rings)
        for (glm::dvec2& point : ring) point = side / 2.0 + scale * (point - middle) * glm::dvec2(1, -1);
    fill(image, word, inkOf(light.state));
    return image;
}

std::vector<std::uint8_t> keyPictureFile(const ButtonLight& light, const KeyPictureFormat& format) {
    const RgbaImage image = turned(keyPicture(light, format.side), format.turn);
    // Files as large as Elgato's own program sends; no visible loss.
    constexpr int kQuality = 95;
    return format.coding == KeyPictureFormat::Coding::Jpeg ? jpegOf(image, kQuality) : bmpOf(image);
}

}  // namespace fantascope::drivers
