#include "core/config/yaml_patch.h"

#include "core/config/config.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <set>

namespace fantascope {

using enum YamlEvent::Kind;

namespace {

constexpr std::size_t kNone = YamlPatch::kNone;
constexpr std::size_t kWidth = 130;  // characters; longer lines are broken

// Quoted for any place, also inside brackets.
std::string written(const std::string& text) {
    YAML::Emitter emitter;
    emitter << YAML::Flow << YAML::BeginSeq << text << YAML::EndSeq;
    return std::string(emitter.c_str() + 1, emitter.size() - 2);
}

// Splits a value into pieces between which a line may break. A short list or map of numbers and
// texts is one piece.
std::vector<std::string> pieces(const ConfigValue& value) {
    if (const double* number = value.number()) return {shortest(*number)};
    if (const std::string* text = value.text()) return {written(*text)};

    std::vector<std::string> all;
    bool simple = true;
    const auto add = [&](const std::string& lead, const ConfigValue& part) {
        std::vector<std::string> some = pieces(part);
        some.front().insert(0, lead);
        if (!all.empty()) all.back() += ',';
        all.insert(all.end(), some.begin(), some.end());
        simple = simple && (part.number() != nullptr || part.text() != nullptr);
    };
    if (value.list() != nullptr)
        for (const ConfigValue& item : *value.list()) add("", item);
    else
        for (const auto& [key, part] : *value.map()) add(written(key) + ": ", part);
    if (all.empty()) all.emplace_back();
    all.front().insert(0, value.list() != nullptr ? "[" : "{");
    all.back() += value.list() != nullptr ? "]" : "}";
    if (std::string line = fmt::format("{}", fmt::join(all, " ")); simple && line.size() < kWidth / 2) return {std::move(line)};
    return all;
}

}  // namespace

std::optional<std::size_t> valueOf(const YamlText& yaml, std::size_t map, const std::string& key) {
    std::size_t found = kNone;
    for (std::size_t node = map + 1; node < yaml.events[map].close;) {
        const std::size_t value = yaml.after(node);
        if (yaml.events[node].kind == Scalar && yaml.events[node].text == key) {
            if (found != kNone) return std::nullopt;
            found = value;
        }
        node = yaml.after(value);
    }
    return found;
}

std::size_t countOf(const YamlText& yaml, std::size_t collection) {
    std::size_t nodes = 0;
    for (std::size_t node = collection + 1; node < yaml.events[collection].close; node = yaml.after(node)) ++nodes;
    return yaml.events[collection].kind == Map ? nodes / 2 : nodes;
}

bool readsAs(const YamlText& yaml, std::size_t node, const ConfigValue& value) {
    const YamlEvent& event = yaml.events[node];
    if (const double* number = value.number()) {
        double read = 0;
        const char* end = event.text.data() + event.text.size();
        const auto [stop, failure] = std::from_chars(event.text.data(), end, read);
        return event.kind == Scalar && failure == std::errc() && stop == end && read == *number;
    }
    if (const std::string* text = value.text()) return event.kind == Scalar && event.text == *text;
    if (const auto* list = value.list()) {
        if (event.kind != List || countOf(yaml, node) != list->size()) return false;
        std::size_t item = node + 1;
        return std::all_of(list->begin(), list->end(), [&](const ConfigValue& wanted) {
            const bool same = readsAs(yaml, item, wanted);
            item = yaml.after(item);
            return same;
        });
    }
    if (event.kind != Map || countOf(yaml, node) != value.map()->size()) return false;
    return std::all_of(value.map()->begin(), value.map()->end(), [&](const auto& entry) {
        const auto found = valueOf(yaml, node, entry.first);
        return found && *found != kNone && readsAs(yaml, *found, entry.second);
    });
}

YamlPatch::YamlPatch(const YamlText& yaml) : yaml_(yaml), bytes_(yaml.bytes) {
    lineBreak_ = bytes_.find("\r\n") != std::string::npos && bytes_.find("\r\n") < bytes_.find('\n') ? "\r\n" : "\n";
}

std::vector<YamlPatch::Entry> YamlPatch::entriesOf(std::size_t collection) const {
    const YamlEvent& event = yaml_.events[collection];
    std::vector<Entry> entries;
    std::size_t gap = event.begin;  // what is between items
    for (std::size_t node = collection + 1; node < event.close;) {
        Entry entry;
        if (event.kind == Map) {
            entry.key = node;
            node = yaml_.after(node);
        }
        entry.value = node;
        entry.begin = yaml_.events[event.kind == Map ? entry.key : node].begin;
        if (!event.flow) {
            if (event.kind == Map) {
                gap = yaml_.events[entry.key].end;
            } else if (gap == event.begin) {
                while (gap < bytes_.size() && (bytes_[gap] == '&' || bytes_[gap] == '!'))  // the list's own anchor and tag
                    gap = yaml_.pastComments(std::min(bytes_.find_first_of(" \t\r\n", gap), bytes_.size()));
            }
            const std::size_t mark = yaml_.pastComments(gap);
            if (mark < bytes_.size() && bytes_[mark] == (event.kind == Map ? ':' : '-')) {
                entry.lead = mark + 1;
                if (event.kind == List) entry.begin = mark;
            }
        }
        entries.push_back(entry);
        gap = yaml_.events[node].end;
        node = yaml_.after(node);
    }
    return entries;
}

std::size_t YamlPatch::indentIn(std::size_t collection, std::size_t indent) const {
    return yaml_.events[collection].flow ? indent : yaml_.column(entriesOf(collection).front().begin);
}

void YamlPatch::replace(const Entry& entry, const ConfigValue& value, std::size_t indent) {
    if (readsAs(yaml_, entry.value, value)) return;
    const YamlEvent& old = yaml_.events[entry.value];
    const bool lists = old.kind == List && value.list() != nullptr && !value.list()->empty();
    const bool maps = old.kind == Map && value.map() != nullptr && !value.map()->empty();
    if (lists || maps) {
        const std::vector<Entry> entries = entriesOf(entry.value);
        if (lists ? replaceItems(entry.value, entries, *value.list(), indent)
                  : replaceEntries(entry.value, entries, *value.map(), indent))
            return;
    }
    const std::size_t lineOfOld = yaml_.lineStart(old.begin);
    if ((old.kind == List || old.kind == Map) && !old.flow && entry.lead != kNone && entry.lead < lineOfOld) {
        put(entry.lead, entry.lead, " ", pieces(value), indent);
        const std::vector<Entry> entries = entriesOf(entry.value);
        eraseLines(entries, 0, entries.size());
    } else {
        const bool leans = old.begin > 0 && (bytes_[old.begin - 1] == ':' || old.begin == entry.lead);
        put(old.begin, old.end, leans ? " " : "", pieces(value), indent);
    }
}

void YamlPatch::append(std::size_t collection, const std::vector<Entry>& entries, std::size_t kept, const ConfigValue::Map& added,
                       std::size_t indent) {
    const YamlEvent& event = yaml_.events[collection];
    const bool map = event.kind == Map;
    const std::size_t last = entries.empty() ? 0 : yaml_.events[entries[kept - 1].value].end;
    if (event.flow) {
        std::vector<std::string> all;
        if (!entries.empty()) all.emplace_back();  // becomes the comma after the existing items
        for (const auto& [key, value] : added) {
            if (!all.empty()) all.back() += ',';
            std::vector<std::string> some = pieces(value);
            if (map) some.front().insert(0, written(key) + ": ");
            all.insert(all.end(), some.begin(), some.end());
        }
        const std::size_t at = entries.empty() ? yaml_.events[event.close].begin : last;
        put(at, at, "", all, indent);
        return;
    }
    const std::size_t column = yaml_.column(entries.front().begin), at = yaml_.lineEnd(last);
    for (const auto& [key, value] : added) {
        const std::string lead = std::string(column, ' ') + (map ? written(key) + ": " : "- ");
        edits_.push_back({at, at, lineBreak_ + lead + laidOut(pieces(value), lead.size(), column)});
    }
}

void YamlPatch::erase(std::size_t collection, const std::vector<Entry>& entries, std::size_t first, std::size_t last) {
    if (yaml_.events[collection].flow)
        eraseInBrackets(entries, first, last);
    else
        eraseLines(entries, first, last);
}

std::optional<std::string> YamlPatch::result() {
    // Applied from the end, so that places stay valid. An insertion at the place of a deletion
    // comes after it.
    std::stable_sort(edits_.begin(), edits_.end(),
                     [](const Edit& a, const Edit& b) { return a.begin != b.begin ? a.begin > b.begin : a.end > b.end; });
    std::string text = bytes_;
    std::size_t untouched = text.size();
    for (std::size_t i = 0; i < edits_.size(); ++i) {
        std::size_t alike = i;  // several insertions at one place keep their planned order
        while (alike + 1 < edits_.size() && edits_[alike + 1].begin == edits_[i].begin && edits_[alike + 1].end == edits_[i].end)
            ++alike;
        std::string together;
        for (std::size_t j = i; j <= alike; ++j) together += edits_[j].text;
        if (edits_[i].end > untouched) return std::nullopt;
        text.replace(edits_[i].begin, edits_[i].end - edits_[i].begin, together);
        untouched = edits_[i].begin;
        i = alike;
    }
    return text;
}

bool YamlPatch::replaceItems(std::size_t list, const std::vector<Entry>& entries, const ConfigValue::List& items,
                             std::size_t indent) {
    if (entries.empty()) return false;
    const std::size_t inner = indentIn(list, indent), both = std::min(entries.size(), items.size());
    for (std::size_t i = 0; i < both; ++i) replace(entries[i], items[i], inner);
    if (both < entries.size()) erase(list, entries, both, entries.size());
    ConfigValue::Map added;
    for (std::size_t i = both; i < items.size(); ++i) added.emplace_back("", items[i]);
    if (!added.empty()) append(list, entries, both, added, inner);
    return true;
}

bool YamlPatch::replaceEntries(std::size_t map, const std::vector<Entry>& entries, const ConfigValue::Map& wanted,
                               std::size_t indent) {
    std::set<std::string> known;
    std::size_t lastKept = kNone;
    const auto wantedFor = [&](const Entry& entry) {
        return std::find_if(wanted.begin(), wanted.end(), [&](const auto& pair) {
            return yaml_.events[entry.key].kind == Scalar && pair.first == yaml_.events[entry.key].text;
        });
    };
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const auto found = wantedFor(entries[i]);
        if (found == wanted.end()) continue;
        if (!known.insert(found->first).second) return false;
        lastKept = i;
    }
    if (lastKept == kNone) return false;

