// A show that is saved while the program plays it.

#include "running_program.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <string>

namespace fantascope::app {
namespace {

using testing::HasSubstr;

constexpr const char* kWorkshop = R"(fantascope: show
version: 2
title: Workshop
start: Red
sources: {paint: {solid: [1, 0, 0]}}
looks: {red: {outputs: {wall: [{source: paint}]}}}
cues:
  - {name: Red, look: red, fade: 1}
)";

constexpr const char* kWorkshopSite = R"(fantascope: site
version: 1
outputs:
  - {name: wall, display: {driver: headless}, size: [64, 36], refresh_rate: 10,
     projector: {position: [0, 2, 8], look_at: [0, 1, 0], throw_ratio: 1.5}}
simulation:
  objects: [{name: wall, rectangle: {corner: [-9, 0, 0], right: [18, 0, 0], up: [0, 5, 0]}}]
  projectors: {wall: {lumens: 3000}}
)";

TEST(ProgramWithASavedShow, takes_it_over_or_says_where_it_is_wrong) {
    const ScratchFolder folder;
    folder.file("site.yaml", kWorkshopSite);
    folder.file("show.yaml", kWorkshop);
    RunningProgram program({"rehearse", ".", "--site", ".", "--by-hand", "--seconds", "300"}, folder.path());
    const auto says = [&](const std::string& what) {
        while (const auto line = program.line())
            if (line->find(what) != std::string::npos) return *line;
        return std::string("nothing of the kind");
    };
    const auto save = [&](const std::string& what, const std::string& by) {
        std::string text = kWorkshop;
        folder.file("show.yaml", text.replace(text.find(what), what.size(), by));
    };
    says("cue 1 of 1: Red");
    save("[1, 0, 0]", "[0, 1, 0");
    EXPECT_THAT(says("was saved"), HasSubstr("show.yaml was saved, but the show goes on as it was: ./show.yaml:"));
    save("cues:\n", "cues:\n  - {name: Before, look: red, fade: 0}\n");
    EXPECT_THAT(says("was saved"), HasSubstr("show.yaml was saved: the show goes on with it"));
    EXPECT_EQ(program.all().find("cue 2 of 2"), std::string::npos) << "no cue was entered";
    std::string site = kWorkshopSite;
    site.replace(site.find("size:"), 5, "corners: [[4, 2], [64, 0], [64, 36], [0, 36]], size:");
    folder.file("site.yaml", site);
    EXPECT_THAT(says("was saved"), HasSubstr("site.yaml was saved: now set up as it says: wall"));
    folder.file("site.yaml", site.replace(site.find("rate: 10"), 8, "rate: 2000"));
    EXPECT_THAT(says("was saved"), HasSubstr("site.yaml was saved, but the show goes on as it was: ./site.yaml:"));
    EXPECT_EQ(program.stop(), 0);
}

}  // namespace
}  // namespace fantascope::app
