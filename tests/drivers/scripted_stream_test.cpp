#include "drivers/byte_stream/simulated.h"
#include "drivers/site/world.h"

#include <gmock/gmock.h>

namespace fantascope::drivers {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

class ScriptedStreamTest : public testing::Test {
protected:
    void say(const Bytes& bytes) { ASSERT_TRUE(stream_.write(bytes)); }
    Bytes hear() {
        Bytes bytes(100);
        bytes.resize(stream_.read(bytes, Time::zero()).value());
        return bytes;
    }

    ManualClock clock_;
    site::World world_{clock_};
    DriverContext context_{clock_, &world_};
    ScriptedStream stream_{context_, "widget"};
};

TEST_F(ScriptedStreamTest, replies_when_exactly_the_expected_bytes_have_come) {
    stream_.expect({0x7e, 0x0a}, {1, 2}).expect({0x7e, 0x03}, {3});
    say({0x7e});
    EXPECT_THAT(hear(), IsEmpty());
    say({0x0a});
    EXPECT_THAT(hear(), ElementsAre(1, 2));
    EXPECT_FALSE(stream_.finished());
    say({0x7e, 0x03});
    EXPECT_THAT(hear(), ElementsAre(3));
    EXPECT_TRUE(stream_.finished());
    EXPECT_EQ(stream_.deviation(), "");
}

// A driver may write several commands at once.
TEST_F(ScriptedStreamTest, one_write_may_hold_several_exchanges) {
    stream_.expect({1}, {10}).expect({2}, {20}).expect({3});
    say({1, 2});
    EXPECT_THAT(hear(), ElementsAre(10, 20));
    EXPECT_FALSE(stream_.finished());
}

TEST_F(ScriptedStreamTest, the_far_end_speaks_first_where_nothing_is_expected) {
    stream_.expect({1}).expect({}, {9, 9});
    EXPECT_THAT(hear(), IsEmpty());
    say({1});
    EXPECT_THAT(hear(), ElementsAre(9, 9));
}

TEST_F(ScriptedStreamTest, the_first_wrong_byte_is_told_and_ends_the_script) {
    stream_.expect({1}, {10}).expect({1, 2}, {20});
    say({1, 1, 3, 1, 2});
    EXPECT_EQ(stream_.deviation(), "exchange 2, byte 2: 0x02 was expected, 0x03 came");
    EXPECT_THAT(hear(), ElementsAre(10));
    EXPECT_FALSE(stream_.finished());
    EXPECT_THAT(stream_.received(), ElementsAre(1, 1, 3, 1, 2));
}

TEST_F(ScriptedStreamTest, bytes_after_the_end_are_a_deviation) {
    stream_.expect({1});
    say({1, 5});
    EXPECT_EQ(stream_.deviation(), "after the script's end: 0x05 came");
    EXPECT_FALSE(stream_.finished());
}

TEST_F(ScriptedStreamTest, the_two_ends_of_a_loopback_share_a_line_and_a_plug) {
    const auto ends = openLoopback(context_, "line", 4);
    EXPECT_EQ(ends[1]->write(Bytes{1, 2, 3, 4, 5}).value(), 4u);
    Bytes bytes(10);
    EXPECT_EQ(ends[0]->read(bytes, 1s).value(), 4u);
    world_.setPlugged("line", false);
    EXPECT_FALSE(ends[0]->write(Bytes{1}));
    EXPECT_FALSE(ends[1]->write(Bytes{1}));
}

}  // namespace
}  // namespace fantascope::drivers
