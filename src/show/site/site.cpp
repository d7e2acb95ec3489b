#include "show/site/site.h"

#include "core/check.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::show {

namespace {

constexpr std::pair<std::string_view, Button> kButtonKeys[] = {
    {"go", Button::Go},           {"back", Button::Back},     {"blackout", Button::Blackout},
    {"pause", Button::Pause},     {"freeze", Button::Freeze}, {"panic", Button::Panic},
    {"restore", Button::Restore}, {"edit", Button::Edit},     {"left", Button::Left},
    {"right", Button::Right},     {"up", Button::Up},         {"down", Button::Down},
    {"next", Button::Next},       {"output", Button::Output}, {"tool", Button::Tool},
    {"picture", Button::Picture}, {"undo", Button::Undo},     {"write", Button::Write}};

}  // namespace

std::string_view nameOf(Button button) {
    for (const auto& [key, known] : kButtonKeys)
        if (known == button) return key;
    FANTASCOPE_CHECK(false, "every button has a key");
}

Site Site::scaled(glm::dvec2 factor) const {
    Site result = *this;
    for (Output& output : result.outputs) {
        Projection& projection = output.projection;
        projection.size = glm::max(glm::ivec2(glm::round(glm::dvec2(projection.size) * factor)), 1);
        projection.warp = Warp::of(projection.warp.shape().scaled(factor)).value();
        for (Mask& mask : projection.masks) {
            for (glm::dvec2& point : mask.polygon) point *= factor;
            mask.feather *= std::sqrt(factor.x * factor.y);
        }
    }
    return result;
}

std::vector<std::size_t> Site::outputsOn(std::string_view canvas) const {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < outputs.size(); ++i)
        if (outputs[i].canvas == canvas) found.push_back(i);
    return found;
}

std::size_t Site::firstLevel(std::size_t fixture) const {
    std::size_t channels = 0;
    for (std::size_t before = 0; before < fixture; ++before) channels += fixtures[before].channels.size();
    return channels;
}

std::size_t Site::channelCount() const { return firstLevel(fixtures.size()); }

std::size_t Site::coilCount(std::size_t bank) const {
    std::size_t count = 0;
    for (const Relay& relay : relays)
        if (relay.bank == bank) count = std::max(count, static_cast<std::size_t>(relay.coil) + 1);
    return count;
}

std::size_t Site::inputCount(std::size_t bank) const {
    std::size_t count = 0;
    for (const Contact& contact : contacts)
        if (contact.bank == bank) count = std::max(count, static_cast<std::size_t>(contact.input) + 1);
    return count;
}

}  // namespace fantascope::show
