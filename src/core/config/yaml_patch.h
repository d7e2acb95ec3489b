#pragma once
// Plans the edits of a YAML text that change one value and keep the rest (core/config_edit.h).

#include "core/config/config_value.h"
#include "core/config/yaml_events.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fantascope {

// The index of the value of `key` in a map; npos if there is none; nothing if it occurs more than
// once.
std::optional<std::size_t> valueOf(const YamlText& yaml, std::size_t map, const std::string& key);
// The number of a map's entries or a list's items.
std::size_t countOf(const YamlText& yaml, std::size_t collection);
// Whether a node reads as a value.
bool readsAs(const YamlText& yaml, std::size_t node, const ConfigValue& value);

// Collects insertions and deletions. Nodes are indices of the text's events. `yaml` outlives the
// patch.
class YamlPatch {
public:
    static constexpr std::size_t kNone = std::string::npos;

    // A map's entry or a list's item.
    struct Entry {
        std::size_t key = kNone;  // event index; none in a list
        std::size_t value = 0;
        std::size_t begin = 0;     // byte of the key; in lists, of the dash or the item itself
        std::size_t lead = kNone;  // byte after the ':' or the dash, where a value may begin; none in brackets
    };

    explicit YamlPatch(const YamlText& yaml);
    std::vector<Entry> entriesOf(std::size_t collection) const;
    // The indentation of lines inside a node of `indent`; a list or map in lines sets it for its
    // contents.
    std::size_t indentIn(std::size_t collection, std::size_t indent) const;
    // Makes the entry's value read as `value`, item by item and key by key, to keep as much as
    // possible.
    void replace(const Entry& entry, const ConfigValue& value, std::size_t indent);
    // Adds new entries after the first `kept` of a list or map (keys of a list are ""). Requires
    // that some are kept, or that there are none.
    void append(std::size_t collection, const std::vector<Entry>& entries, std::size_t kept, const ConfigValue::Map& added,
                std::size_t indent);
    void erase(std::size_t collection, const std::vector<Entry>& entries, std::size_t first, std::size_t last);
    // The text with all planned edits; nothing if they overlap.
    std::optional<std::string> result();

private:
    struct Edit {
        std::size_t begin, end;
        std::string text;
    };
    bool replaceItems(std::size_t list, const std::vector<Entry>& entries, const ConfigValue::List& items, std::size_t indent);
    bool replaceEntries(std::size_t map, const std::vector<Entry>& entries, const ConfigValue::Map& wanted, std::size_t indent);
    // Erases each entry's whole lines; what is between them stays. Includes the line break before,
    // so that more can follow at the end.
    void eraseLines(const std::vector<Entry>& entries, std::size_t first, std::size_t last);
    // Includes the comma before, or the one after if the former is on another line. Requires that
    // some entries stay.
    void eraseInBrackets(const std::vector<Entry>& entries, std::size_t first, std::size_t last);
    // Joins pieces; a line that would be too long continues at `indent` plus two.
    std::string laidOut(const std::vector<std::string>& pieces, std::size_t column, std::size_t indent) const;
    void put(std::size_t begin, std::size_t end, const std::string& lead, const std::vector<std::string>& pieces,
             std::size_t indent);

    const YamlText& yaml_;
    const std::string& bytes_;
    std::string lineBreak_;
    std::vector<Edit> edits_;
};

}  // namespace fantascope
