#include "drivers/common/service.h"

#include "drivers/common/shared.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <future>
#include <vector>

namespace fantascope::drivers {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr Time kLong = std::chrono::hours(1);  // never reached in a test

Service::RunOnce once(std::function<Outage(Service&)> first, std::function<Outage(Service&)> later) {
    return [first = std::move(first), later = std::move(later), lives = 0](Service& service) mutable {
        return lives++ == 0 ? first(service) : later(service);
    };
}

Outage untilTheEnd(Service& service) {
    while (!service.ending()) service.wait(kLong);
    return {};
}

TEST(Service, is_starting_until_the_first_attempt_has_ended) {
    std::promise<void> mayEnd, again;
    Service service("lamp", "test", LossAction::Hold,
                    once(
                        [&](Service&) -> Outage {
                            mayEnd.get_future().wait();
                            return {DeviceState::Absent, "it is not there"};
                        },
                        [&](Service& device) {
                            again.set_value();
                            return untilTheEnd(device);
                        }));
    EXPECT_EQ(service.status().state, DeviceState::Starting);
    EXPECT_THAT(service.status().detail, testing::Not(IsEmpty())) << "what is not Running says why";
    mayEnd.set_value();
    again.get_future().wait();
    EXPECT_EQ(service.status().state, DeviceState::Absent);
    EXPECT_EQ(service.status().losses, 0) << "what never ran was not lost";
    EXPECT_THAT(service.refusal().message(), HasSubstr("lamp is absent: it is not there"));
}

TEST(Service, counts_a_loss_for_every_life_that_ends) {
    std::vector<int> losses;
    std::promise<void> done;
    {
        Service service("lamp", "test", LossAction::Hold, [&](Service& device) -> Outage {
            losses.push_back(device.status().losses);
            if (losses.size() == 3) {
                done.set_value();
                return untilTheEnd(device);
            }
            device.setRunning();
            return {DeviceState::Faulted, "it bit"};
        });
        done.get_future().wait();
        EXPECT_FALSE(service.isRunning());
    }
    EXPECT_THAT(losses, ElementsAre(0, 1, 2));
}

TEST(Service, is_in_trouble_until_that_is_over_or_it_is_lost) {
    std::vector<std::string> troubles;
    std::promise<void> done;
    {
        Service service("lamp", "test", LossAction::Hold, [&](Service& device) -> Outage {
            const auto note = [&] { troubles.push_back(device.status().trouble); };
            note();
            if (troubles.size() > 1) {
                done.set_value();
                return untilTheEnd(device);
            }
            device.setRunning();
            for (const char* trouble : {"it flickers", "", "it hums"}) {
                device.setTrouble(trouble);
                note();
            }
            return {DeviceState::Faulted, "it bit"};
        });
        done.get_future().wait();
    }
    EXPECT_THAT(troubles, ElementsAre("", "it flickers", "", "it hums", ""));
}

TEST(Service, ends_while_it_waits) {
    std::promise<void> running;
    Service service("lamp", "test", LossAction::Hold, [&](Service& device) {
        device.setRunning();
        running.set_value();
        return untilTheEnd(device);
    });
    running.get_future().wait();
    EXPECT_TRUE(service.isRunning());
    EXPECT_THAT(service.status().detail, IsEmpty());
}

TEST(Service, waits_for_a_file_or_wake_and_tells_them_apart) {
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const FileHandle out(ends[0]), in(ends[1]);
    std::promise<bool> byFile, byWake;
    std::promise<void> waitsForWake;
    Service service("lamp", "test", LossAction::Hold, [&](Service& device) {
        byFile.set_value(device.wait(kLong, {out.get()}));
        char byte = 0;
        EXPECT_EQ(read(out.get(), &byte, 1), 1);
        waitsForWake.set_value();
        byWake.set_value(device.wait(kLong, {out.get()}));
        return untilTheEnd(device);
    });
    ASSERT_EQ(write(in.get(), "x", 1), 1);
    EXPECT_TRUE(byFile.get_future().get());
    waitsForWake.get_future().wait();
    service.wake();
    EXPECT_FALSE(byWake.get_future().get());
}

TEST(Shared, is_one_thing_for_as_long_as_anybody_holds_it) {
    Shared<std::string, int> lines;
    int made = 0;
    const auto make = [&] { return std::make_shared<int>(++made); };
    auto first = lines.get("a", make), second = lines.get("a", make);
    const auto other = lines.get("b", make);
    EXPECT_EQ(first, second);
    EXPECT_EQ(*other, 2);
    first.reset();
    second.reset();
    EXPECT_EQ(*lines.get("a", make), 3);
}

}  // namespace
}  // namespace fantascope::drivers
