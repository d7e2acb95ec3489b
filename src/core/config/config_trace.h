#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace fantascope {

// What the readers of a file ask of it, wherever it may stand: the keys that they know, and what
// they take as values. A schema of the file is made from it.
//
// It listens while it lives, to the reads of one file on the thread that made it. One at a time.
class ConfigTrace {
public:
    // A step from a node to one below it: a key, or the index of an item.
    using Step = std::variant<std::string, std::size_t>;
    struct Number {
        double low, high;
        bool isWhole;
        friend auto operator<=>(const Number&, const Number&) = default;
    };
    // What a node was asked for. It may be asked for several things, one of which it must be.
    struct Asked {
        std::vector<Number> numbers{};
        std::vector<std::string> choices{};  // one of these words
        bool isText = false;                 // any text, or a name that the file itself declares
        bool isBoolean = false;
        std::optional<std::size_t> least{}, most{};  // a list of so many items; nothing: no list
        bool isNamed = false;                        // a map whose keys the file's author chooses
        std::map<std::string, bool> keys{};          // a map with these keys; true: it must have it
        std::vector<Step> way{};                     // where the node was, from the root
    };

    explicit ConfigTrace(std::filesystem::path file);
    ~ConfigTrace();
    ConfigTrace(const ConfigTrace&) = delete;
    ConfigTrace& operator=(const ConfigTrace&) = delete;

    // By place: "sources.*.video.from", where * is a name and [] an item: "cues[].follow". The root
    // is "".
    const std::map<std::string, Asked>& places() const { return places_; }

    // For the readers. Null: nobody listens to reads of `file`.
    static ConfigTrace* of(const std::filesystem::path& file);
    Asked* at(std::uint32_t node);  // null: the node has no place, as a key
    void name(std::uint32_t node, std::uint32_t parent, std::string_view place, Step step);

private:
    const std::filesystem::path file_;
    struct Node {
        std::string place;
        std::vector<Step> way;
    };
    std::map<std::uint32_t, Node> nodes_{{0, {}}};
    std::map<std::string, Asked> places_;
};

}  // namespace fantascope
