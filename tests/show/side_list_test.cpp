// Lists beside the show's own, as a file gives them and as a site takes them.

#include "show/side_list.h"

#include "show/show.h"

#include "replaced.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

namespace fantascope::show {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using namespace std::chrono_literals;

constexpr std::string_view kShow = R"(fantascope: show
version: 2
title: Test
seed: 5
sources: {}
looks:
  black: {}
  wall: {outputs: {left: {layers: [], wind: {strength: 2}}}}
  warm: {fixtures: {counter: 0.5}, relays: {fog: on}}
  cool: {fixtures: {counter: 0.25}}
lists:
  Bar:
    start: Cool
    at_end: loop
    cues:
      - {name: Warm, look: warm, fade: 1, follow: 5, block: true}
      - {name: Cool, look: cool, fade: 1, follow: 5}
  Lamps:
    cues:
      - {name: Off, look: black, fade: 1, block: true}
cues:
  - {name: Night, look: wall, fade: 2, with: {Bar: Warm, Lamps: dark}}
  - {name: Late, look: wall, fade: 2}
)";

Site testSite() {
    Site site;
    site.file = "site.yaml";
    site.outputs.resize(2);
    site.outputs[0].name = site.outputs[0].canvas = "left";
    site.outputs[1].name = site.outputs[1].canvas = "right";
    site.fixtures = {{"counter", 1, 1, {"intensity"}}};
    site.relays = {{"fog", 0, 0, false}, {"road", 0, 1, true}};
    return site;
}

struct Loaded {
    ScratchFolder folder;
    Result<Show> show;

    explicit Loaded(const std::string& text) : show(Show::load(folder.file("show.yaml", text))) {}
    std::string refusal() const { return show ? "" : folder.relative(show.error().message()); }
};

std::string refusalAfter(std::string_view what, std::string_view by) {
    return Loaded(replaced(std::string(kShow), what, by)).refusal();
}

TEST(SideListFile, names_lists_with_their_own_cues) {
    const Loaded loaded{std::string(kShow)};
    ASSERT_EQ(loaded.refusal(), "");
    const Show& show = *loaded.show;
    ASSERT_EQ(show.sides.size(), 2u);
    EXPECT_EQ(show.sides[0].name, "Bar");
    EXPECT_EQ(show.sides[0].start, 1u);
    EXPECT_TRUE(show.sides[0].loops);
    EXPECT_FALSE(show.sides[1].start);
    EXPECT_FALSE(show.sides[1].loops);
    EXPECT_EQ(&show.cuesOf(2), &show.sides[1].cues);
    ASSERT_EQ(show.cues[0].with.size(), 2u);
    EXPECT_EQ(show.cues[0].with[0].list, 0u);
    EXPECT_EQ(show.cues[0].with[0].cue, 0);
    EXPECT_EQ(show.cues[0].with[1].list, 1u);
    EXPECT_EQ(show.cues[0].with[1].cue, -1);
    EXPECT_THAT(show.cues[1].with, IsEmpty());
}

TEST(SideListFile, mistakes_are_refused_with_place_and_advice) {
    EXPECT_THAT(refusalAfter("Bar: Warm,", "Baar: Warm,"), HasSubstr("no list is called 'Baar' (did you mean 'Bar'?)"));
    EXPECT_THAT(refusalAfter("Bar: Warm,", "Bar: Warn,"), HasSubstr("did you mean 'Warm'?"));
    EXPECT_THAT(refusalAfter("start: Cool", "start: schedule"), HasSubstr("lists.Bar.start"));
    EXPECT_THAT(refusalAfter("follow: 5, block: true", "follow: 5, with: {Lamps: Off}"),
                HasSubstr("no list plays beside this one"));
    EXPECT_THAT(refusalAfter("name: Cool, look: cool", "name: Cool, look: cold"), HasSubstr("lists.Bar.cues[1].look"));
    EXPECT_THAT(refusalAfter("version: 2", "version: 1"), HasSubstr("'lists' needs 'version: 2'"));
    EXPECT_THAT(refusalAfter("    cues:\n      - {name: Off", "    loop: true\n    cues:\n      - {name: Off"),
                HasSubstr("unknown key"));
    // A fault in a list is told once, and not again where a cue brings the list.
    const std::string fault = refusalAfter("name: Warm, look: warm", "name: Warm, look: worm");
    EXPECT_EQ(std::ranges::count(fault, '\n'), 0) << fault;
}

TEST(SideListFile, a_list_keeps_its_hands_off_what_its_looks_do_not_name) {
    const Loaded loaded{std::string(kShow)};
    const CueList list = loaded.show->bind(testSite()).value();
    ASSERT_EQ(list.sides.size(), 2u);
    const CueList &bar = *list.sides[0], &lamps = *list.sides[1];
    EXPECT_EQ(bar.name, "Bar");
    EXPECT_EQ(bar.start, 1);
    EXPECT_EQ(bar.goInterval, list.goInterval);
    EXPECT_EQ(list.start, std::nullopt);
    // Warm blocks, and names the fog machine alone; Cool goes on with it.
    EXPECT_THAT(bar.cues[0].tracksRelays, ElementsAre(0, 1));
    EXPECT_THAT(bar.cues[1].tracksRelays, ElementsAre(1, 1));
    EXPECT_THAT(lamps.cues[0].tracksRelays, ElementsAre(1, 1));
    EXPECT_NE(bar.seed, lamps.seed);
    EXPECT_NE(bar.seed, list.seed) << "what follows by chance does not go together";
}

TEST(SideListFile, one_list_moves_the_wind_of_an_output) {
    const Loaded loaded{std::string(kShow)};
    EXPECT_THAT(loaded.show->bind(testSite())->windLists, ElementsAre(0u, 0u));
    const Loaded own(replaced(std::string(kShow), "cool: {", "cool: {outputs: {right: {layers: [], wind: {gusts: 1}}}, "));
    EXPECT_THAT(own.show->bind(testSite())->windLists, ElementsAre(0u, 1u));
    const Loaded both(replaced(std::string(kShow), "cool: {", "cool: {wind: {gusts: 1}, "));
    const auto refused = both.show->bind(testSite());
    ASSERT_FALSE(refused);
    EXPECT_THAT(both.folder.relative(refused.error().message()),
                HasSubstr("lists.Bar: the wind on 'left' is moved by the show's cues already; one list can move it"));
}

TEST(SideListFile, what_the_site_lacks_is_refused) {
    Site site = testSite();
    site.fixtures[0].name = "counters";
    const auto refused = Loaded(std::string(kShow)).show->bind(site);
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message(), HasSubstr("no fixture is called 'counter' (did you mean 'counters'?)"));
}

}  // namespace
}  // namespace fantascope::show
