#include "show/patch.h"

#include <gmock/gmock.h>

#include <array>

namespace fantascope::show {
namespace {

using testing::Each;
using testing::ElementsAre;

Site testSite() {
    Site site;
    site.fixtures = {{"a", 1, 1, {"intensity"}}, {"b", 2, 5, {"intensity"}}, {"c", 1, 511, {"red", "green"}}};
    site.relayBanks = {{"street", {}}, {"stage", {}}};
    site.relays = {{"road", 0, 3, true}, {"fog", 1, 1, false}, {"path", 0, 0, false}};
    return site;
}

std::array<std::uint8_t, 512> slots(const Look& look, int universe) {
    std::array<std::uint8_t, 512> out;
    out.fill(99);  // what an earlier frame left
    slotsOf(testSite(), look, universe, out);
    return out;
}

TEST(Patch, levels_go_to_their_addresses_and_the_rest_is_zero) {
    Look look;
    look.levels = {1.0f, 0.2f, 0.4f, 0.6f};
    const auto first = slots(look, 1), second = slots(look, 2);
    EXPECT_EQ(first[0], 255);
    EXPECT_EQ(first[510], 102);
    EXPECT_EQ(first[511], 153);
    EXPECT_THAT(std::span(first).subspan(1, 509), Each(0));
    EXPECT_EQ(second[4], 51);
    EXPECT_EQ(second[0], 0);
    EXPECT_THAT(slots(look, 3), Each(0));  // a universe without fixtures
}

// Example failure: truncation, which never reaches 255 by a rounding error and dims every lamp by
// half a step.
TEST(Patch, levels_are_rounded_to_the_nearest_step) {
    for (const auto& [level, slot] :
         {std::pair{0.0f, 0}, {0.499f / 255, 0}, {0.501f / 255, 1}, {0.5f, 128}, {254.4f / 255, 254}, {0.9999f, 255}})
        EXPECT_EQ(slots(Look{{}, {level, 0, 0, 0}, {}}, 1)[0], slot) << level;
}

TEST(Patch, relays_go_to_the_coils_of_their_bank_and_coils_between_are_off) {
    Look look;
    look.relays = {1, 1, 1};
    EXPECT_THAT(coilsOf(testSite(), look, 0), ElementsAre(true, false, false, true));
    EXPECT_THAT(coilsOf(testSite(), look, 1), ElementsAre(false, true));
    look.relays = {0, 1, 1};
    EXPECT_THAT(coilsOf(testSite(), look, 0), ElementsAre(true, false, false, false));
    EXPECT_THAT(coilsOf(testSite(), look, 1), ElementsAre(false, true));
    EXPECT_THAT(safeCoils(testSite(), 0), ElementsAre(false, false, false, true));
    EXPECT_THAT(safeCoils(testSite(), 1), ElementsAre(false, false));
}

}  // namespace
}  // namespace fantascope::show
