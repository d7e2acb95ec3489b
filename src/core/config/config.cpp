#include "core/config/config.h"

#include "core/clock.h"
#include "core/config/config_trace.h"
#include "core/config/config_tree.h"
#include "core/file.h"
#include "core/geometry.h"
#include "core/text.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <set>
#include <tuple>

namespace fantascope {

namespace fs = std::filesystem;

namespace {

// More than any name or path has.
constexpr std::size_t kLongestName = 4096;

// A name or a path. Numbers written as one text may be longer.
Result<std::string> shortText(const ConfigNode& node) {
    std::string text = TRY(node.text());
    if (text.size() <= kLongestName) return text;
    return node.error(fmt::format("'{}' is {} bytes long, {} are the most", printable(text), text.size(), kLongestName));
}

std::string range(double low, double high, std::string_view unit) {
    const std::string space = unit.empty() ? "" : " ";
    return fmt::format("{} .. {}{}{}", shortest(low), shortest(high), space, unit);
}

template <class Number>
bool parseNumber(const std::string& text, Number& value) {
    const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
    const char* end = text.data() + text.size();
    const auto [stop, failure] = std::from_chars(begin, end, value);
    return failure == std::errc() && stop == end && begin != end;
}

}  // namespace

void ConfigNode::trace(auto note) const {
    ConfigTrace* const listening = ConfigTrace::of(tree_->file);
    if (ConfigTrace::Asked* const asked = listening != nullptr ? listening->at(node_) : nullptr) note(*asked);
}

Result<ConfigNode> ConfigNode::load(const fs::path& path) { return parse(TRY(readFile(path)), path); }

Result<ConfigNode> ConfigNode::parse(const std::string& text, const fs::path& name) {
    return ConfigNode(TRY(ConfigTree::parse(text, name)), 0, "");
}

const fs::path& ConfigNode::file() const { return tree_->file; }

FilePlace ConfigNode::here() const {
    const auto [line, column] = position();
    return {tree_->file, line, column, key_};
}

bool ConfigNode::isMap() const { return tree_->nodes[node_].kind == ConfigTree::Kind::Map; }
bool ConfigNode::isList() const { return tree_->nodes[node_].kind == ConfigTree::Kind::List; }

std::string ConfigNode::childKey(std::string_view name) const {
    const std::string shown = printable(name);
    return key_.empty() ? shown : fmt::format("{}.{}", key_, shown);
}

std::string ConfigNode::seen() const { return describe(tree_->nodes[node_]); }

const std::string* ConfigNode::scalar() const {
    const ConfigTree::Node& node = tree_->nodes[node_];
    return node.kind == ConfigTree::Kind::Scalar ? &node.text : nullptr;
}

std::pair<int, int> ConfigNode::position() const {
    const ConfigTree::Node& node = tree_->nodes[node_];
    return {node.line, node.column};
}

bool operator==(const ConfigNode& a, const ConfigNode& b) {
    if (a.tree_ == nullptr || b.tree_ == nullptr) return a.tree_ == b.tree_;
    return readsAs(*a.tree_, a.node_, *b.tree_, b.node_);
}

Result<double> ConfigNode::number(double low, double high, std::string_view unit) const {
    trace([&](ConfigTrace::Asked& asked) { asked.numbers.push_back({low, high, false}); });
    double value = 0;
    const std::string* const text = scalar();
    if (text == nullptr || !parseNumber(*text, value) || !std::isfinite(value))
        return error(fmt::format("a number in {} is needed, here is {}", range(low, high, unit), seen()));
    if (value < low || value > high)
        return error(fmt::format("{} is out of range, {} is allowed", printable(*text), range(low, high, unit)));
    return value;
}

Result<std::int64_t> ConfigNode::integer(std::int64_t low, std::int64_t high) const {
    trace([&](ConfigTrace::Asked& asked) {
        asked.numbers.push_back({static_cast<double>(low), static_cast<double>(high), true});
    });
    std::int64_t value = 0;
    const std::string* const text = scalar();
    if (text == nullptr || !parseNumber(*text, value))
        return error(fmt::format("a whole number in {} .. {} is needed, here is {}", low, high, seen()));
    if (value < low || value > high) return error(fmt::format("{} is out of range, {} .. {} is allowed", value, low, high));
    return value;
}

Result<bool> ConfigNode::boolean() const {
    trace([](ConfigTrace::Asked& asked) { asked.isBoolean = true; });
    const std::string* const text = scalar();
    if (text != nullptr && *text == "true") return true;
    if (text != nullptr && *text == "false") return false;
    return error(fmt::format("true or false is needed, here is {}", seen()));
}

Result<std::string> ConfigNode::text() const {
    trace([](ConfigTrace::Asked& asked) { asked.isText = true; });
    const std::string* const text = scalar();
    if (text == nullptr || text->empty()) return error(fmt::format("a text is needed, here is {}", seen()));
    if (printable(*text, text->size()) != *text)  // these texts end up on terminals
        return error(fmt::format("a text on one line without control characters is needed, here is {}", seen()));
    return *text;
}

Result<std::size_t> ConfigNode::choice(std::initializer_list<std::string_view> names) const {
    return word(std::vector<std::string>(names.begin(), names.end()));
}

Result<std::size_t> ConfigNode::word(const std::vector<std::string>& words) const {
    trace([&](ConfigTrace::Asked& asked) { asked.choices = words; });
    return chosen(words);
}

Result<std::size_t> ConfigNode::choice(const std::vector<std::string>& names) const {
    trace([](ConfigTrace::Asked& asked) { asked.isText = true; });
    return chosen(names);
}

Result<std::size_t> ConfigNode::chosen(const std::vector<std::string>& names) const {
    const std::string word = scalar() != nullptr ? *scalar() : "";
    const auto found = std::find(names.begin(), names.end(), word);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    const std::string nearest = nearestName(word, names);
    return error(fmt::format("one of {} is needed, here is {}{}", names.empty() ? "nothing (none is declared)" : listed(names),
                             seen(), nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest)));
}

