#include "drivers/registry.h"

#include "drivers/site/world.h"

#include <gmock/gmock.h>

namespace fantascope::drivers {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class RegistryTest : public testing::Test {
protected:
    static ConfigNode options(const std::string& text) { return ConfigNode::parse(text, "site.yaml").value(); }

    // The errors of the openers for these options, for all ports whose drivers have no keys of
    // their own.
    static std::vector<std::string> refusals(const std::string& text, const DriverContext& context) {
        const ConfigNode node = options(text);
        const auto message = [](const auto& opened) { return opened ? "accepted" : opened.error().message(); };
        return {message(openDmxPort(node, 1, context)),
                message(openDmxSource(node, 1, context)),
                message(openRelayBank(node, "road", {true}, context)),
                message(openInputBank(node, "doors", 1, context)),
                message(openCueController(node, context)),
                message(openCamera(node, context))};
    }

    ManualClock clock_;
    site::World world_{clock_};
    DriverContext rehearsal_{clock_, &world_};
    DriverContext night_{clock_};
};

TEST_F(RegistryTest, opens_each_simulated_device_by_its_name) {
    const ConfigNode simulated = options("driver: simulated\n");
    EXPECT_EQ((*openDmxPort(simulated, 3, rehearsal_))->status().name, "universe 3");
    EXPECT_EQ((*openDmxSource(simulated, 3, rehearsal_))->status().name, "desk 3");
    EXPECT_EQ((*openRelayBank(simulated, "road", {true}, rehearsal_))->status().name, "road");
    EXPECT_EQ((*openInputBank(simulated, "doors", 1, rehearsal_))->status().name, "doors");
    EXPECT_EQ((*openCueController(simulated, rehearsal_))->status().name, "cue controller");
    EXPECT_EQ((*openCamera(simulated, rehearsal_))->status().name, "camera");
    EXPECT_EQ((*openDmxPort(simulated, 3, rehearsal_))->status().driver, "simulated");
}

TEST_F(RegistryTest, unknown_name_gets_the_known_ones_and_the_nearest) {
    EXPECT_THAT(refusals("driver: simulatd\n", rehearsal_),
                testing::Each(AllOf(StartsWith("site.yaml:1:9: driver: one of "), HasSubstr("simulated"),
                                    HasSubstr("did you mean 'simulated'?"))));
}

TEST_F(RegistryTest, displays_go_by_their_names_too) {
    EXPECT_THAT(openDisplay(options("driver: headles\n"), {}, rehearsal_).error().message(),
                AllOf(HasSubstr("here is 'headles'"), HasSubstr("did you mean 'headless'?")));
}

TEST_F(RegistryTest, missing_driver_key_gets_the_known_names) {
    EXPECT_THAT(refusals("drivers: simulated\n", rehearsal_),
                testing::Each(AllOf(StartsWith("site.yaml:1:1: 'driver' is missing, one of "), HasSubstr("simulated"))));
}

TEST_F(RegistryTest, a_key_that_the_driver_does_not_know_is_refused_with_its_place) {
    EXPECT_THAT(refusals("driver: simulated\nport: /dev/ttyUSB0\n", rehearsal_),
                testing::Each(StartsWith("site.yaml:2:1: port: unknown key")));
}

// Example failure: the night is started with the rehearsal's site file, and the street stays dark
// without a message.
TEST_F(RegistryTest, a_simulated_driver_without_a_simulated_site_is_refused) {
    EXPECT_THAT(refusals("driver: simulated\n", night_),
                testing::Each(AllOf(StartsWith("site.yaml:1:1: "), HasSubstr("needs a simulated site"))));
}

}  // namespace
}  // namespace fantascope::drivers
