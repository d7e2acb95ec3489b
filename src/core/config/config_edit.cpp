#include "core/config/config_edit.h"

#include "core/check.h"
#include "core/config/config.h"
#include "core/config/yaml_events.h"
#include "core/config/yaml_patch.h"
#include "core/file.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

namespace fantascope {

namespace fs = std::filesystem;

namespace {

using enum YamlEvent::Kind;

constexpr std::size_t kNone = YamlPatch::kNone;

// "outputs[1].corners"
std::string spelled(const ConfigPath& path) {
    std::string text;
    for (const ConfigStep& step : path)
        text += step.index() != nullptr ? fmt::format("[{}]", *step.index())
                                        : fmt::format("{}{}", text.empty() ? "" : ".", *step.key());
    return text;
}

// Where a path leads in a text.
struct Place {
    std::size_t steps = 0;     // that exist
    std::size_t parent = 0;    // the node before the last step
    std::size_t position = 0;  // index among the parent's entries
    YamlPatch::Entry entry;    // where the steps lead
    YamlPatch::Entry parentEntry;
    std::size_t indent = 0, parentIndent = 0;  // of the entry, of the parent
};

class Pathfinder {
public:
    Pathfinder(const YamlText& yaml, const YamlPatch& patch, const fs::path& file, const ConfigPath& path)
        : yaml_(yaml), patch_(patch), file_(file), path_(path) {}

    // Names the line of the last step that exists, and the whole path, which is what the caller
    // wanted to change.
    Error refused(const Place& place, const std::string& why) const {
        return Error(fmt::format("{}: {}: {}", yaml_.place(file_, yaml_.events[place.entry.value].begin), spelled(path_), why));
    }

    Result<Place> find() const {
        Place place;
        for (; place.steps < path_.size(); ++place.steps) {
            const std::size_t node = place.entry.value;
            const YamlEvent& event = yaml_.events[node];
            const ConfigStep& step = path_[place.steps];
            if (const auto why = whyShared(event)) return refused(place, *why);
            if (event.kind == Null) break;
            if (event.kind != (step.key() != nullptr ? Map : List))
                return refused(place, fmt::format("{} is needed, here is {}", step.key() != nullptr ? "a map" : "a list",
                                                  event.kind == Map    ? "a map"
                                                  : event.kind == List ? "a list"
                                                                       : "a single value"));
            const std::vector<YamlPatch::Entry> entries = patch_.entriesOf(node);
            std::size_t found = step.index() != nullptr ? *step.index() : entries.size();
            if (step.key() != nullptr) {
                const auto value = valueOf(yaml_, node, *step.key());
                if (!value) return refused(place, fmt::format("the key '{}' is given twice", *step.key()));
                if (*value != kNone)
                    found = std::find_if(entries.begin(), entries.end(),
                                         [&](const YamlPatch::Entry& e) { return e.value == *value; }) -
                            entries.begin();
            }
            if (found >= entries.size()) break;
            place.parent = node;
            place.parentEntry = place.entry;
            place.parentIndent = place.indent;
            place.position = found;
            place.indent = patch_.indentIn(node, place.indent);
            place.entry = entries[found];
        }
        return place;
    }

    // Refuses an anchor, alias or tag in what would change: the text then means more than the
    // value.
    Result<void> plain(const Place& place) const {
        for (std::size_t i = place.entry.value; i < yaml_.after(place.entry.value); ++i) {
            const YamlEvent& event = yaml_.events[i];
            if (event.kind == Alias)
                return refused(place, "an alias (*) stands here; put the value itself here, so that it can be changed");
            if (event.anchor != 0)
                return refused(place, "an anchor (&) stands here; remove it, so that the value can be changed");
            if (!event.tag.empty()) return refused(place, "a tag (!) stands here; remove it, so that the value can be changed");
        }
        return {};
    }

private:
    std::optional<std::string> whyShared(const YamlEvent& event) const {
        const bool meant =
            event.anchor != 0 && std::any_of(yaml_.events.begin(), yaml_.events.end(), [&](const YamlEvent& other) {
                return other.kind == Alias && other.anchor == event.anchor;
            });
        if (!meant) return std::nullopt;
        return event.kind == Alias ? "this is an alias (*) of another place, which would change too"
                                   : "an alias (*) elsewhere means this place, and would change too";
    }