Result<fs::path> ConfigNode::path() const {
    const fs::path given = TRY(shortText(*this));
    if (given.is_absolute())
        return error(fmt::format("'{}' is absolute; name it relative to this file's folder, so that the whole folder can move",
                                 given.string()));
    const fs::path normal = given.lexically_normal();
    if (*normal.begin() == "..")
        return error(fmt::format("'{}' leaves this file's folder; copy the file into it", given.string()));
    return tree_->file.parent_path() / normal;
}

Result<glm::dvec2> ConfigNode::vector2(double low, double high, std::string_view unit) const {
    const auto parts = TRY(items(2, 2));
    return glm::dvec2(TRY(parts[0].number(low, high, unit)), TRY(parts[1].number(low, high, unit)));
}

Result<glm::dvec3> ConfigNode::vector3(double low, double high, std::string_view unit) const {
    const auto parts = TRY(items(3, 3));
    return glm::dvec3(TRY(parts[0].number(low, high, unit)), TRY(parts[1].number(low, high, unit)),
                      TRY(parts[2].number(low, high, unit)));
}

Result<std::vector<ConfigNode>> ConfigNode::items(std::size_t least, std::size_t most) const {
    trace([&](ConfigTrace::Asked& asked) { asked.least = least, asked.most = most; });
    if (!isList()) return error(fmt::format("a list is needed, here is {}", seen()));
    const std::vector<std::uint32_t>& parts = tree_->nodes[node_].parts;
    const std::size_t count = parts.size();
    if (count < least || count > most) {
        const std::string wanted = least == most                                     ? fmt::format("exactly {}", least)
                                   : most == std::numeric_limits<std::size_t>::max() ? fmt::format("at least {}", least)
                                                                                     : fmt::format("{} to {}", least, most);
        return error(fmt::format("a list of {} items is needed, here are {}", wanted, count));
    }
    std::vector<ConfigNode> nodes;
    nodes.reserve(count);
    for (const std::uint32_t item : parts) {
        if (ConfigTrace* const listening = ConfigTrace::of(tree_->file)) listening->name(item, node_, "[]", nodes.size());
        nodes.push_back(child(item, fmt::format("{}[{}]", key_, nodes.size())));
    }
    return nodes;
}

