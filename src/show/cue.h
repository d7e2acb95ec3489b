#pragma once

#include "show/cue_list.h"

#include "core/clock.h"
#include "core/config/config.h"
#include "core/config/file_place.h"
#include "core/result.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::show {

// What the show asks of a thing of the site, which it calls by name.
template <class Wish>
struct Named {
    std::string name;
    FilePlace at;  // for an error about the name
    Wish wish;
};

// The number of a cue, in thousandths: 2500 is cue 2.5.
using CueNumber = std::int64_t;
// "2.5".
std::string textOf(CueNumber number);
// Where a cue is in its list: "3 of 7", or "2.5 (3 of 7)" where its number says something else.
std::string placeOf(CueNumber number, int cue, int cues);

// Things that move in their own time, as their author names them.
struct CuePart {
    struct Nothing {};
    using Name = Named<Nothing>;
    FilePlace at;
    std::optional<Time> wait;  // none: that of the cue
    std::optional<Fade> fade;
    std::vector<Name> outputs, fixtures, relays;  // outputs, or canvases
    std::vector<Named<SourceId>> sources;         // of `outputs`, the layers of these sources alone; without `outputs`, of all
};

// One step of the show, as its author wrote it.
struct Cue {
    std::string name;
    CueNumber number = 0;
    std::string note;      // for the operator; may be empty
    std::size_t look = 0;  // index into Show::looks
    Time wait{};           // from when it is entered until it begins to change what is seen
    Fade fade;
    std::optional<Time> follow;         // from when it is entered until another one is
    std::optional<FilePlace> mediaEnd;  // then `follow` counts from when its look is whole and all that plays in it has ended
    std::vector<int> followers;         // index into Show::cues: one of these follows, by chance; empty: the next one
    int times = 0;                      // so often in a row; then the next one. 0: always
    bool blocks = true;                 // what the look does not name is dark; else it stays
    std::vector<CuePart> parts;
    std::vector<CueList::Cue::SideCue> with;  // `list`: index into Show::sides

    // From when it is entered until its look is whole.
    Time length() const;
    // The least time from when it is entered until another one follows.
    std::optional<Time> soonestFollow() const;
};

// What the rest of the file says, as far as its cues need it.
struct CueRules {
    std::int64_t version = 1;        // of the file
    bool loops = false;              // the first cue comes after the last
    std::vector<std::string> looks;  // of the file, in its order
    std::vector<std::string> sources;
    std::vector<SourceId> ids;  // of `sources`
    struct Side {
        std::string name;
        std::vector<std::string> cues;  // empty: they are faulty
    };
    std::vector<Side> sides;  // whose cues the cues may bring with them
};

// Since this version of the show file cues may track, and may have the keys that say how they move.
constexpr std::int64_t kTrackingVersion = 2;

// Error: a file of `version` may not have the key `what`, which stands at `node`.
Result<void> needsTracking(const ConfigNode& node, std::string_view what, std::int64_t version);

// Reads an optional key that files may have since kTrackingVersion.
template <class Value, class Parse>
void readTracking(std::int64_t version, ConfigFields& fields, std::string_view key, Value& target, Parse parse) {
    fields.optional().read(key, target, [&](const ConfigNode& node) -> Result<Value> {
        TRY(needsTracking(node, key, version));
        return parse(node);
    });
}

// What comes after the last cue of a list: nothing, or the first cue again (true).
Result<bool> readAtEnd(const ConfigNode& node);

// How a list starts: with a cue, as index into `cues`, or with one of `others`, after these.
Result<std::size_t> readStart(const ConfigNode& node, const std::vector<Cue>& cues, const std::vector<std::string>& others);

// Reads the cues of a list. Error: file, line, column, key, advice, for all faults.
Result<std::vector<Cue>> readCues(const ConfigNode& node, const CueRules& rules);

}  // namespace fantascope::show
