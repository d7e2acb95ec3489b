#include "core/config/yaml_events.h"

#include "core/config/config.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>
#include <yaml.h>

#include <algorithm>
#include <map>
#include <memory>
#include <sstream>

namespace fantascope {

namespace fs = std::filesystem;

namespace {

using enum YamlEvent::Kind;

constexpr std::string_view kDisagreement = "the program does not change a file that readers of YAML do not agree on";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

bool isBlank(char c) { return c == ' ' || c == '\t'; }
bool isBreak(char c) { return c == '\n' || c == '\r'; }

// Whether YAML reads an unquoted word as null.
bool isNullWord(std::string_view word) {
    return word.empty() || word == "~" || word == "null" || word == "Null" || word == "NULL";
}

// The events by yaml-cpp, which the program uses to read its files: without places.
class YamlCppEvents : public YAML::EventHandler {
public:
    std::vector<YamlEvent> events;

    void OnDocumentStart(const YAML::Mark&) override {}
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark&, YAML::anchor_t anchor) override { add(Null, "", anchor, ""); }
    void OnAlias(const YAML::Mark&, YAML::anchor_t anchor) override { add(Alias, "", anchor, ""); }
    void OnScalar(const YAML::Mark&, const std::string& tag, YAML::anchor_t anchor, const std::string& value) override {
        add(Scalar, tag, anchor, value);
    }
    void OnSequenceStart(const YAML::Mark&, const std::string& tag, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
        add(List, tag, anchor, "");
    }
    void OnSequenceEnd() override { add(End, "", 0, ""); }
    void OnMapStart(const YAML::Mark&, const std::string& tag, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
        add(Map, tag, anchor, "");
    }
    void OnMapEnd() override { add(End, "", 0, ""); }

private:
    void add(YamlEvent::Kind kind, const std::string& tag, std::size_t anchor, const std::string& text) {
        YamlEvent& event = events.emplace_back();
        event.kind = kind;
        event.tag = tag == "?" || tag == "!" ? "" : tag;  // yaml-cpp's tags for no tag, plain and quoted
        event.anchor = anchor;
        event.text = text;
    }
};

// Reads libyaml's events. It counts places in characters, and lets block scalars and block
// collections extend to the next token.
class LibyamlReader {
public:
    LibyamlReader(YamlText& yaml, const fs::path& name) : yaml_(yaml), name_(name) {
        const std::string& bytes = yaml_.bytes;
        for (std::size_t i = bytes.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0; i < bytes.size(); ++i)
            if ((static_cast<unsigned char>(bytes[i]) & 0xC0) != 0x80) characters_.push_back(i);
        characters_.push_back(bytes.size());
    }

    Result<void> read() {
        yaml_parser_t parser;
        if (yaml_parser_initialize(&parser) == 0) return Error(name_.string() + ": no memory to read it");
        const std::unique_ptr<yaml_parser_t, decltype(&yaml_parser_delete)> parserEnds(&parser, &yaml_parser_delete);
        yaml_parser_set_input_string(&parser, reinterpret_cast<const unsigned char*>(yaml_.bytes.data()), yaml_.bytes.size());
        for (bool more = true; more;) {
            yaml_event_t event;
            if (yaml_parser_parse(&parser, &event) == 0) {
                const std::size_t where = parser.error == YAML_READER_ERROR ? std::min(parser.problem_offset, yaml_.bytes.size())
                                                                            : byteOf(parser.problem_mark);
                return Error(fmt::format("{}: {}: {}", yaml_.place(name_, where), kDisagreement,
                                         parser.problem != nullptr ? parser.problem : "unreadable"));
            }
            const std::unique_ptr<yaml_event_t, decltype(&yaml_event_delete)> eventEnds(&event, &yaml_event_delete);
            more = event.type != YAML_STREAM_END_EVENT;
            TRY(take(event));
        }
        return {};
    }

private:
    std::size_t byteOf(const yaml_mark_t& mark) const { return characters_[std::min(mark.index, characters_.size() - 1)]; }

    Result<void> take(const yaml_event_t& event) {
        const auto& data = event.data;
        switch (event.type) {
            case YAML_ALIAS_EVENT:
                add(Alias, event, nullptr, nullptr).anchor = anchors_[reinterpret_cast<const char*>(data.alias.anchor)];
                finish(yaml_.events.size() - 1);
                break;
            case YAML_SCALAR_EVENT:
                takeScalar(event);
                break;
            case YAML_SEQUENCE_START_EVENT:
                add(List, event, data.sequence_start.anchor, data.sequence_start.tag).flow =
                    data.sequence_start.style == YAML_FLOW_SEQUENCE_STYLE;
                open_.push_back(yaml_.events.size() - 1);
                break;
            case YAML_MAPPING_START_EVENT:
                add(Map, event, data.mapping_start.anchor, data.mapping_start.tag).flow =
                    data.mapping_start.style == YAML_FLOW_MAPPING_STYLE;
                open_.push_back(yaml_.events.size() - 1);
                break;
            case YAML_SEQUENCE_END_EVENT:
            case YAML_MAPPING_END_EVENT:
                takeEnd(event);
                break;
            default:
                break;
        }
        return {};
    }

    YamlEvent& add(YamlEvent::Kind kind, const yaml_event_t& event, const yaml_char_t* anchor, const yaml_char_t* tag) {
        YamlEvent& added = yaml_.events.emplace_back();
        added.kind = kind;
        added.begin = byteOf(event.start_mark);
        added.end = byteOf(event.end_mark);
        if (anchor != nullptr) added.anchor = anchors_[reinterpret_cast<const char*>(anchor)] = ++anchorCount_;
        if (tag != nullptr && std::string_view(reinterpret_cast<const char*>(tag)) != "!")
            added.tag = reinterpret_cast<const char*>(tag);
        return added;
    }

