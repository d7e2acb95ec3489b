#include "drivers/display/monitor.h"

#include <fmt/format.h>
#include <glm/vector_relational.hpp>

#include <utility>

namespace fantascope::drivers {
namespace {

// As a value in a one-line map, where more characters have a meaning than elsewhere.
std::string inFlow(const std::string& text) {
    std::string safe = fantascope::quoted(text);
    if (safe != text || text.find_first_of(",[]{}") == std::string::npos) return safe;
    safe = "'";
    for (const char letter : text) safe += letter == '\'' ? "''" : std::string(1, letter);
    return safe + "'";
}

std::string mapOf(const std::vector<std::pair<std::string, std::string>>& entries) {
    std::vector<std::string> texts;
    for (const auto& [key, value] : entries)
        if (!value.empty()) texts.push_back(key + ": " + inFlow(value));
    return "{" + listed(texts) + "}";
}

}  // namespace

bool Area::overlaps(const Area& other) const {
    return glm::all(glm::lessThan(corner, other.end())) && glm::all(glm::lessThan(other.corner, end()));
}

std::string Monitor::text() const {
    if (!identity) return connector + " (without EDID)";
    return connector + " " + mapOf({{"make", identity->make}, {"model", identity->model}, {"serial", identity->serial}});
}

Result<MonitorChoice> MonitorChoice::fromConfig(const ConfigNode& node) {
    MonitorChoice choice;
    if (!node.isMap()) {
        choice.connector = TRY(node.text());
        return choice;
    }
    ConfigFields fields(node);
    fields.optional().text("connector", choice.connector);
    fields.optional().text("make", choice.make);
    fields.optional().text("model", choice.model);
    fields.optional().text("serial", choice.serial);
    TRY(fields.finish());
    if (choice.connector.empty() && choice.make.empty() && choice.model.empty() && choice.serial.empty())
        return node.error("says nothing; give at least one of connector, make, model, serial");
    return choice;
}

bool MonitorChoice::fits(const Monitor& monitor) const {
    const MonitorIdentity identity = monitor.identity.value_or(MonitorIdentity{});
    const auto agrees = [](const std::string& asked, const std::string& is) { return asked.empty() || asked == is; };
    return agrees(connector, monitor.connector) && agrees(make, identity.make) && agrees(model, identity.model) &&
           agrees(serial, identity.serial);
}

std::string MonitorChoice::text() const {
    if (make.empty() && model.empty() && serial.empty()) return connector;
    return mapOf({{"connector", connector}, {"make", make}, {"model", model}, {"serial", serial}});
}

}  // namespace fantascope::drivers