    const YamlText& yaml_;
    const YamlPatch& patch_;
    const fs::path& file_;
    const ConfigPath& path_;
};

// `value` wrapped in the maps and lists that the path requires from `step` on; nothing if it
// requires an item after missing ones.
std::optional<ConfigValue> within(const ConfigPath& path, std::size_t step, ConfigValue value) {
    for (std::size_t i = path.size(); i-- > step;) {
        if (path[i].key() != nullptr)
            value = ConfigValue::Map{{*path[i].key(), std::move(value)}};
        else if (*path[i].index() == 0)
            value = ConfigValue::List{std::move(value)};
        else
            return std::nullopt;
    }
    return value;
}

// Whether `now` reads as `before`, except that the events [begin, end) are replaced by the key, if
// any, and the value, if any.
bool differsOnlyAt(const YamlText& before, std::size_t begin, std::size_t end, const YamlText& now, const std::string* key,
                   const ConfigValue* value) {
    const auto same = [](const YamlEvent& a, const YamlEvent& b) { return a.readsAs(b); };
    const std::size_t behind = before.events.size() - end;
    if (now.events.size() < begin + behind) return false;
    const std::size_t newEnd = now.events.size() - behind;
    if (!std::equal(before.events.begin(), before.events.begin() + begin, now.events.begin(), same)) return false;
    if (!std::equal(before.events.begin() + end, before.events.end(), now.events.begin() + newEnd, same)) return false;
    std::size_t at = begin;
    if (key != nullptr && (at == newEnd || now.events[at].kind != Scalar || now.events[at++].text != *key)) return false;
    if (value == nullptr) return at == newEnd;
    return at < newEnd && readsAs(now, at, *value) && now.after(at) == newEnd;
}

// The child that a step leads to; kNone: none.
std::size_t childOf(const YamlText& yaml, std::size_t node, const ConfigStep& step) {
    const YamlEvent& event = yaml.events[node];
    if (step.key() != nullptr) return event.kind == Map ? valueOf(yaml, node, *step.key()).value_or(kNone) : kNone;
    if (event.kind != List || *step.index() >= countOf(yaml, node)) return kNone;
    std::size_t item = node + 1;
    for (std::size_t i = 0; i < *step.index(); ++i) item = yaml.after(item);
    return item;
}

// Whether the path leads to equal values in both texts, through the same list items.
bool sameAt(const YamlText& a, const YamlText& b, const ConfigPath& path) {
    const auto alike = [&](std::size_t i, std::size_t j) {
        return std::equal(a.events.begin() + i, a.events.begin() + a.after(i), b.events.begin() + j,
                          b.events.begin() + b.after(j), [](const YamlEvent& x, const YamlEvent& y) { return x.readsAs(y); });
    };
    std::size_t i = 0, j = 0;
    for (const ConfigStep& step : path) {
        const std::size_t inA = childOf(a, i, step), inB = childOf(b, j, step);
        // A new item goes after the others, whoever else added some.
        if (inA == kNone || inB == kNone) return inA == inB && a.events[i].kind == b.events[j].kind;
        i = inA;
        j = inB;
        if (step.index() == nullptr) continue;
        const std::size_t nameA = childOf(a, i, "name"), nameB = childOf(b, j, "name");
        if (nameA == kNone || nameB == kNone ? !alike(i, j) : !alike(nameA, nameB)) return false;
    }
    return alike(i, j);
}

}  // namespace

Result<ConfigDocument> ConfigDocument::load(const fs::path& path) { return parse(TRY(readFile(path)), path); }

Result<ConfigDocument> ConfigDocument::parse(std::string text, const fs::path& path) {
    TRY(readYamlText(text, path));
    return ConfigDocument(path, std::move(text));
}

std::optional<std::size_t> ConfigDocument::itemNamed(const std::string& list, const std::string& name) const {
    const auto yaml = readYamlText(text_, path_);
    const std::size_t items = yaml ? childOf(*yaml, 0, list) : kNone;
    if (items == kNone) return std::nullopt;
    for (std::size_t i = 0; i < countOf(*yaml, items); ++i) {
        const std::size_t its = childOf(*yaml, childOf(*yaml, items, i), "name");
        if (its != kNone && yaml->events[its].kind == Scalar && yaml->events[its].text == name) return i;
    }
    return std::nullopt;
}

Result<void> ConfigDocument::set(const ConfigPath& path, const ConfigValue& value) { return apply({path, {value}}); }

Result<void> ConfigDocument::erase(const ConfigPath& path) { return apply({path, {}}); }

Result<void> ConfigDocument::apply(Change change) {
    std::string changed = TRY(applied(text_, change));
    if (changed == text_) return {};
    text_ = std::move(changed);
    // Of consecutive changes of one value only the last is kept.
    const bool again = !changes_.empty() && changes_.back().path == change.path;
    if (again && !changes_.back().value.empty() && !change.value.empty()) changes_.pop_back();
    changes_.push_back(std::move(change));
    return {};
}

Result<std::string> ConfigDocument::applied(const std::string& text, const Change& change) const {
    FANTASCOPE_CHECK(!change.path.empty(), "a path has a step");
    const YamlText yaml = TRY(readYamlText(text, path_));
    YamlPatch patch(yaml);
    const Pathfinder pathfinder(yaml, patch, path_, change.path);
    const Place place = TRY(pathfinder.find());
    const YamlPatch::Entry& entry = place.entry;
    const bool there = place.steps == change.path.size();

    std::size_t begin = entry.value, end = yaml.after(entry.value);  // the events that change
    std::optional<ConfigValue> value;
    const std::string* key = nullptr;
    if (change.value.empty()) {
        if (!there) return text;
        TRY(pathfinder.plain(place));
        if (entry.key != kNone) begin = entry.key;
        const std::vector<YamlPatch::Entry> siblings = patch.entriesOf(place.parent);
        if (siblings.size() > 1)
            patch.erase(place.parent, siblings, place.position, place.position + 1);
        else if (place.parent == 0)
            return pathfinder.refused(place, "the file's last key cannot be removed");
        else
            patch.replace(place.parentEntry,
                          entry.key != kNone ? ConfigValue(ConfigValue::Map{}) : ConfigValue(ConfigValue::List{}),
                          place.parentIndent);
    } else {
        const bool adds = !there && yaml.events[entry.value].kind != Null;
        value = within(change.path, place.steps + (adds ? 1 : 0), change.value.front());
        const ConfigStep* next = there ? nullptr : &change.path[place.steps];
        const bool gap = adds && next->index() != nullptr && *next->index() != countOf(yaml, entry.value);
        if (!value || gap) return pathfinder.refused(place, "the list is shorter than that");
        if (adds) {
            begin = end = yaml.events[entry.value].close;
            key = next->key();
            patch.append(entry.value, patch.entriesOf(entry.value), countOf(yaml, entry.value),
                         {{key != nullptr ? *key : "", *value}}, patch.indentIn(entry.value, place.indent));
        } else {
            if (readsAs(yaml, entry.value, *value)) return text;
            TRY(pathfinder.plain(place));
            patch.replace(entry, *value, place.indent);
        }
    }
    const std::optional<std::string> changed = patch.result();
    const auto now = readYamlText(changed.value_or(""), path_);
    if (!now || !differsOnlyAt(yaml, begin, end, *now, key, value ? &*value : nullptr))
        return pathfinder.refused(place, "the program cannot change it without changing more; change it by hand");
    return *changed;
}

Result<std::string> ConfigDocument::replayedOn(std::string theirs) const {
    std::string base = base_;
    for (const Change& change : changes_) {
        const YamlText ours = TRY(readYamlText(base, path_)), now = TRY(readYamlText(theirs, path_));
        if (!sameAt(ours, now, change.path))
            return Error(fmt::format("{}: {} was changed in the file by somebody else since it was read; read it again",
                                     path_.string(), spelled(change.path)));
        base = TRY(applied(base, change));
        theirs = TRY(applied(theirs, change));
    }
    return theirs;
}

Result<void> ConfigDocument::save() {
    if (changes_.empty()) return {};
    const std::string standing = TRY(readFile(path_));
    std::string text = standing == base_ ? text_ : TRY(replayedOn(standing));
    if (text != standing) {
        fs::path previous = path_;
        previous += ".previous";
        if (!saved_ || standing != base_) TRY(writeFile(previous, standing, path_));
        TRY(writeFile(path_, text));
        saved_ = true;
    }
    base_ = text_ = std::move(text);
    changes_.clear();
    return {};
}

}  // namespace fantascope
