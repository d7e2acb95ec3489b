#pragma once
// Changes values in a hand-written YAML file and keeps every other byte: comments, order, spacing,
// quotes, line ends.
//     ConfigDocument site = TRY(ConfigDocument::load("site.yaml"));
//     TRY(site.set({"outputs", 1, "corners"}, corners));
//     TRY(site.save());
// See docs/decisions/0019-files-are-changed-in-place.md.

#include "core/config/config_value.h"
#include "core/result.h"

#include <concepts>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace fantascope {

// A step from a node to a child: a map's key or a list's index.
class ConfigStep {
public:
    ConfigStep(std::string key) : held_(std::move(key)) {}
    ConfigStep(const char* key) : held_(std::string(key)) {}
    template <std::integral Index>
    ConfigStep(Index index) : held_(static_cast<std::size_t>(index)) {}

    const std::string* key() const { return std::get_if<std::string>(&held_); }
    const std::size_t* index() const { return std::get_if<std::size_t>(&held_); }
    bool operator==(const ConfigStep&) const = default;

private:
    std::variant<std::string, std::size_t> held_;
};
using ConfigPath = std::vector<ConfigStep>;

// A file's text and its changes since it was loaded or saved. Thread: thread-bound.
class ConfigDocument {
public:
    // Error: unreadable, not YAML, its root is no map, or it cannot be changed safely: see
    // readYamlText.
    static Result<ConfigDocument> load(const std::filesystem::path& path);
    // The same from a text that stands for the file `path`.
    static Result<ConfigDocument> parse(std::string text, const std::filesystem::path& path);

    // Sets the value at `path` (at least one step). Parts that already read as wanted keep their
    // bytes: an equal number, unchanged items of a list. New parts are added at the end of their
    // list or map, in its style; missing maps on the path are made, and a list's index may be its
    // size. A comment is lost only with the lines of its item, or inside a list or map that is
    // replaced.
    // Takes milliseconds, because the whole text is parsed again, twice: not for a frame's thread.
    // Error; the text is then unchanged: the path does not fit; a key is given twice; an anchor,
    // alias or tag is at the value, or an aliased anchor is on the path, so more than one place
    // would change; or, by either of two parsers, the new text would differ in more than the value.
    // Every change is checked for that.
    Result<void> set(const ConfigPath& path, const ConfigValue& value);
    // Removes a map's entry or a list's item, with the comment on its lines. Does nothing if there
    // is none. Error: as set(); or it is the file's last key.
    Result<void> erase(const ConfigPath& path);

    const std::string& text() const { return text_; }
    // The index of the item whose `name` is this, in the root's list `list`; nothing if there is
    // none.
    std::optional<std::size_t> itemNamed(const std::string& list, const std::string& name) const;

    // Writes the file if anything changed: see writeFile. A person's version is kept beside it as
    // FILE.previous: the one before the first save, and again the one before a save that finds the
    // file changed by somebody else.
    // Such foreign changes are kept: our changes are applied again to the text that is there now.
    // Error; nothing is written and our changes are kept: the file or its previous version cannot
    // be read or written; or somebody changed the same value, or moved its list item (identified by
    // its `name`, if it has one).
    // A save by somebody else between our last read and the rename is lost.
    Result<void> save();

private:
    struct Change {
        ConfigPath path;
        std::vector<ConfigValue> value;  // one; none: erase
    };

    ConfigDocument(std::filesystem::path path, std::string text) : path_(std::move(path)), base_(text), text_(std::move(text)) {}
    Result<std::string> applied(const std::string& text, const Change& change) const;
    Result<void> apply(Change change);
    Result<std::string> replayedOn(std::string theirs) const;

    std::filesystem::path path_;
    std::string base_;  // as loaded or last saved
    std::string text_;
    std::vector<Change> changes_;  // from base_ to text_
    bool saved_ = false;           // base_ was written by us, not by a person
};

}  // namespace fantascope
