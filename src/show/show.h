#pragma once

#include "show/course/wind.h"
#include "show/cue.h"
#include "show/cue_list.h"
#include "show/schedule/schedule.h"
#include "show/show_state.h"
#include "show/side_list.h"
#include "show/site/site.h"
#include "show/source.h"

#include "core/clock.h"
#include "core/result.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace fantascope::show {

// A look as its author wrote it. What it does not name is dark in a cue that blocks: outputs are
// black, fixtures are at level 0, and relays are in their safe states. In another cue it stays as
// it was in the cue before.
struct NamedLook {
    using ChannelLevels = std::vector<Named<float>>;
    using Levels = std::variant<float, ChannelLevels>;  // one level for all channels of a fixture, or levels by channel
    std::string name;
    struct OutputWish {
        OutputState layers;
        std::optional<WindWish> wind;  // none: that of the look
    };
    std::vector<Named<OutputWish>> outputs;
    std::optional<WindWish> wind;  // of all outputs
    std::vector<Named<Levels>> fixtures;
    std::vector<Named<bool>> relays;  // true: on
    struct Play {
        SourceId source;
        std::optional<float> speed;  // none: as before
        bool restarts = false;       // it begins again
    };
    std::vector<Play> plays;
};

// show.yaml as its author wrote it; docs/show-format.md describes the file. Value type.
struct Show {
    std::filesystem::path file;
    std::string title;
    Time goInterval{};
    Time blackoutFade{};
    Time panicFade{};
    std::uint64_t seed = 1;  // of the show's own randomness
    std::vector<Source> sources;
    std::vector<NamedLook> looks;
    std::vector<Cue> cues;
    std::optional<std::size_t> start;  // index into `cues`: entered as the show begins; none: dark until an input
    std::optional<Schedule> schedule;  // by which it plays from its start on; then `start` is empty
    bool loops = false;                // the first cue comes after the last
    std::vector<SideList> sides;       // that play beside `cues`

    // Reads a show.yaml, or the one in a folder. Strict; the files that it names must exist.
    // Sources get their ids from `names`, so a source keeps its id when the show is read again.
    // Error: file, line, column, key, advice.
    static Result<Show> load(const std::filesystem::path& fileOrFolder, SourceNames& names);
    // Reads the only show of a program: its sources have the ids 0, 1, 2, ... in their order.
    static Result<Show> load(const std::filesystem::path& fileOrFolder);

    // bound() of this show.
    Result<CueList> bind(const Site& site, const PlayLengths* lengths = nullptr) const;

    // The cues of a list, by Input::list.
    const std::vector<Cue>& cuesOf(int list) const { return list == 0 ? cues : sides[static_cast<std::size_t>(list) - 1].cues; }
    // Whether the show waits for no input once a cue is entered: each cue from there on follows the
    // one before.
    bool needsNoGoFrom(std::size_t cue) const;
    // What it does if nobody presses anything: "starts dark and waits for GO".
    std::string beginning() const;

    // The index of the cue with a name, or else with a number. Error: there is none; suggests the
    // nearest name.
    Result<std::size_t> cueNamed(std::string_view nameOrNumber) const;
};

}  // namespace fantascope::show
