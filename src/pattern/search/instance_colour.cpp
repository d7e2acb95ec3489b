#include "pattern/search/instance_colour.h"

#include "pattern/shape/streams.h"

#include "core/random.h"

#include <glm/common.hpp>

#include <array>
#include <cmath>

namespace fantascope::pattern {
namespace {

using Options = PatternSearch::Options;

double rounded(double value, double steps) { return std::round(value * steps) / steps; }

double linear(std::uint8_t stored) {
    static const auto kTable = [] {
        std::array<double, 256> table{};
        for (std::size_t i = 0; i < table.size(); ++i) table[i] = linearFromSrgb(static_cast<float>(i) / 255);
        return table;
    }();
    return kTable[stored];
}

// The picture's mean over a square of side `size` around the instance's centre, at least one pixel.
// Linear light, multiplied by alpha.
glm::dvec3 meanUnder(const ShapeInstance& instance, double aspect, const RgbaImage& picture) {
    const glm::ivec2 pixels(picture.width(), picture.height());
    const glm::dvec2 scale = glm::dvec2(pixels) / glm::dvec2(aspect, 1);
    const glm::ivec2 begin =
        glm::clamp(glm::ivec2(glm::round((instance.centre - instance.size / 2) * scale)), glm::ivec2(0), pixels - 1);
    const glm::ivec2 end = glm::clamp(glm::ivec2(glm::round((instance.centre + instance.size / 2) * scale)), begin + 1, pixels);
    glm::dvec3 sum(0.0);
    for (int y = begin.y; y < end.y; ++y)
        for (int x = begin.x; x < end.x; ++x) {
            const Rgba8 pixel = picture.at(x, y);
            sum += glm::dvec3(linear(pixel.r), linear(pixel.g), linear(pixel.b)) * (pixel.a / 255.0);
        }
    return sum / double((end.x - begin.x) * (end.y - begin.y));
}

}  // namespace

glm::vec3 colourOf(const ShapeInstance& instance, double aspect, std::uint64_t seed, const Options& options) {
    const bool hasOwn = instance.shape < options.shapes.size() && !options.shapes[instance.shape].colours.empty();
    const auto& colours = hasOwn ? options.shapes[instance.shape].colours : options.colours;
    Rng rng(streamSeed(seed, {Stream::InstanceColour, instance.id}));
    const Options::Colours& entry = colours[rng.below(static_cast<std::uint32_t>(colours.size()))];
    const glm::dvec3 colour =
        entry.picture ? meanUnder(instance, aspect, *entry.picture) : glm::mix(entry.from, entry.to, rng.uniform());
    return {rounded(colour.r, 1e4), rounded(colour.g, 1e4), rounded(colour.b, 1e4)};
}

}  // namespace fantascope::pattern
