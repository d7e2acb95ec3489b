#include "app/parts/part_guard.h"

#include "app/running_show.h"

#include <gmock/gmock.h>

#include <new>
#include <stdexcept>
#include <string>
#include <vector>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

// Parts on a stepped clock at 100 Hz, in a show that began 5 s before the clock did.
class PartGuardTest : public testing::Test {
protected:
    PartGuardTest() { faults_.begin(show::ShowClock(0s, 5s)); }
    Part part(const std::string& name, Rank rank, std::function<void(Time)> work) {
        return guarded({.name = name, .rate = 100, .work = std::move(work), .rank = rank}, faults_);
    }
    std::vector<std::string> told() const { return toldOf(events_); }

    show::EventLog events_;
    FaultLog faults_{events_};
    SteppedClock clock_;
};

// Example failure: an exception in the least part ends the night.
TEST_F(PartGuardTest, an_exception_ends_one_call_of_its_part_alone_and_is_told_once) {
    int others = 0;
    clock_.setParts({part("watch", Rank::Watch, [](Time) { throw std::runtime_error("the lens is broken"); }),
                     part("input", Rank::Input, [&](Time) { ++others; })});
    clock_.sleepUntil(10s);
    EXPECT_EQ(others, 1001);
    EXPECT_THAT(told(), ElementsAre("the part 'watch' failed: the lens is broken; it is tried again, and the rest plays on"));
    const auto faults = faults_.faults();
    ASSERT_EQ(faults.size(), 1u);
    EXPECT_EQ(faults[0].at, 5s) << "in show time";
    EXPECT_EQ(faults[0].device, "watch");
    EXPECT_FALSE(faults[0].until);
}

TEST_F(PartGuardTest, what_is_no_standard_exception_is_caught_too) {
    clock_.setParts({part("watch", Rank::Watch, [](Time) { throw 7; })});
    clock_.sleepUntil(1s);
    EXPECT_THAT(told(), ElementsAre(StartsWith("the part 'watch' failed: of unknown kind")));
}

TEST_F(PartGuardTest, a_part_that_fails_is_tried_ever_more_rarely) {
    std::vector<Time> tries;
    clock_.setParts({part("watch", Rank::Watch, [&](Time moment) {
        tries.push_back(moment);
        throw std::bad_alloc();
    })});
    clock_.sleepUntil(60s);
    ASSERT_GT(tries.size(), 8u);
    EXPECT_THAT(std::vector(tries.begin(), tries.begin() + 5), ElementsAre(0ms, 50ms, 150ms, 350ms, 750ms));
    EXPECT_EQ(tries.back() - tries[tries.size() - 2], PartGuard::kLatest);
}

// Somebody presses GO.
TEST_F(PartGuardTest, a_part_that_a_person_may_wait_for_is_tried_every_second_at_least) {
    std::vector<Time> tries;
    clock_.setParts({part("input", Rank::Input, [&](Time moment) {
        tries.push_back(moment);
        throw std::bad_alloc();
    })});
    clock_.sleepUntil(60s);
    EXPECT_GT(tries.size(), 60u);
}

// Example failure: lamps stand still for a second because one line was refused once.
TEST_F(PartGuardTest, lighting_is_tried_again_at_its_next_tick) {
    int tries = 0;
    clock_.setParts({part("lighting", Rank::Lighting, [&](Time) {
        ++tries;
        throw std::bad_alloc();
    })});
    clock_.sleepUntil(10s);
    EXPECT_EQ(tries, 1001);
    EXPECT_EQ(told().size(), 1u);
}

TEST_F(PartGuardTest, a_part_that_works_again_is_told_with_the_length_of_its_fault) {
    clock_.setParts({part("watch", Rank::Watch, [](Time moment) {
        if (moment >= 1s && moment < 2s) throw std::runtime_error("broken");
    })});
    clock_.sleepUntil(10s);
    EXPECT_THAT(told(), ElementsAre(HasSubstr("broken"), StartsWith("the part 'watch' works again after 1.")));
    ASSERT_EQ(faults_.faults().size(), 1u);
    EXPECT_TRUE(faults_.faults()[0].until);
}

// Of which nothing can be told: there are no words for it.
struct Nameless : std::exception {
    const char* what() const noexcept override { return nullptr; }
};

TEST_F(PartGuardTest, what_cannot_be_told_ends_nothing_and_is_told_once_it_can) {
    PartGuard guard("watch", Rank::Watch, faults_);
    EXPECT_FALSE(guard.run(0s, [](Time) { throw Nameless(); }));
    EXPECT_THAT(told(), ElementsAre());
    EXPECT_FALSE(guard.run(1s, [](Time) { throw std::bad_alloc(); }));
    EXPECT_THAT(told(), ElementsAre(StartsWith("the part 'watch' failed: std::bad_alloc")));
    int works = 0;
    EXPECT_TRUE(guard.run(2s, [&](Time) { ++works; }));
    EXPECT_EQ(works, 1);
    EXPECT_THAT(told().back(), HasSubstr("works again"));
}

// Example failure: a terminal that was stopped by Ctrl-S stops the lamps.
TEST_F(PartGuardTest, a_part_that_blocks_holds_up_no_other) {
    SteadyClock clock;
    std::atomic<bool> blocked = false, mayGoOn = false;
    std::atomic<int> lamps = 0;
    {
        const PartThreads threads(clock, {part("progress", Rank::Input,
                                               [&](Time) {
                                                   blocked = true;
                                                   blocked.notify_all();
                                                   mayGoOn.wait(false);
                                               }),
                                          part("lighting", Rank::Lighting, [&](Time) { ++lamps; })});
        blocked.wait(false);
        for (const int before = lamps; lamps < before + 10;) std::this_thread::yield();
        mayGoOn = true;
        mayGoOn.notify_all();
    }
    EXPECT_THAT(told(), testing::IsEmpty());
}

}  // namespace
}  // namespace fantascope::app
