#pragma once

#include "show/cue_list.h"
#include "show/show_state.h"
#include "show/site/site.h"
#include "show/source.h"
#include "show/wind.h"

#include "core/config/file_place.h"
#include "core/result.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace fantascope::show {

// Something that the show wants of a thing of the site, which it calls by name.
template <class Wish>
struct Named {
    std::string name;
    FilePlace at;  // for whoever has to refuse the name
    Wish wish;
};

// A look as its author wrote it. What it does not name is black, at level 0, or in its safe state.
struct NamedLook {
    using ChannelLevels = std::vector<Named<float>>;
    using Levels = std::variant<float, ChannelLevels>;  // one for all channels of a fixture, or each by its name
    std::string name;
    struct OutputWish {
        OutputState layers;
        std::optional<WindWish> wind;  // without it, that of the look
    };
    std::vector<Named<OutputWish>> outputs;
    WindWish wind;
    std::vector<Named<Levels>> fixtures;
    std::vector<Named<bool>> relays;  // true: on
};

// One step of the show.
struct Cue {
    std::string name;
    std::size_t look = 0;  // index into Show::looks
    Time fade{};
    std::optional<Time> follow;
};

// show.yaml as its author wrote it; docs/show-format.md describes the file. Value type.
struct Show {
    std::filesystem::path file;
    std::string title;
    Time goInterval{};
    Time blackoutFade{};
    std::uint64_t seed = 1;  // of what is random in the show itself
    std::vector<Source> sources;
    std::vector<NamedLook> looks;
    std::vector<Cue> cues;

    // Reads a show.yaml, or the one in a folder. Strict; the files that it names must exist.
    // Sources get their ids from `names`: the same as those of whatever was read with them before.
    // Error: file, line, column, key, advice.
    static Result<Show> load(const std::filesystem::path& fileOrFolder, SourceNames& names);
    // The same of a show that is the only one: its sources have the ids 0, 1, 2, ... in their
    // order.
    static Result<Show> load(const std::filesystem::path& fileOrFolder);

    // Looks every name up in `site`. Error: place in the show file, and what the site has instead.
    Result<CueList> bind(const Site& site) const;

    // The index of a cue. Error: no cue has this name; says which one was perhaps meant.
    Result<std::size_t> cueNamed(std::string_view name) const;
};

}  // namespace fantascope::show
