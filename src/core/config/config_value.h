#pragma once

#include "core/check.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <concepts>
#include <ranges>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace fantascope {

// A value to write: a finite number, a text, a list or a map. Converts from the program's types:
// {"corners", std::array<glm::dvec2, 4>}.
class ConfigValue {
public:
    using List = std::vector<ConfigValue>;
    using Map = std::vector<std::pair<std::string, ConfigValue>>;  // each key once

    ConfigValue(double number) : held_(number) { FANTASCOPE_CHECK(std::isfinite(number), "a file takes finite numbers only"); }
    ConfigValue(std::string text) : held_(std::move(text)) {}
    ConfigValue(const char* text) : held_(std::string(text)) {}
    ConfigValue(const glm::dvec2& vector) : held_(List{vector.x, vector.y}) {}
    ConfigValue(const glm::dvec3& vector) : held_(List{vector.x, vector.y, vector.z}) {}
    ConfigValue(List items) : held_(std::move(items)) {}
    ConfigValue(Map entries) : held_(std::move(entries)) {}
    template <std::ranges::input_range Range>
    requires(!std::convertible_to<const Range&, std::string_view> &&
             std::convertible_to<std::ranges::range_reference_t<const Range&>, ConfigValue>) ConfigValue(const Range& items)
        : held_(List(items.begin(), items.end())) {}

    const double* number() const { return std::get_if<double>(&held_); }
    const std::string* text() const { return std::get_if<std::string>(&held_); }
    const List* list() const { return std::get_if<List>(&held_); }
    const Map* map() const { return std::get_if<Map>(&held_); }

private:
    std::variant<double, std::string, List, Map> held_;
};

}  // namespace fantascope
