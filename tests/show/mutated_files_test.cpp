// Files that were damaged, or edited in a hurry: they load, or are refused with a place. Nothing
// crashes or hangs, and a damaged journal never tells another story.
// FANTASCOPE_MUTATIONS: how many of each kind.

#include "show/play/playback.h"
#include "show/play/resumption.h"
#include "show/revision.h"

#include "core/file.h"
#include "core/random.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;

int mutations() {
    const char* const wanted = std::getenv("FANTASCOPE_MUTATIONS");
    return wanted != nullptr ? std::atoi(wanted) : 400;
}

std::string exampleOf(const std::string& document) {
    const std::string text = readFile(std::filesystem::path(sourceFolder()) / "docs" / document).value();
    const std::size_t begin = text.find("```yaml\n") + 8;
    return text.substr(begin, text.find("```", begin) - begin);
}

// Damages a text at one place, as a disk, an editor or a person would.
void mutate(std::string& text, Rng& rng) {
    constexpr std::array<const char*, 24> kWords = {"1e309",    "-1",   "nan", "0",    "99999999999999999999",
                                                    "0.5",      "true", "~",   "[",    "]",
                                                    "{",        "}",    ": ",  "- ",   "\n",
                                                    "\t",       "&a ",  "*a ", "\"",   "# ",
                                                    "\xff\xfe", "<<: ", "|",   "25:99"};
    const auto below = [&](std::size_t count) {
        return count == 0 ? 0 : static_cast<std::size_t>(rng.below(static_cast<std::uint32_t>(count)));
    };
    const std::size_t at = below(text.size());
    const auto wordAt = [&](std::size_t where) {
        constexpr std::string_view kEnds = " \n,:[]{}\"";
        const std::size_t before = text.find_last_of(kEnds, where), end = std::min(text.find_first_of(kEnds, where), text.size());
        const std::size_t begin = before == std::string::npos ? 0 : before + 1;
        return std::pair(begin, end > begin ? end - begin : 0);
    };
    switch (below(7)) {
        case 0:
            if (!text.empty()) text[at] = static_cast<char>(below(256));
            return;
        case 1:
            text.erase(at, below(40));
            return;
        case 2:
            text.insert(at, kWords[below(kWords.size())]);
            return;
        case 3: {
            const auto [begin, length] = wordAt(at);
            text.replace(begin, length, kWords[below(kWords.size())]);
            return;
        }
        case 4: {  // a word that stands elsewhere
            const auto [other, otherLength] = wordAt(below(text.size()));
            const std::string word = text.substr(other, otherLength);
            const auto [begin, length] = wordAt(at);
            text.replace(begin, length, word);
            return;
        }
        case 5: {  // a line twice
            const std::size_t begin = text.rfind('\n', at) + 1, end = std::min(text.find('\n', at), text.size());
            if (end > begin) text.insert(begin, text.substr(begin, end - begin) + "\n");
            return;
        }
        default:
            text.resize(at);
    }
}
std::string mutated(std::string text, Rng& rng) {
    for (std::uint32_t times = 1 + rng.below(3); times > 0; --times) mutate(text, rng);
    return text;
}

// "show.yaml:3:7: ..." on each line that is not the rest of the line before.
void expectPlaces(const std::string& message, const std::string& name) {
    static const std::regex kPlace(":[0-9]+:[0-9]+: ");
    EXPECT_TRUE(message.find(name) != std::string::npos && std::regex_search(message, kPlace)) << message;
}