std::optional<ConfigNode> ConfigNode::find(std::string_view key) const {
    if (!isMap()) return std::nullopt;
    const std::vector<std::uint32_t>& parts = tree_->nodes[node_].parts;
    for (std::size_t i = 0; i < parts.size(); i += 2) {
        const ConfigTree::Node& name = tree_->nodes[parts[i]];
        if (name.kind != ConfigTree::Kind::Scalar || name.text != key) continue;
        if (ConfigTrace* const listening = ConfigTrace::of(tree_->file))
            listening->name(parts[i + 1], node_, fmt::format(".{}", key), std::string(key));
        return child(parts[i + 1], childKey(key));
    }
    return std::nullopt;
}

Result<std::vector<std::pair<std::string, ConfigNode>>> ConfigNode::entries() const {
    trace([](ConfigTrace::Asked& asked) { asked.isNamed = true; });
    if (!isMap()) return error(fmt::format("a map is needed, here is {}", seen()));
    std::vector<std::pair<std::string, ConfigNode>> result;
    std::set<std::string> names;
    const std::vector<std::uint32_t>& parts = tree_->nodes[node_].parts;
    for (std::size_t i = 0; i < parts.size(); i += 2) {
        const ConfigNode key = child(parts[i], key_);
        if (key.scalar() == nullptr) return key.error("a key must be a plain word");
        const std::string name = TRY(shortText(key));
        if (!names.insert(name).second) return key.error(fmt::format("'{}' is given twice", name));
        if (ConfigTrace* const listening = ConfigTrace::of(tree_->file)) listening->name(parts[i + 1], node_, ".*", name);
        result.emplace_back(name, child(parts[i + 1], childKey(name)));
    }
    return result;
}

ConfigFields::ConfigFields(ConfigNode node) : node_(std::move(node)) {
    if (!node_.isMap()) fail({0, 0}, node_.error(fmt::format("a map of 'key: value' lines is needed, here is {}", node_.seen())));
}

void ConfigFields::fail(std::pair<int, int> place, Error error) { failures_.emplace_back(place, std::move(error)); }

void ConfigFields::visit(std::string_view key, const std::function<Result<void>(const ConfigNode&)>& use) {
    known_.emplace_back(key);
    const bool mayBeAbsent = std::exchange(nextOptional_, false);
    node_.trace([&](ConfigTrace::Asked& asked) { asked.keys.emplace(key, !mayBeAbsent); });
    if (!node_.isMap()) return;
    const auto value = node_.find(key);
    if (!value) {
        if (!mayBeAbsent) missing_.emplace_back(key);
        return;
    }
    if (auto used = use(*value); !used) fail(value->position(), used.error());
}

void ConfigFields::check(const ConfigNode& at, const Result<void>& checked) {
    if (!checked) fail(at.position(), checked.error());
}

void ConfigFields::number(std::string_view key, double& target, double low, double high, std::string_view unit) {
    read(key, target, [&](const ConfigNode& node) { return node.number(low, high, unit); });
}

void ConfigFields::angle(std::string_view key, double& target, double lowDegrees, double highDegrees) {
    read(key, target,
         [&](const ConfigNode& node) -> Result<double> { return radians(TRY(node.number(lowDegrees, highDegrees, "degrees"))); });
}

void ConfigFields::time(std::string_view key, std::chrono::nanoseconds& target, double lowSeconds, double highSeconds) {
    read(key, target, [&](const ConfigNode& node) -> Result<std::chrono::nanoseconds> {
        return fromSeconds(TRY(node.number(lowSeconds, highSeconds, "s")));
    });
}

void ConfigFields::boolean(std::string_view key, bool& target) {
    read(key, target, [](const ConfigNode& node) { return node.boolean(); });
}

void ConfigFields::text(std::string_view key, std::string& target) { read(key, target, shortText); }

void ConfigFields::path(std::string_view key, fs::path& target) {
    read(key, target, [](const ConfigNode& node) { return node.path(); });
}

void ConfigFields::vector2(std::string_view key, glm::dvec2& target, double low, double high, std::string_view unit) {
    read(key, target, [&](const ConfigNode& node) { return node.vector2(low, high, unit); });
}

void ConfigFields::vector3(std::string_view key, glm::dvec3& target, double low, double high, std::string_view unit) {
    read(key, target, [&](const ConfigNode& node) { return node.vector3(low, high, unit); });
}

