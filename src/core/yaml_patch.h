#pragma once
// Which bytes of a YAML text make way for which, so that it reads differently in one place and
// keeps the rest (core/config_edit.h).

#include "core/config_value.h"
#include "core/yaml_events.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace fantascope {

// The index of the value of `key` in a map; npos if there is none; nothing if it is there more than
// once.
std::optional<std::size_t> valueOf(const YamlText& yaml, std::size_t map, const std::string& key);
// A map's entries or a list's items.
std::size_t countOf(const YamlText& yaml, std::size_t collection);
// Whether a node reads as a value.
bool readsAs(const YamlText& yaml, std::size_t node, const ConfigValue& value);

// Collects what is to be put into a text and taken out of it. Nodes are indices of the text's
// events. `yaml` outlives it.
class YamlPatch {
public:
    static constexpr std::size_t kNone = std::string::npos;

    // A map's entry or a list's item.
    struct Entry {
        std::size_t key = kNone;  // the event; none in a list
        std::size_t value = 0;
        std::size_t begin = 0;     // the byte of the key, in lists that of the dash or of the item itself
        std::size_t lead = kNone;  // behind the ':' or the dash: where a value may begin; none in brackets
    };

    explicit YamlPatch(const YamlText& yaml);
    std::vector<Entry> entriesOf(std::size_t collection) const;
    // Where lines begin that go on with what stands in a node of `indent`; a list or map of lines
    // sets it for all in it.
    std::size_t indentIn(std::size_t collection, std::size_t indent) const;
    // Makes the entry's value read as `value`: item by item and key by key, so that as much as
    // possible stays.
    void replace(const Entry& entry, const ConfigValue& value, std::size_t indent);
    // Puts new entries behind the first `kept` of a list or map (keys of a list are ""). Before:
    // some are kept, or there are none.
    void append(std::size_t collection, const std::vector<Entry>& entries, std::size_t kept, const ConfigValue::Map& added,
                std::size_t indent);
    void erase(std::size_t collection, const std::vector<Entry>& entries, std::size_t first, std::size_t last);
    // The text with all that was planned; nothing if that would meddle with itself.
    std::optional<std::string> result();

private:
    struct Edit {
        std::size_t begin, end;
        std::string text;
    };
    bool replaceItems(std::size_t list, const std::vector<Entry>& entries, const ConfigValue::List& items, std::size_t indent);
    bool replaceEntries(std::size_t map, const std::vector<Entry>& entries, const ConfigValue::Map& wanted, std::size_t indent);
    // Whole lines, each entry's own; what stands between them stays. With the line break before, so
    // that more can follow at the end.
    void eraseLines(const std::vector<Entry>& entries, std::size_t first, std::size_t last);
    // With the comma before, or where that is on another line with the one behind. Before: not all
    // of them.
    void eraseInBrackets(const std::vector<Entry>& entries, std::size_t first, std::size_t last);
    // Pieces one after the other; a line that would grow too long goes on at `indent` and two more.
    std::string laidOut(const std::vector<std::string>& pieces, std::size_t column, std::size_t indent) const;
    void put(std::size_t begin, std::size_t end, const std::string& lead, const std::vector<std::string>& pieces,
             std::size_t indent);

    const YamlText& yaml_;
    const std::string& bytes_;
    std::string lineBreak_;
    std::vector<Edit> edits_;
};

}  // namespace fantascope
