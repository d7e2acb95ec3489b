#pragma once
// Changes values in a YAML file that a person wrote, and leaves every other byte of it as it was:
// comments, order, spacing, quotes, line ends.
//     ConfigDocument site = TRY(ConfigDocument::load("site.yaml"));
//     TRY(site.set({"outputs", 1, "corners"}, corners));
//     TRY(site.save());
// docs/decisions/0019-files-are-changed-in-place.md says how.

#include "core/config_value.h"
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

// One step from a node to one in it: a map's key or a list's index.
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

// A file's text and what was changed in it since it was loaded or saved. Thread: thread-bound.
class ConfigDocument {
public:
    // Error: unreadable, not YAML, its root is no map, or it cannot safely be changed: see
    // readYamlText.
    static Result<ConfigDocument> load(const std::filesystem::path& path);
    // The same from a text that is taken for that of the file `path`.
    static Result<ConfigDocument> parse(std::string text, const std::filesystem::path& path);

    // Makes the value at `path` (at least one step) read as `value`. What already does keeps its
    // bytes: a number that is equal, the items of a list that are the same. What is new comes at
    // the end of its list or map in that one's style; maps that are missing on the way are made,
    // and a list's index may be its size. A comment goes only with an item on whose lines it
    // stands, or out of a list or map in whose place something else comes. Takes milliseconds, as
    // the whole text is read anew, twice: nothing for a frame's thread. Error, the text is as
    // before: the path leads through something else; a key stands twice; an anchor, alias or tag is
    // at the value, or an anchor that aliases mean on the way to it, as more than one place would
    // change; or the new text would not read as the old one but for the value, by either of two
    // parsers. Every change is checked so.
    Result<void> set(const ConfigPath& path, const ConfigValue& value);
    // Takes a map's entry or a list's item away, with the comment on its lines. Nothing happens if
    // there is none. Error: as set; or it is the file's last key.
    Result<void> erase(const ConfigPath& path);

    const std::string& text() const { return text_; }
    // The place of the item of the root's list `list` whose `name` is this; nothing: there is none.
    std::optional<std::size_t> itemNamed(const std::string& list, const std::string& name) const;

    // Writes the file if anything was changed: see writeFile. A person's version is kept beside it,
    // as FILE.previous: that which stood there before the first save, and again before a save that
    // finds the file changed by somebody else since.
    // Of such a file everything is kept: the changes are made anew in the text that stands there
    // now. Error, nothing is written and the changes are kept: the file or its previous version
    // cannot be read or written; or somebody changed the same value, or its item of a list (told by
    // its `name`, if it has one) is no longer where it was.
    // Between the last look at the file and the renaming is a moment in which somebody else's save
    // is lost.
    Result<void> save();

private:
    struct Change {
        ConfigPath path;
        std::vector<ConfigValue> value;  // one, or none: erase
    };

    ConfigDocument(std::filesystem::path path, std::string text) : path_(std::move(path)), base_(text), text_(std::move(text)) {}
    Result<std::string> applied(const std::string& text, const Change& change) const;
    Result<void> apply(Change change);
    Result<std::string> replayedOn(std::string theirs) const;

    std::filesystem::path path_;
    std::string base_;  // as loaded or last saved
    std::string text_;
    std::vector<Change> changes_;  // that make text_ of base_
    bool saved_ = false;           // base_ is ours, no person's
};

}  // namespace fantascope