    void takeScalar(const yaml_event_t& event) {
        const auto& scalar = event.data.scalar;
        YamlEvent& added = add(Scalar, event, scalar.anchor, scalar.tag);
        added.text.assign(reinterpret_cast<const char*>(scalar.value), scalar.length);
        if (scalar.style == YAML_PLAIN_SCALAR_STYLE && scalar.tag == nullptr && isNullWord(added.text)) {
            added.kind = Null;
            added.text.clear();
        }
        added.lines = scalar.style == YAML_LITERAL_SCALAR_STYLE || scalar.style == YAML_FOLDED_SCALAR_STYLE;
        if (added.lines) added.end = blockScalarEnd(added);
        finish(yaml_.events.size() - 1);
    }

    // Without the line break after it, which the next line needs, too, and without blank lines that
    // are not part of the value.
    std::size_t blockScalarEnd(const YamlEvent& scalar) const {
        const std::string& bytes = yaml_.bytes;
        std::size_t header = std::min(bytes.find_first_of("|>", scalar.begin), scalar.end);
        bool keeps = false;
        while (++header < scalar.end && std::string_view("+-123456789").find(bytes[header]) != std::string_view::npos)
            keeps = keeps || bytes[header] == '+';
        std::size_t end = scalar.end;
        if (keeps) {
            if (end > scalar.begin && bytes[end - 1] == '\n') --end;
            if (end > scalar.begin && bytes[end - 1] == '\r') --end;
        } else {
            while (end > scalar.begin && (isBlank(bytes[end - 1]) || isBreak(bytes[end - 1]))) --end;
        }
        return end;
    }

    void takeEnd(const yaml_event_t& event) {
        YamlEvent& added = add(End, event, nullptr, nullptr);
        const std::size_t opened = open_.back();
        open_.pop_back();
        YamlEvent& collection = yaml_.events[opened];
        collection.close = yaml_.events.size() - 1;
        // A closing bracket is the end. Otherwise the end is that of the last node inside, which is
        // known by now.
        if (collection.flow && added.end > added.begin) collection.end = added.end;
        finish(opened);
    }

    void finish(std::size_t node) {
        if (open_.empty()) return;
        YamlEvent& parent = yaml_.events[open_.back()];
        parent.end = std::max(parent.end, yaml_.events[node].end);
    }

    YamlText& yaml_;
    const fs::path& name_;
    std::vector<std::size_t> characters_;  // byte offset of each character
    std::vector<std::size_t> open_;
    std::map<std::string, std::size_t> anchors_;
    std::size_t anchorCount_ = 0;
};

}  // namespace

std::size_t YamlText::lineStart(std::size_t byte) const {
    const std::size_t before = byte == 0 ? std::string::npos : bytes.rfind('\n', byte - 1);
    if (before != std::string::npos) return before + 1;
    return bytes.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
}

std::size_t YamlText::lineEnd(std::size_t byte) const {
    const std::size_t end = std::min(bytes.find('\n', byte), bytes.size());
    return end > byte && bytes[end - 1] == '\r' ? end - 1 : end;
}

std::size_t YamlText::column(std::size_t byte) const {
    const auto at = bytes.begin();
    return std::count_if(at + lineStart(byte), at + byte, [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
}

std::string YamlText::place(const fs::path& name, std::size_t byte) const {
    const auto line = 1 + std::count(bytes.begin(), bytes.begin() + lineStart(byte), '\n');
    return fmt::format("{}:{}:{}", name.string(), line, column(byte) + 1);
}

std::size_t YamlText::pastComments(std::size_t byte) const {
    while (byte < bytes.size()) {
        if (bytes[byte] == '#')
            byte = lineEnd(byte);
        else if (isBlank(bytes[byte]) || isBreak(bytes[byte]))
            ++byte;
        else
            break;
    }
    return byte;
}

Result<YamlText> readYamlText(std::string bytes, const fs::path& name) {
    if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF"))
        return Error(name.string() + ": is written in UTF-16; the program changes files in UTF-8 only");
    TRY(ConfigNode::parse(bytes, name));  // its messages are the familiar ones

    YamlText yaml;
    yaml.bytes = std::move(bytes);
    TRY(LibyamlReader(yaml, name).read());

    YamlCppEvents other;
    std::istringstream stream(yaml.bytes);
    YAML::Parser(stream).HandleNextDocument(other);
    // In folded lines the two differ in blanks and line breaks; what the program reads counts.
    for (std::size_t i = 0; i < std::min(yaml.events.size(), other.events.size()); ++i)
        if (yaml.events[i].lines && yaml.events[i].kind == other.events[i].kind) yaml.events[i].text = other.events[i].text;
    const auto [mine, theirs] = std::mismatch(yaml.events.begin(), yaml.events.end(), other.events.begin(), other.events.end(),
                                              [](const YamlEvent& a, const YamlEvent& b) { return a.readsAs(b); });
    if (mine != yaml.events.end() || theirs != other.events.end()) {
        const std::size_t where = mine != yaml.events.end() ? mine->begin : yaml.bytes.size();
        return Error(fmt::format("{}: {}: what stands here", yaml.place(name, where), kDisagreement));
    }
    return yaml;
}

}  // namespace fantascope
