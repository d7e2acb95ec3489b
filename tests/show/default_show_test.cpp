#include "show/play/playback.h"
#include "show/show.h"
#include "show/site/site.h"

#include "scratch_folder.h"
#include "source_folder.h"

#include <gmock/gmock.h>

#include <set>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using testing::Each;

const std::filesystem::path kSource = sourceFolder();

// The default show as it stands, with files in the places of its patterns, which are made from its
// drawings.
struct DefaultShow {
    ScratchFolder folder;
    Result<Show> show = Error("not loaded");

    DefaultShow() {
        for (const char* pattern : {"left.pattern.yaml", "right.pattern.yaml"}) folder.file(pattern, "");
        show = Show::load(folder.file("show.yaml", readFile(kSource / "shows/light-movement/show.yaml").value()));
    }
};

// The evening of a rehearsal, GO every ten seconds: the street is lit before and after, dark
// between, and every picture is reached.
TEST(DefaultShow, steps_through_its_evening_on_the_simulated_site) {
    const DefaultShow loaded;
    ASSERT_TRUE(loaded.show) << loaded.show.error().message();
    const auto site = readSite(kSource / "config/simulated/site.yaml");
    ASSERT_TRUE(site) << site.error().message();
    auto list = loaded.show->bind(*site);
    ASSERT_TRUE(list) << list.error().message();

    const std::size_t cues = list->cues.size();
    ASSERT_GE(cues, 5u);
    Playback playback(std::move(list).value());
    std::vector<ShowState> ends(cues);
    for (std::size_t i = 0; i < cues; ++i) {
        const Time at = 10s * static_cast<int>(i);
        EXPECT_EQ(playback.apply({.at = at}), Outcome::Taken);
        playback.stateAt(at + 10s - 1ns, ends[i]);
    }
    std::set<SourceId> seen;
    for (std::size_t i = 0; i < cues; ++i) {
        EXPECT_EQ(ends[i].cue, static_cast<int>(i));
        const bool street = i == 0 || i == cues - 1;
        EXPECT_THAT(ends[i].relays, Each(street ? 1 : 0)) << loaded.show->cues[i].name;
        for (const OutputState& output : ends[i].outputs) {
            EXPECT_EQ(output.layers.empty(), street) << loaded.show->cues[i].name;
            for (const LayerState& layer : output.layers) seen.insert(layer.source);
        }
    }
    EXPECT_EQ(seen.size(), loaded.show->sources.size());
}

// Every show that comes with the program plays on the simulated site, with all the files that it
// names.
TEST(Shows, load_and_play_on_the_simulated_site) {
    const auto site = readSite(kSource / "config/simulated/site.yaml");
    ASSERT_TRUE(site) << site.error().message();
    int shows = 0;
    for (const auto& folder : std::filesystem::directory_iterator(kSource / "shows")) {
        if (!std::filesystem::exists(folder.path() / "show.yaml")) continue;  // drawings alone, of a show to come
        const auto show = Show::load(folder.path());
        ASSERT_TRUE(show) << show.error().message();
        const auto list = show->bind(*site);
        ASSERT_TRUE(list) << list.error().message();
        std::set<SourceId> seen;
        for (const auto& cue : list->cues)
            for (const OutputState& output : cue.look.outputs)
                for (const LayerState& layer : output.layers) seen.insert(layer.source);
        EXPECT_EQ(seen.size(), show->sources.size()) << folder.path() << ": a source is never shown";
        ++shows;
    }
    EXPECT_GE(shows, 2);
}

}  // namespace
}  // namespace fantascope::show
