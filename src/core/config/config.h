#pragma once
// Strict YAML. Every key of every file is declared in one place with its type, unit and range;
// anything else in the file is refused with file, line, column, the key's path and advice:
//   config/courtyard.yaml:14:7: outputs[1].keystome: unknown key (did you mean 'keystone'?)
// A reader goes on after a fault, so that an error tells all faults of a file, a line for each, in
// the file's order.

#include "core/config/file_place.h"
#include "core/result.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fantascope {

struct ConfigTree;

// One node of a loaded file. Value type: cheap to copy, never changes, keeps what was read of the
// file alive. Thread: any.
class ConfigNode {
public:
    ConfigNode() = default;  // no node yet: only to be assigned to
    // The file's root, a map. Error: unreadable, not YAML, or more than one document: place and
    // reason.
    static Result<ConfigNode> load(const std::filesystem::path& path);
    // The same from text; `name` stands for the file in messages, and relative paths start from its
    // folder.
    static Result<ConfigNode> parse(const std::string& text, const std::filesystem::path& name);

    const std::filesystem::path& file() const;
    FilePlace here() const;
    std::string place() const { return here().text(); }
    Error error(const std::string& message) const { return here().error(message); }
    Error error(const Error& cause) const { return here().error(cause); }
    bool isMap() const;
    bool isList() const;

    // The node itself as a value. Errors name place, path, what stands there and what is wanted.
    Result<double> number(double low, double high, std::string_view unit = "") const;  // finite, low <= value <= high
    Result<std::int64_t> integer(std::int64_t low, std::int64_t high) const;
    Result<bool> boolean() const;                                                     // true or false
    Result<std::string> text() const;                                                 // not empty, without control characters
    Result<std::size_t> choice(std::initializer_list<std::string_view> names) const;  // the index of the name that stands here
    Result<std::size_t> choice(const std::vector<std::string>& names) const;  // names that the file itself declares
    Result<std::size_t> word(const std::vector<std::string>& words) const;    // the program's own words
    // A path relative to the file's folder, returned joined to it. Error: absolute, or it leaves
    // the folder by "..".
    Result<std::filesystem::path> path() const;
    Result<glm::dvec2> vector2(double low, double high, std::string_view unit = "") const;  // [x, y], each in the range
    Result<glm::dvec3> vector3(double low, double high, std::string_view unit = "") const;
    Result<std::vector<ConfigNode>> items(std::size_t least = 0,
                                          std::size_t most = std::numeric_limits<std::size_t>::max()) const;
    // The entries of a map whose keys are names chosen by the file's author, in the file's order; a
    // name given twice is refused.
    Result<std::vector<std::pair<std::string, ConfigNode>>> entries() const;

    // The value of a key of a map, for who must know it before all others; nothing: there is no such
    // key, or this is no map.
    std::optional<ConfigNode> find(std::string_view key) const;

    // Whether they read the same, keys and items in the same order, wherever they stand.
    friend bool operator==(const ConfigNode& a, const ConfigNode& b);

private:
    friend class ConfigFields;
    ConfigNode(std::shared_ptr<const ConfigTree> tree, std::uint32_t node, std::string key)
        : tree_(std::move(tree)), node_(node), key_(std::move(key)) {}
    ConfigNode child(std::uint32_t node, std::string key) const { return {tree_, node, std::move(key)}; }
    std::string childKey(std::string_view name) const;
    Result<std::size_t> chosen(const std::vector<std::string>& names) const;
    std::string seen() const;              // what stands here, for a message
    const std::string* scalar() const;     // null: something else stands here
    void trace(auto note) const;           // calls note(asked) if somebody listens (ConfigTrace)
    std::pair<int, int> position() const;  // line and column

    std::shared_ptr<const ConfigTree> tree_;  // null: no node yet
    std::uint32_t node_ = 0;                  // of the tree's
    std::string key_;                         // "outputs[1].warp", for messages alone
};

// What is wrong with a file so far. Readers that go on after a fault collect here.
class ConfigFaults {
public:
    void add(const Error& error) { faults_.push_back(error.message()); }
    // Gives the value to `use`, or keeps the error.
    template <class Value, class Use>
    void take(Result<Value> result, Use use) {
        if (result)
            use(std::move(result).value());
        else
            add(result.error());
    }
    bool none() const { return faults_.empty(); }
    // Error: all faults, a line for each.
    Result<void> result() const;

private:
    std::vector<std::string> faults_;
};

