#include "app/site/devices.h"

#include "app/three_outputs.h"
#include "drivers/site/world.h"

#include "contract/projectors.h"
#include "contract/x_server.h"
#include "edid_block.h"
#include "program.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

namespace fantascope::app {
namespace {

using testing::HasSubstr;

// The projectors of a site are not there when its show is rehearsed at home.
// Example failure: the site's own driver keeps its keys, and a rehearsal in windows shows nothing
// and waits for the monitors.
TEST(SimulatedDevices, are_windows_of_the_desktop_whatever_monitors_the_site_names) {
    const auto server = XServer::start();
    ASSERT_TRUE(server) << server.error().message();
    const ThreeOutputs show(
        {"{driver: glfw, monitor: {serial: A}}", "{driver: glfw, monitor: HDMI-7, position: [0, 0]}", "{driver: headless}"});
    ManualClock clock;
    site::World world(clock);
    const auto simulated = openDevices(show.site, Backends::SimulatedWindows, {clock, &world});
    ASSERT_TRUE(simulated) << simulated.error().message();
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(simulated->displays[i]->status().detail, "");
        EXPECT_EQ(simulated->displays[i]->status().driver, "glfw");
        EXPECT_TRUE((*server)->hasWindow(ThreeOutputs::kNames[i]));
    }
    const auto declared = openDevices(show.site, Backends::AsDeclared, {clock});
    ASSERT_TRUE(declared) << declared.error().message();
    EXPECT_THAT(declared->displays[1]->status().detail, HasSubstr("no monitor HDMI-7"));
}

// Somebody who writes a site file at home wants to know which projectors it would find, without
// black windows over the screen.
TEST(DevicesCommand, says_which_projectors_are_there_and_which_a_site_would_find) {
    auto projectors = Projectors::start();
    ASSERT_TRUE(projectors) << projectors.error().message();
    (*projectors)->switchOn("DUMMY0", {0, 0});
    (*projectors)->plug("DUMMY0", edidBlock({.serial = "A"}));
    const ScratchFolder folder;
    const std::string site = folder.file("site.yaml", R"(fantascope: site
version: 1
outputs:
  - {name: left, display: {driver: glfw, monitor: {serial: A}}, size: [640, 360], refresh_rate: 60}
  - {name: right, display: {driver: glfw, monitor: {serial: B}}, size: [640, 360], refresh_rate: 60}
  - {name: memory, display: {driver: headless}, size: [640, 360], refresh_rate: 60}
)");
    const Outcome listed = runProgram({"devices", "--site", site}, folder.path());
    EXPECT_THAT(listed, exits(0));
    EXPECT_THAT(listed.out, HasSubstr("display         "));
    EXPECT_THAT(listed.out, HasSubstr("serial: A}}"));
    EXPECT_THAT(listed.out, HasSubstr("left            glfw, running\n"));
    EXPECT_THAT(listed.out, HasSubstr("right           glfw, absent: there is no monitor {serial: B}"));
    EXPECT_THAT(listed.out, HasSubstr("memory          headless, running\n"));
}

}  // namespace
}  // namespace fantascope::app
