#include "app/lighting.h"

#include "app/running_show.h"

#include <gmock/gmock.h>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::Each;

class LightingPart : public testing::Test {
protected:
    // Both parts, as often as they would work in `time`.
    void run(Time time) {
        for (const Time end = run_.clock.now() + time; run_.clock.now() < end; run_.clock.advance(tickTime(1, Lighting::kRate))) {
            lighting_.tick(run_.clock.now());
            lighting_.relayTick(run_.clock.now());
        }
    }
    int sculpture() const { return run_.world.slots(1)[0]; }

    RunningShow run_;
    Lighting lighting_{run_.site, run_.cues, run_.devices, run_.clock, Time{}, nullptr};
};

TEST_F(LightingPart, brings_the_lamps_to_the_cue_and_dims_the_street) {
    run(1s);
    EXPECT_EQ(sculpture(), 0);
    EXPECT_THAT(run_.world.relays(), Each(true)) << "before the first cue the street is lit";
    ASSERT_TRUE(lighting_.replica().give(run_.jumpTo("Full")));
    run(10s);
    EXPECT_EQ(sculpture(), 255);
    EXPECT_THAT(run_.world.relays(), Each(false));
}

// Example failure: relays are written when the show changes them and only then; after a lost bus the street stays lit all night.
TEST_F(LightingPart, gives_a_returned_relay_bank_its_states_again) {
    ASSERT_TRUE(lighting_.replica().give(run_.jumpTo("Full")));
    run(10s);
    for (int loss = 0; loss < 2; ++loss) {
        run_.world.setPlugged("relay bank", false);
        run(1s);
        EXPECT_THAT(run_.world.relays(), Each(true)) << "a bank that is alone takes its safe states";
        run_.world.setPlugged("relay bank", true);
        run(1s);
        EXPECT_THAT(run_.world.relays(), Each(false));
    }
}

// The loss is over before anybody looked.
TEST_F(LightingPart, notices_a_loss_between_two_looks) {
    ASSERT_TRUE(lighting_.replica().give(run_.jumpTo("Full")));
    run(10s);
    run_.world.setPlugged("relay bank", false);
    run_.world.setPlugged("relay bank", true);
    EXPECT_THAT(run_.world.relays(), Each(true));
    run(1s);
    EXPECT_THAT(run_.world.relays(), Each(false));
}

TEST_F(LightingPart, a_lost_line_stops_neither_itself_nor_the_relays) {
    run(1s);
    run_.world.setPlugged("universe 1", false);
    ASSERT_TRUE(lighting_.replica().give(run_.jumpTo("Full")));
    run(10s);
    EXPECT_EQ(sculpture(), 0);
    EXPECT_THAT(run_.world.relays(), Each(false));
    run_.world.setPlugged("universe 1", true);
    run(1s);
    EXPECT_EQ(sculpture(), 255);
}

}  // namespace
}  // namespace fantascope::app
