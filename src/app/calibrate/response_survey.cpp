// How an output's light follows what is sent to it: part of its survey.

#include "app/calibrate/light_survey.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

using vision::PrimarySight;

constexpr std::size_t kGreys = 7;           // between black and white
constexpr int kResponseRounds = 3;          // the colours are shown again so often at most
constexpr double kDisturbedShare = 0.02;    // of the lit pixels: more of them, and the colours are shown again
constexpr float kBrightest = 0.9f;          // of the camera's range: brighter pixels may be cut off there
constexpr std::size_t kFewestBright = 100;  // pixels
constexpr double kUsualGamma = 2.2;

Rgba8 greyAt(std::size_t index) {
    const auto value = static_cast<std::uint8_t>(255 * (index + 1) / (kGreys + 1));
    return {value, value, value, 255};
}

Rgba8 colourAt(std::size_t index) {
    const glm::ivec3 on = PrimarySight::kColours.at(index);
    const auto value = [](int share) { return static_cast<std::uint8_t>(255 * share); };
    return {value(on.r), value(on.g), value(on.b), 255};
}

// The brightest quarter of the pixels: in dark ones the noise is cut off at zero.
std::vector<std::size_t> pixelsForGreys(const vision::LightDecoder& sight) {
    const auto full = sight.full().pixels();
    const std::vector<std::size_t> lit = sight.litPixels();
    std::vector<std::size_t> pixels;
    std::ranges::copy_if(lit, std::back_inserter(pixels), [&](std::size_t pixel) { return full[pixel] < kBrightest; });
    if (pixels.size() < kFewestBright) pixels = lit;
    const auto quarter = pixels.begin() + static_cast<std::ptrdiff_t>(pixels.size() / 4);
    std::ranges::nth_element(pixels, quarter, [&](std::size_t a, std::size_t b) { return full[a] > full[b]; });
    pixels.erase(quarter + 1, pixels.end());
    return pixels;
}

// The median over the pixels does not mind somebody before some of them.
double lightOfGrey(const GreyImage& grey, const vision::LightDecoder& sight, const std::vector<std::size_t>& pixels) {
    const auto full = sight.full().pixels(), dark = sight.dark().pixels();
    std::vector<double> lights;
    lights.reserve(pixels.size());
    for (const std::size_t pixel : pixels)
        lights.push_back(double(grey.pixels()[pixel] - dark[pixel]) / double(full[pixel] - dark[pixel]));
    const auto middle = lights.begin() + static_cast<std::ptrdiff_t>(lights.size() / 2);
    std::ranges::nth_element(lights, middle);
    return *middle;
}

}  // namespace

// Shows greys, and the primaries if the output's white is to be matched with others; those again
// that were disturbed.
Result<void> LightSurvey::measureResponse(std::size_t output, const vision::LightDecoder& sight, Output& found) {
    const glm::ivec2 size = site_.outputs[output].size(), camera = site_.nominalCamera->size;
    const std::vector<std::size_t> pixels = pixelsForGreys(sight);
    PrimarySight primaries(sight);
    std::optional<double> gamma;
    bool colours = site_.outputsOn(site_.outputs[output].canvas).size() > 1;
    for (int round = 0; round < kResponseRounds && (!gamma || colours); ++round) {
        const std::size_t greys = gamma ? 0 : kGreys, all = greys + (colours ? PrimarySight::kColours.size() : 0);
        PrimarySight::Pictures seen;
        const auto picture = [&](std::size_t i) {
            return std::make_shared<const RgbaImage>(size.x, size.y, i < greys ? greyAt(i) : colourAt(i - greys));
        };
        const auto addColours = [&](std::size_t i, const RgbaImage& frame) {
            if (i < greys) return;
            Image<glm::vec3>& sum = seen.at(i - greys);
            if (sum.empty()) sum = Image<glm::vec3>(camera.x, camera.y);
            for (int y = 0; y < camera.y; ++y)
                for (int x = 0; x < camera.x; ++x) sum.at(x, y) += light_.at(frame, x, y);
        };
        const std::vector<Taken> taken = TRY(take(output, all, picture, 1, addColours));
        if (round > 0) found.repeated += static_cast<int>(all);
        share_ = 0;  // what is repeated is no progress
        std::vector<vision::GreyLight> lights;
        for (std::size_t i = 0; i < greys; ++i)
            if (taken[i].frames > 0) lights.push_back({greyAt(i).r / 255.0, lightOfGrey(taken[i].light, sight, pixels)});
        if (!gamma) gamma = vision::fitGamma(std::move(lights));
        if (!colours || std::ranges::any_of(seen, &Image<glm::vec3>::empty)) continue;
        for (std::size_t i = 0; i < seen.size(); ++i)
            for (glm::vec3& light : seen[i].pixels()) light /= static_cast<float>(taken[greys + i].frames);
        primaries.take(seen);
        colours = primaries.undecided() > kDisturbedShare;
    }
    found.gammaIsKnown = gamma.has_value();
    found.gamma = gamma.value_or(kUsualGamma);
    found.primaries = primaries.light();
    return {};
}

}  // namespace fantascope::app