    const std::size_t inner = indentIn(map, indent);
    for (std::size_t i = 0; i < entries.size();) {
        std::size_t end = i;
        while (end < entries.size() && wantedFor(entries[end]) == wanted.end()) ++end;
        if (end > i)
            erase(map, entries, i, end);
        else
            replace(entries[end++], wantedFor(entries[i])->second, inner);
        i = end;
    }
    ConfigValue::Map added;
    std::copy_if(wanted.begin(), wanted.end(), std::back_inserter(added),
                 [&](const auto& pair) { return !known.contains(pair.first); });
    if (!added.empty()) append(map, entries, lastKept + 1, added, inner);
    return true;
}

void YamlPatch::eraseLines(const std::vector<Entry>& entries, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
        const std::size_t line = yaml_.lineStart(entries[i].begin);
        std::size_t begin = entries[i].begin, end = yaml_.lineEnd(yaml_.events[entries[i].value].end);
        while (begin > line && (bytes_[begin - 1] == ' ' || bytes_[begin - 1] == '\t')) --begin;
        if (begin == line && line > 0 && bytes_[line - 1] == '\n')
            begin = yaml_.lineEnd(yaml_.lineStart(line - 1));
        else if (begin == line)
            end = std::min(bytes_.find('\n', end), bytes_.size() - 1) + 1;
        edits_.push_back({begin, end, ""});
    }
}

