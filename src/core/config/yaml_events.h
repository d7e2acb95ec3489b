#pragma once
// A YAML text as a sequence of events with their byte ranges, for changing the text in place
// (core/config_edit.h).

#include "core/result.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace fantascope {

// The beginning of a node, or the end of a list or map. In a map, each key's node is followed by
// its value's.
struct YamlEvent {
    enum class Kind { Scalar, Null, Alias, List, Map, End };
    Kind kind = Kind::Null;
    std::string text;        // of a scalar, without quotes and escapes
    std::string tag;         // in full; "" if there is none
    std::size_t anchor = 0;  // anchors are numbered from 1 in their order; an alias has the number of its anchor; 0: none

    // The node's byte range, without what leads to it ("key:", "- ") and what follows it on its
    // line.
    std::size_t begin = 0, end = 0;
    bool flow = false;      // in brackets, not in lines of "- item" and "key: value"
    bool lines = false;     // a scalar in lines below a '|' or '>'
    std::size_t close = 0;  // of a list or map: the index of its End, which begins at the closing bracket, if there is one

    // Whether both read the same, wherever and however they are written.
    bool readsAs(const YamlEvent& other) const {
        return kind == other.kind && text == other.text && tag == other.tag && anchor == other.anchor;
    }
};

struct YamlText {
    std::string bytes;
    std::vector<YamlEvent> events;  // the first is the root, a map

    // The index after a node and its descendants.
    std::size_t after(std::size_t node) const {
        using enum YamlEvent::Kind;
        const YamlEvent& event = events[node];
        return event.kind == List || event.kind == Map ? event.close + 1 : node + 1;
    }
    std::size_t lineStart(std::size_t byte) const;  // after a byte order mark
    std::size_t lineEnd(std::size_t byte) const;    // before its line break, which may be "\r\n"
    std::size_t column(std::size_t byte) const;     // in characters, from 0
    // "name:line:column".
    std::string place(const std::filesystem::path& name, std::size_t byte) const;
    // The first byte from `byte` on that is not blank, line break or comment. `byte` is not in the
    // middle of one of them.
    std::size_t pastComments(std::size_t byte) const;
};

// `name` stands for the file in messages. Error: not YAML, its root is no map, or it cannot be
// changed safely in place: several documents, UTF-16, or a text that libyaml and yaml-cpp read
// differently.
Result<YamlText> readYamlText(std::string bytes, const std::filesystem::path& name);

}  // namespace fantascope
