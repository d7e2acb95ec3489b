#pragma once
// A YAML text as a row of events with the bytes that each stands in, for whoever changes the text
// in place (core/config_edit.h).

#include "core/result.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace fantascope {

// Begin of a node, or the end of a list or map. In a map a key's node and its value's follow each
// other.
struct YamlEvent {
    enum class Kind { Scalar, Null, Alias, List, Map, End };
    Kind kind = Kind::Null;
    std::string text;        // of a scalar, without quotes and escapes
    std::string tag;         // written out, "" if there is none
    std::size_t anchor = 0;  // anchors are counted from 1 as they come; an alias has the one that it means; 0: none

    // Where the node stands; bytes of the text. What only leads to it ("key:", "- ") and what
    // follows it on its line are not its own.
    std::size_t begin = 0, end = 0;
    bool flow = false;      // in brackets, as against lines of "- item" and "key: value"
    bool lines = false;     // of a scalar: the lines below a '|' or '>'
    std::size_t close = 0;  // of a list or map: the index of its End, which begins with the closing bracket, if there is one

    // What is read, wherever and however it is written.
    bool readsAs(const YamlEvent& other) const {
        return kind == other.kind && text == other.text && tag == other.tag && anchor == other.anchor;
    }
};

struct YamlText {
    std::string bytes;
    std::vector<YamlEvent> events;  // the first is the root, a map

    // The index after a node and all that is in it.
    std::size_t after(std::size_t node) const {
        using enum YamlEvent::Kind;
        const YamlEvent& event = events[node];
        return event.kind == List || event.kind == Map ? event.close + 1 : node + 1;
    }
    std::size_t lineStart(std::size_t byte) const;  // a byte order mark is not of the line
    std::size_t lineEnd(std::size_t byte) const;    // before its line break, which may be "\r\n"
    std::size_t column(std::size_t byte) const;     // in characters, from 0
    // "name:line:column".
    std::string place(const std::filesystem::path& name, std::size_t byte) const;
    // The first byte from `byte` on that is neither blank, nor line break, nor in a comment. `byte`
    // is in none of them halfway.
    std::size_t pastComments(std::size_t byte) const;
};

// `name` stands for the file in messages. Error: not YAML, its root is no map, or it is one that
// cannot safely be changed in place: several documents, UTF-16, or a text that libyaml and yaml-cpp
// understand differently.
Result<YamlText> readYamlText(std::string bytes, const std::filesystem::path& name);

}  // namespace fantascope
