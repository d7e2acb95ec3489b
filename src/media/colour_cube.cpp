#include "media/colour_cube.h"

#include "core/file.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

namespace fantascope {
namespace {

// A line's words, separated by tabs and spaces.
std::vector<std::string_view> wordsOf(std::string_view line) {
    std::vector<std::string_view> words;
    while (true) {
        const std::size_t begin = line.find_first_not_of(" \t\r");
        if (begin == std::string_view::npos || line[begin] == '#') return words;
        const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
        words.push_back(line.substr(begin, end - begin));
        line.remove_prefix(end);
    }
}

std::optional<float> numberOf(std::string_view word) {
    if (word.starts_with('+')) word.remove_prefix(1);
    float value = 0;
    const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (failure != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

std::optional<glm::vec3> colourOf(const std::vector<std::string_view>& words, std::size_t first) {
    if (words.size() != first + 3) return std::nullopt;
    const auto r = numberOf(words[first]), g = numberOf(words[first + 1]), b = numberOf(words[first + 2]);
    if (!r || !g || !b) return std::nullopt;
    return glm::vec3(*r, *g, *b);
}

}  // namespace

Result<ColourCube> ColourCube::read(const std::filesystem::path& file) {
    const std::string text = TRY(readFile(file));
    ColourCube cube;
    std::size_t wanted = 0;
    int number = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const auto words = wordsOf(std::string_view(text).substr(begin, end - begin));
        begin = end + 1;
        ++number;
        const auto wrong = [&](const std::string& why) { return Error(fmt::format("{}:{}: {}", file.string(), number, why)); };
        if (words.empty() || words[0] == "TITLE") continue;
        if (words[0] == "LUT_1D_SIZE")
            return wrong("a one-dimensional table; a LUT_3D_SIZE is needed here, or use 'gamma' and 'white'");
        if (words[0] == "LUT_3D_SIZE") {
            const auto side = words.size() == 2 ? numberOf(words[1]) : std::nullopt;
            if (!side || *side < 2 || *side > kMaxSide || *side != std::floor(*side))
                return wrong(fmt::format("LUT_3D_SIZE is a whole number in 2 .. {}", kMaxSide));
            cube.side = static_cast<int>(*side);
            wanted =
                static_cast<std::size_t>(cube.side) * static_cast<std::size_t>(cube.side) * static_cast<std::size_t>(cube.side);
            cube.colours.reserve(wanted);
        } else if (words[0] == "DOMAIN_MIN" || words[0] == "DOMAIN_MAX") {
            const auto domain = colourOf(words, 1);
            if (!domain) return wrong(fmt::format("{} is followed by three numbers", words[0]));
            (words[0] == "DOMAIN_MIN" ? cube.low : cube.high) = *domain;
        } else if (numberOf(words[0])) {
            const auto colour = colourOf(words, 0);
            if (!colour) return wrong("a colour is three numbers");
            if (cube.side == 0) return wrong("colours before LUT_3D_SIZE; this is not a .cube file");
            if (cube.colours.size() == wanted) return wrong(fmt::format("more than the {} colours of its size", wanted));
            cube.colours.push_back(*colour);
        } else if (cube.side == 0) {
            return wrong(fmt::format("a .cube file does not begin with '{}'", words[0].substr(0, 40)));
        }  // other keywords are for other programs
    }
    if (cube.side == 0) return Error(fmt::format("{}: has no LUT_3D_SIZE; this is not a .cube file", file.string()));
    if (cube.colours.size() < wanted)
        return Error(fmt::format("{}: is cut off: it has {} of {} colours", file.string(), cube.colours.size(), wanted));
    if (!glm::all(glm::lessThan(cube.low, cube.high)))
        return Error(fmt::format("{}: DOMAIN_MIN is not below DOMAIN_MAX", file.string()));
    return cube;
}

glm::vec3 ColourCube::at(glm::vec3 colour) const {
    const glm::vec3 place = glm::clamp((colour - low) / (high - low), 0.0f, 1.0f) * static_cast<float>(side - 1);
    const glm::ivec3 cell = glm::min(glm::ivec3(place), glm::ivec3(side - 2));
    const glm::vec3 share = place - glm::vec3(cell);
    glm::vec3 sum(0);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::ivec3 on(corner & 1, corner >> 1 & 1, corner >> 2), point = cell + on;
        const glm::vec3 weight = glm::mix(1.0f - share, share, glm::vec3(on));
        sum += weight.x * weight.y * weight.z * colours[static_cast<std::size_t>((point.z * side + point.y) * side + point.x)];
    }
    return sum;
}

}  // namespace fantascope