// Reads the fields of one map: declare each with its key, target and range, then finish(). The
// declarations are the table of known keys.
//     ConfigFields fields(node);
//     fields.number("refresh", output.refreshHz, 1, 240, "Hz");          // required
//     fields.optional().number("gamma", output.gamma, 1, 4);             // keeps the target's default when absent
//     return fields.finish();                                            // all that is wrong in the file's order, unknown keys
//     included
// A target is written only when its value is good.
class ConfigFields {
public:
    explicit ConfigFields(ConfigNode node);

    // The next declared key may be absent.
    ConfigFields& optional() {
        nextOptional_ = true;
        return *this;
    }
    void number(std::string_view key, double& target, double low, double high, std::string_view unit = "");
    void angle(std::string_view key, double& target, double lowDegrees,
               double highDegrees);  // degrees in the file, radians in the target
    void time(std::string_view key, std::chrono::nanoseconds& target, double lowSeconds, double highSeconds);
    template <class Integer>
    void integer(std::string_view key, Integer& target, std::int64_t low, std::int64_t high) {
        read(key, target,
             [&](const ConfigNode& node) -> Result<Integer> { return static_cast<Integer>(TRY(node.integer(low, high))); });
    }
    void boolean(std::string_view key, bool& target);
    void text(std::string_view key, std::string& target);
    void path(std::string_view key, std::filesystem::path& target);
    void vector2(std::string_view key, glm::dvec2& target, double low, double high, std::string_view unit = "");
    void vector3(std::string_view key, glm::dvec3& target, double low, double high, std::string_view unit = "");
    template <class Enum>
    void choice(std::string_view key, Enum& target, std::initializer_list<std::string_view> names) {
        read(key, target, [&](const ConfigNode& node) -> Result<Enum> { return static_cast<Enum>(TRY(node.choice(names))); });
    }
    // Anything else: `parse` turns the key's node into the target's value, or gives an error that
    // already names its place.
    template <class Value, class Parse>
    void read(std::string_view key, Value& target, Parse parse) {
        visit(key, [&](const ConfigNode& node) -> Result<void> {
            target = TRY(parse(node));
            return {};
        });
    }
    // A list of maps or values: `parse` turns each item's node into one element.
    template <class Element, class Parse>
    void list(std::string_view key, std::vector<Element>& target, Parse parse, std::size_t least = 0,
              std::size_t most = std::numeric_limits<std::size_t>::max()) {
        read(key, target, [&](const ConfigNode& node) -> Result<std::vector<Element>> {
            std::vector<Element> elements;
            ConfigFaults faults;
            for (const ConfigNode& item : TRY(node.items(least, most)))
                faults.take(Result<Element>(parse(item)), [&](Element element) { elements.push_back(std::move(element)); });
            TRY(faults.result());
            return elements;
        });
    }
    // The first two keys of every file: `fantascope: KIND` and `version: N`. Error: another kind of
    // file, or a version of a newer program. Returns the version; the newest if it is wrong.
    std::int64_t header(std::string_view kind, std::int64_t newestVersion);
    // What else is wrong: `checked` is told at the place of `at`.
    void check(const ConfigNode& at, const Result<void>& checked);
    // Whether nothing is wrong so far. Unknown keys show in finish() alone.
    bool right() const { return failures_.empty() && missing_.empty(); }

    Result<void> finish();

private:
    void visit(std::string_view key, const std::function<Result<void>(const ConfigNode&)>& use);
    void fail(std::pair<int, int> place, Error error);

    ConfigNode node_;
    bool nextOptional_ = false;
    std::vector<std::string> known_, missing_;
    std::vector<std::pair<std::pair<int, int>, Error>> failures_;  // by line and column
};

// The name among `known` that a person most likely meant by `word`, or "" if none is near
// (Levenshtein distance <= a third of the length).
std::string nearestName(std::string_view word, const std::vector<std::string>& known);

// "a, b, c", for messages.
std::string listed(const std::vector<std::string>& names);

// For writing YAML: the shortest decimal that reads back as the same double, the same for any
// locale.
std::string shortest(double value);
// Degrees for ConfigFields::angle: of those doubles that it reads as nearest to `radians` the
// shortest decimal. An angle that was once read comes back exactly, with the same text; of others
// one in ten or so by one unit in its last place, as no degrees stand for it.
std::string shortestDegrees(double radians);
// Quoted where YAML needs it.
std::string quoted(std::string_view text);

}  // namespace fantascope