void YamlPatch::eraseInBrackets(const std::vector<Entry>& entries, std::size_t first, std::size_t last) {
    const std::size_t begin = entries[first].begin, end = yaml_.events[entries[last - 1].value].end;
    const std::size_t before = first > 0 ? yaml_.events[entries[first - 1].value].end : kNone;
    if (before != kNone && yaml_.lineEnd(before) >= begin) {
        edits_.push_back({before, end, ""});
        return;
    }
    const std::size_t comma = yaml_.pastComments(end);
    edits_.push_back({begin, end, ""});
    if (comma >= bytes_.size() || bytes_[comma] != ',') return;
    std::size_t next = comma + 1;
    while (next < bytes_.size() && bytes_[next] == ' ') ++next;
    edits_.push_back({comma, next, ""});
}

std::string YamlPatch::laidOut(const std::vector<std::string>& pieces, std::size_t column, std::size_t indent) const {
    std::string text;
    for (const std::string& piece : pieces) {
        if (!text.empty() && column + 1 + piece.size() > kWidth) {
            text += lineBreak_ + std::string(indent + 2, ' ');
            column = indent + 2;
        } else if (!text.empty()) {
            text += ' ';
            ++column;
        }
        text += piece;
        column += piece.size();
    }
    return text;
}

void YamlPatch::put(std::size_t begin, std::size_t end, const std::string& lead, const std::vector<std::string>& pieces,
                    std::size_t indent) {
    edits_.push_back({begin, end, lead + laidOut(pieces, yaml_.column(begin) + lead.size(), indent)});
}

}  // namespace fantascope