TEST(MutatedFiles, shows_play_or_are_refused_with_a_place) {
    const ScratchFolder folder;
    for (const char* file : {"patterns/leaves.pattern.yaml", "pictures/poster.png", "clips/rain.mp4", "clips/opening.mov",
                             "casts/trumpet.cast.yaml"})
        folder.file(file, "");
    const Site site = parseSite(exampleOf("site-format.md"), folder / "site.yaml").value();
    const std::string example = exampleOf("show-format.md");
    int played = 0;
    for (int i = 0; i < mutations(); ++i) {
        Rng rng(streamSeed(1, {static_cast<std::uint64_t>(i)}));
        SCOPED_TRACE(i);
        auto show = Show::load(folder.file("show.yaml", mutated(example, rng)));
        if (!show) {
            expectPlaces(show.error().message(), "show.yaml");
            continue;
        }
        const auto revision = Revision::of(*std::move(show), site);
        if (!revision) {
            expectPlaces(revision.error().message(), "show.yaml");
            continue;
        }
        ++played;
        Playback playback(Revision::cuesOf(*revision));
        ShowState state;
        for (Time time{}; time < 60s; time += 4s) {
            playback.apply({.at = time,
                            .kind = time < 20s ? Input::Kind::Go : Input::Kind::Jump,
                            .cue = static_cast<int>(rng.below(6)) - 1,
                            .ago = 1h});
            playback.foresee(time);
            playback.stateAt(time, state);
            EXPECT_TRUE(std::ranges::all_of(state.levels, [](float level) { return level >= 0 && level <= 1; }));
        }
        if ((*revision)->nights) static_cast<void>((*revision)->nights->after(1'800'000'000s));
    }
    EXPECT_GT(played, 0);
    EXPECT_LT(played, mutations());
}

TEST(MutatedFiles, sites_are_read_or_refused_with_a_place) {
    const std::string example = exampleOf("site-format.md");
    int read = 0;
    for (int i = 0; i < mutations(); ++i) {
        Rng rng(streamSeed(2, {static_cast<std::uint64_t>(i)}));
        SCOPED_TRACE(i);
        const auto site = parseSite(mutated(example, rng), "site.yaml");
        if (site)
            ++read;
        else
            expectPlaces(site.error().message(), "site.yaml");
    }
    EXPECT_GT(read, 0);
    EXPECT_LT(read, mutations());
}

// Example failure: a line of which one digit is wrong is taken for what it says, and the show goes
// on in another cue.
TEST(MutatedFiles, journals_leave_lines_out_and_invent_none) {
    const CueList list = [] {
        CueList list;
        list.dark = {{}, {0.f}, {}};
        for (int cue = 0; cue < 5; ++cue)
            list.cues.push_back({.look = {{}, {0.2f * static_cast<float>(cue)}, {}},
                                 .fade = 2s,
                                 .follow = {},
                                 .name = std::string(1, static_cast<char>('a' + cue))});
        return list;
    }();
    std::string text(kJournalHead);
    text += lineOf(journal::Run{.at = 0s, .utc = 1'800'000'000s, .list = hashOf(list), .show = "show.yaml"});
    for (int i = 0; i < 40; ++i) {
        const Time at = i * 1s;
        text += lineOf(journal::Line(
            Input{.at = at, .kind = i % 5 == 4 ? Input::Kind::Jump : Input::Kind::Go, .cue = i % 4, .ago = i % 3 * 1s}));
        text += lineOf(journal::State{at, {}, true, "b"});
        text += lineOf(journal::Told{at, "cue 2: b"});
    }
    std::set<std::string> lines;
    const Journal whole = journalOf(text).value();
    ASSERT_EQ(whole.damaged, 0u);
    for (const Journal::Entry& entry : whole.entries) lines.insert(lineOf(entry.line));
    for (int i = 0; i < mutations(); ++i) {
        Rng rng(streamSeed(3, {static_cast<std::uint64_t>(i)}));
        SCOPED_TRACE(i);
        const auto read = journalOf(mutated(text, rng));
        if (!read) {
            EXPECT_THAT(read.error().message(), testing::HasSubstr("this is no journal"));
            continue;
        }
        for (const Journal::Entry& entry : read->entries) ASSERT_TRUE(lines.contains(lineOf(entry.line))) << lineOf(entry.line);
        InputLog inputs(list);
        const auto resumed = resume(*read, read->newest(), inputs);
        EXPECT_LT(resumed ? resumed->cue : -1, 5);
    }
}

}  // namespace
}  // namespace fantascope::show