std::int64_t ConfigFields::header(std::string_view kind, std::int64_t newestVersion) {
    std::int64_t version = newestVersion;
    visit("fantascope", [&](const ConfigNode& node) -> Result<void> {
        const std::string found = TRY(node.text());
        if (found != kind) return node.error(fmt::format("this is a {} file, a {} file is needed here", found, kind));
        return {};
    });
    visit("version", [&](const ConfigNode& node) -> Result<void> {
        const std::int64_t found = TRY(node.integer(1, std::numeric_limits<std::int64_t>::max()));
        if (found > newestVersion)
            return node.error(fmt::format("version {} was written by a newer program, this one reads up to {}; update it", found,
                                          newestVersion));
        version = found;
        return {};
    });
    return version;
}

Result<void> ConfigFields::finish() {
    if (node_.isMap()) {
        std::set<std::string> seen;
        const std::vector<std::uint32_t>& parts = node_.tree_->nodes[node_.node_].parts;
        for (std::size_t i = 0; i < parts.size(); i += 2) {
            const ConfigTree::Node& keyNode = node_.tree_->nodes[parts[i]];  // its text is empty if it is no scalar
            const std::string& key = keyNode.text;
            const ConfigNode at = node_.child(parts[i], node_.childKey(key));
            const auto place = at.position();
            if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
                const std::string nearest = nearestName(key, known_);
                const std::string advice =
                    nearest.empty() ? "known here: " + listed(known_) : fmt::format("did you mean '{}'?", nearest);
                fail(place, at.error(fmt::format("unknown key ({})", advice)));
                std::erase(missing_, nearest);  // it is there, misspelt
            } else if (!seen.insert(key).second) {
                fail(place, at.error("this key is given twice"));
            }
        }
        for (const std::string& key : missing_) fail(node_.position(), node_.error(fmt::format("'{}' is missing", key)));
    }
    std::stable_sort(failures_.begin(), failures_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    ConfigFaults faults;
    for (const auto& [place, error] : failures_) faults.add(error);
    return faults.result();
}

Result<void> ConfigFaults::result() const {
    if (faults_.empty()) return {};
    std::string lines;
    for (const std::string& fault : faults_) lines += (lines.empty() ? "" : "\n") + fault;
    return Error(lines);
}

std::string nearestName(std::string_view word, const std::vector<std::string>& known) {
    const auto distance = [](std::string_view a, std::string_view b) {  // Levenshtein, one row at a time
        std::vector<std::size_t> row(b.size() + 1);
        for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
        for (std::size_t i = 0; i < a.size(); ++i) {
            std::size_t diagonal = row[0];
            row[0] = i + 1;
            for (std::size_t j = 0; j < b.size(); ++j) {
                const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
                diagonal = row[j + 1];
                row[j + 1] = std::min({substituted, row[j] + 1, diagonal + 1});
            }
        }
        return row[b.size()];
    };
    std::string nearest;
    std::size_t best = std::numeric_limits<std::size_t>::max();
    for (const std::string& name : known) {
        const std::size_t d = distance(word, name);
        if (d < best && d <= std::max<std::size_t>(1, std::max(word.size(), name.size()) / 3)) {
            best = d;
            nearest = name;
        }
    }
    return nearest;
}

std::string listed(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

std::string shortest(double value) {
    char buffer[32];
    const auto [end, failure] = std::to_chars(buffer, buffer + sizeof buffer, value);
    return {buffer, end};
}

std::string shortestDegrees(double radians) {
    constexpr int kReach = 4;  // units in the last place; the two conversions together are wrong by fewer
    // Ends in the number itself, so that the choice does not depend on where the search for it
    // began.
    const auto rank = [&](double degrees) {
        return std::tuple(std::abs(degrees * std::numbers::pi / 180 - radians), shortest(degrees).size(), degrees);
    };
    double best = radians * 180 / std::numbers::pi, candidate = best;
    for (int i = 0; i < kReach; ++i) candidate = std::nextafter(candidate, -std::numeric_limits<double>::infinity());
    for (int i = 0; i <= 2 * kReach; ++i) {
        if (rank(candidate) < rank(best)) best = candidate;
        candidate = std::nextafter(candidate, std::numeric_limits<double>::infinity());
    }
    return shortest(best);
}

std::string quoted(std::string_view text) {
    YAML::Emitter emitter;
    emitter << std::string(text);
    return emitter.c_str();
}

}  // namespace fantascope
