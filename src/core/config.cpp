#include "core/config.h"

#include "core/clock.h"
#include "core/file.h"
#include "core/geometry.h"
#include "core/text.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>
#include <tuple>

namespace fantascope {

namespace fs = std::filesystem;

struct ConfigNode::Impl {
    std::shared_ptr<const fs::path> file;
    YAML::Node node;
    std::string path;  // "outputs[1].warp"

    ConfigNode child(const YAML::Node& value, std::string childPath) const {
        return ConfigNode(std::make_shared<Impl>(Impl{file, value, std::move(childPath)}));
    }
    std::string childPath(std::string_view key) const {
        const std::string shown = printable(key);  // a path is for messages alone
        return path.empty() ? shown : fmt::format("{}.{}", path, shown);
    }
    // What stands in the file, for a message.
    std::string seen() const {
        if (node.IsScalar()) return fmt::format("'{}'", printable(node.Scalar()));
        return node.IsMap() ? "a map" : node.IsSequence() ? "a list" : "nothing";
    }
};

namespace {

// Names that a file's author chose are quoted in messages; no more than this of them.
constexpr std::size_t kLongestMessage = 2000;

// More than any name or path has.
constexpr std::size_t kLongestName = 4096;

// A name or a path. Numbers written as one text may be longer.
Result<std::string> shortText(const ConfigNode& node) {
    std::string text = TRY(node.text());
    if (text.size() <= kLongestName) return text;
    return node.error(fmt::format("'{}' is {} bytes long, {} are the most", printable(text), text.size(), kLongestName));
}

std::pair<int, int> lineAndColumn(const YAML::Mark& mark) { return {mark.line + 1, mark.column + 1}; }

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

namespace {

// Line and column, in characters, of the first byte that is not UTF-8, if there is one.
std::optional<std::pair<int, int>> placeOfNoUtf8(std::string_view text) {
    std::pair place{1, 1};
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = utf8Length(text, at);
        if (length == 0) return place;
        place = text[at] == '\n' ? std::pair(place.first + 1, 1) : std::pair(place.first, place.second + 1);
        at += length;
    }
    return std::nullopt;
}

}  // namespace

namespace {

// The line in which a document begins that is not the first: that of its '---', or its own.
int beginningOf(const YAML::Node& document, const std::string& text) {
    int line = 0, begin = 0;
    std::istringstream lines(text);
    for (std::string each; std::getline(lines, each) && line <= document.Mark().line;) {
        ++line;
        if (each.starts_with("---")) begin = line;
    }
    return std::max(begin, 1);
}

}  // namespace

Result<ConfigNode> ConfigNode::load(const fs::path& path) { return parse(TRY(readFile(path)), path); }

Result<ConfigNode> ConfigNode::parse(const std::string& text, const fs::path& name) {
    if (const auto place = placeOfNoUtf8(text))
        return Error(
            fmt::format("{}:{}:{}: not UTF-8; save the file in that encoding", name.string(), place->first, place->second));
    try {
        std::vector<YAML::Node> documents = YAML::LoadAll(text);
        if (documents.empty()) documents.emplace_back();
        auto impl = std::make_shared<Impl>(Impl{std::make_shared<const fs::path>(name), documents[0], ""});
        if (documents.size() > 1)
            return Error(fmt::format("{}:{}:1: a second document begins here; put it in a file of its own", name.string(),
                                     beginningOf(documents[1], text)));
        if (!impl->node.IsMap())
            return Error(fmt::format("{}:1:1: a map of 'key: value' lines is needed, here is {}", name.string(), impl->seen()));
        return ConfigNode(std::move(impl));
    } catch (const YAML::ParserException& problem) {
        return Error(fmt::format("{}:{}:{}: not YAML: {}", name.string(), problem.mark.line + 1, problem.mark.column + 1,
                                 printable(problem.msg)));
    }
}

const fs::path& ConfigNode::file() const { return *impl_->file; }

std::string ConfigNode::place() const {
    const auto [line, column] = lineAndColumn(impl_->node.Mark());
    return fmt::format("{}:{}:{}", impl_->file->string(), line, column);
}

Error ConfigNode::error(const std::string& message) const { return error(Error(printable(message, kLongestMessage))); }

Error ConfigNode::error(const Error& cause) const {
    return Error(fmt::format("{}: {}{}{}", place(), impl_->path, impl_->path.empty() ? "" : ": ", cause.message()));
}

bool ConfigNode::isMap() const { return impl_->node.IsMap(); }
bool ConfigNode::isList() const { return impl_->node.IsSequence(); }

Result<double> ConfigNode::number(double low, double high, std::string_view unit) const {
    double value = 0;
    if (!impl_->node.IsScalar() || !parseNumber(impl_->node.Scalar(), value) || !std::isfinite(value))
        return error(fmt::format("a number in {} is needed, here is {}", range(low, high, unit), impl_->seen()));
    if (value < low || value > high)
        return error(fmt::format("{} is out of range, {} is allowed", printable(impl_->node.Scalar()), range(low, high, unit)));
    return value;
}

Result<std::int64_t> ConfigNode::integer(std::int64_t low, std::int64_t high) const {
    std::int64_t value = 0;
    if (!impl_->node.IsScalar() || !parseNumber(impl_->node.Scalar(), value))
        return error(fmt::format("a whole number in {} .. {} is needed, here is {}", low, high, impl_->seen()));
    if (value < low || value > high) return error(fmt::format("{} is out of range, {} .. {} is allowed", value, low, high));
    return value;
}

Result<bool> ConfigNode::boolean() const {
    if (impl_->node.IsScalar() && impl_->node.Scalar() == "true") return true;
    if (impl_->node.IsScalar() && impl_->node.Scalar() == "false") return false;
    return error(fmt::format("true or false is needed, here is {}", impl_->seen()));
}

Result<std::string> ConfigNode::text() const {
    if (!impl_->node.IsScalar() || impl_->node.Scalar().empty())
        return error(fmt::format("a text is needed, here is {}", impl_->seen()));
    const std::string& text = impl_->node.Scalar();
    if (printable(text, text.size()) != text)  // these texts end up on terminals
        return error(fmt::format("a text on one line without control characters is needed, here is {}", impl_->seen()));
    return text;
}

Result<std::size_t> ConfigNode::choice(std::initializer_list<std::string_view> names) const {
    return choice(std::vector<std::string>(names.begin(), names.end()));
}

Result<std::size_t> ConfigNode::choice(const std::vector<std::string>& names) const {
    const std::string word = impl_->node.IsScalar() ? impl_->node.Scalar() : "";
    const auto found = std::find(names.begin(), names.end(), word);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    const std::string nearest = nearestName(word, names);
    return error(fmt::format("one of {} is needed, here is {}{}", names.empty() ? "nothing (none is declared)" : listed(names),
                             impl_->seen(), nearest.empty() ? "" : fmt::format(" (did you mean '{}'?)", nearest)));
}

Result<fs::path> ConfigNode::path() const {
    const fs::path given = TRY(shortText(*this));
    if (given.is_absolute())
        return error(fmt::format("'{}' is absolute; name it relative to this file's folder, so that the whole folder can move",
                                 given.string()));
    const fs::path normal = given.lexically_normal();
    if (*normal.begin() == "..")
        return error(fmt::format("'{}' leaves this file's folder; copy the file into it", given.string()));
    return impl_->file->parent_path() / normal;
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
    if (!isList()) return error(fmt::format("a list is needed, here is {}", impl_->seen()));
    const std::size_t count = impl_->node.size();
    if (count < least || count > most) {
        const std::string wanted = least == most                                     ? fmt::format("exactly {}", least)
                                   : most == std::numeric_limits<std::size_t>::max() ? fmt::format("at least {}", least)
                                                                                     : fmt::format("{} to {}", least, most);
        return error(fmt::format("a list of {} items is needed, here are {}", wanted, count));
    }
    std::vector<ConfigNode> nodes;
    nodes.reserve(count);
    for (const auto& item : impl_->node) nodes.push_back(impl_->child(item, fmt::format("{}[{}]", impl_->path, nodes.size())));
    return nodes;
}

Result<std::vector<std::pair<std::string, ConfigNode>>> ConfigNode::entries() const {
    if (!isMap()) return error(fmt::format("a map is needed, here is {}", impl_->seen()));
    std::vector<std::pair<std::string, ConfigNode>> result;
    std::set<std::string> names;
    for (const auto& entry : impl_->node) {
        const ConfigNode key = impl_->child(entry.first, impl_->path);
        if (!entry.first.IsScalar()) return key.error("a key must be a plain word");
        const std::string name = TRY(shortText(key));
        if (!names.insert(name).second) return key.error(fmt::format("'{}' is given twice", name));
        result.emplace_back(name, impl_->child(entry.second, impl_->childPath(name)));
    }
    return result;
}

ConfigFields::ConfigFields(ConfigNode node) : node_(std::move(node)) {
    if (!node_.isMap())
        fail({0, 0}, node_.error(fmt::format("a map of 'key: value' lines is needed, here is {}", node_.impl_->seen())));
}

void ConfigFields::fail(std::pair<int, int> place, Error error) { failures_.emplace_back(place, std::move(error)); }

void ConfigFields::visit(std::string_view key, const std::function<Result<void>(const ConfigNode&)>& use) {
    known_.emplace_back(key);
    const bool mayBeAbsent = std::exchange(nextOptional_, false);
    if (!node_.isMap()) return;
    const YAML::Node value = node_.impl_->node[std::string(key)];
    if (!value.IsDefined()) {
        if (!mayBeAbsent) missing_.emplace_back(key);
        return;
    }
    const ConfigNode child = node_.impl_->child(value, node_.impl_->childPath(key));
    if (auto used = use(child); !used) fail(lineAndColumn(value.Mark()), used.error());
}

void ConfigFields::check(const ConfigNode& at, const Result<void>& checked) {
    if (!checked) fail(lineAndColumn(at.impl_->node.Mark()), checked.error());
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

void ConfigFields::header(std::string_view kind, std::int64_t newestVersion) {
    visit("fantascope", [&](const ConfigNode& node) -> Result<void> {
        const std::string found = TRY(node.text());
        if (found != kind) return node.error(fmt::format("this is a {} file, a {} file is needed here", found, kind));
        return {};
    });
    visit("version", [&](const ConfigNode& node) -> Result<void> {
        const std::int64_t version = TRY(node.integer(1, std::numeric_limits<std::int64_t>::max()));
        if (version > newestVersion)
            return node.error(fmt::format("version {} was written by a newer program, this one reads up to {}; update it",
                                          version, newestVersion));
        return {};
    });
}

Result<void> ConfigFields::finish() {
    if (node_.isMap()) {
        std::set<std::string> seen;
        for (const auto& entry : node_.impl_->node) {
            const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
            const ConfigNode at = node_.impl_->child(entry.first, node_.impl_->childPath(key));
            const auto place = lineAndColumn(entry.first.Mark());
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
        for (const std::string& key : missing_)
            fail(lineAndColumn(node_.impl_->node.Mark()), node_.error(fmt::format("'{}' is missing", key)));
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
