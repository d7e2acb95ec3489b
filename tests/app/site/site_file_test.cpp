#include "app/site/site_file.h"

#include "app/command/check_command.h"
#include "app/site/devices.h"
#include "drivers/site/world.h"

#include "core/random.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace fantascope::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

// A site of one device each, to be cut to what a test needs.
struct Parts {
    std::string display = "{driver: headless}", port = "{driver: simulated}", desk, relays, contacts, controller, camera, more;
};

std::string siteOf(const Parts& parts) {
    std::string text = fmt::format(
        "fantascope: site\nversion: 1\noutputs:\n  - name: left\n    size: [64, 64]\n    refresh_rate: 30\n    display: {}\n"
        "    projector: {{position: [0, 0, 5], look_at: [0, 0, 0], throw_ratio: 1}}\nuniverses:\n  - number: 1\n    port: {}\n",
        parts.display, parts.port);
    if (!parts.desk.empty()) text += fmt::format("    desk: {{device: {}}}\n", parts.desk);
    if (!parts.relays.empty())
        text += fmt::format(
            "relay_banks:\n  - name: lamps\n    device: {}\nrelays:\n  - {{name: a, coil: 0, safe: on}}\n  - {{name: b, coil: 3, "
            "safe: off}}\n",
            parts.relays);
    if (!parts.contacts.empty())
        text +=
            fmt::format("contact_banks:\n  - name: doors\n    device: {}\ncontacts:\n  - {{name: gate, input: 3, closes: go}}\n",
                        parts.contacts);
    if (!parts.controller.empty()) text += fmt::format("cue_controller: {{device: {}, buttons: {{go: 1}}}}\n", parts.controller);
    if (!parts.camera.empty())
        text += fmt::format(
            "camera: {{device: {}, size: [64, 36], field_of_view: 50, position: [0, 0, 5], look_at: [0, 0, 0]}}\n", parts.camera);
    return text + parts.more;
}

constexpr const char* kSimulation = R"(simulation:
  objects: [{name: wall, rectangle: {corner: [-2, -2, 0], right: [4, 0, 0], up: [0, 4, 0]}}]
)";

class SiteFileTest : public testing::Test {
protected:
    SiteFileTest() {
        ::unsetenv("DISPLAY");  // no window is opened on somebody's desktop
    }
    std::string refusal(const std::string& text) {
        const auto site = readSite(folder_.file("site.yaml", text));
        return site ? "" : folder_.relative(site.error().message());
    }
    // The same by show's reader and by opening everything, as a run does.
    std::string refusalOfOpening(const std::string& text) {
        const auto site = show::readSite(folder_.file("site.yaml", text));
        if (!site) return folder_.relative(site.error().message());
        ManualClock clock;
        site::World world(clock);
        const auto devices = openDevices(*site, Backends::AsDeclared, {clock, &world});
        return devices ? "" : folder_.relative(devices.error().message());
    }

    ScratchFolder folder_;
};

// What a device's section may hold: keys with values that are right, and with values that are not.
struct SiteKey {
    std::string_view name;
    std::vector<std::string_view> right, wrong;
    bool isNeeded = false;
};
struct Section {
    std::string Parts::*part;
    std::string_view driver;
    std::vector<SiteKey> keys;
};

const std::vector<SiteKey> kTcp = {{"host", {"127.0.0.1"}, {"relay.local", "10.0.0", "[1]", "::1"}, true},
                                   {"port", {"9", "65535"}, {"99999", "0", "five", "{a: 1}"}, true},
                                   {"unit", {"1", "255"}, {"0", "250", "x"}},
                                   {"first", {"0", "100"}, {"-1", "65534", "65536"}},
                                   {"response_timeout", {"0.02", "0.1"}, {"9", "soon", "0"}}};
const std::vector<SiteKey> kRtu = {{"device", {"/dev/fantascope-none"}, {"ttyUSB0", "[]", "''"}, true},
                                   {"unit", {"1", "247"}, {"255", "0"}},
                                   {"baud", {"9600", "115200"}, {"9601", "300", "fast"}},
                                   {"parity", {"none", "odd"}, {"evn", "1"}},
                                   {"stop_bits", {"1", "2"}, {"3", "1.5"}},
                                   {"rs485", {"true", "false"}, {"yes please", "1"}}};

std::vector<SiteKey> with(std::vector<SiteKey> keys, const std::vector<SiteKey>& more) {
    keys.insert(keys.end(), more.begin(), more.end());
    return keys;
}

// Every network driver is kept on the loopback, whatever else is wrong.
const SiteKey kLoopback{"interface", {"lo"}, {"[lo]"}, true};
const std::vector<SiteKey> kRelayKeys = {
    {"kind", {"coils", "holding_registers"}, {"coil", "discrete_inputs"}},
    {"one_by_one", {"true", "false"}, {"often"}},
    {"timeout", {"2", "30"}, {"0", "31", "0.05"}},
    {"rate", {"0.2", "50"}, {"0", "51", "x"}},
    {"watchdog", {"{register: 4, period: 0.5}"}, {"{register: 4}", "{register: 70000, period: 1}", "4"}}};
const std::vector<SiteKey> kContactKeys = {{"kind", {"discrete_inputs", "input_registers"}, {"inputs", "[]"}},
                                           {"rate", {"0.2", "200"}, {"0", "201"}},
                                           {"debounce", {"0", "0.01"}, {"-1", "2"}},
                                           {"normally_closed", {"[0]", "[1, 3]"}, {"[4]", "0", "[-1]"}}};
const std::vector<Section> kSections = {
    {&Parts::display, "headless", {}},
    {&Parts::display,
     "glfw",
     {{"monitor", {"NONE-1", "{serial: none}"}, {"{seral: A}", "{}", "[]"}, true},
      {"position", {"[0, 0]"}, {"[0]", "[-1, 0]", "left"}}}},
    {&Parts::port, "simulated", {}},
    {&Parts::port,
     "sacn",
     {kLoopback,
      {"priority", {"0", "200"}, {"201", "-1", "high"}},
      {"unicast", {"[127.0.0.1]"}, {"[here]", "[]", "127.0.0.1"}},
      {"sync", {"1", "63999"}, {"0", "64000"}},
      {"preview", {"true"}, {"maybe"}},
      {"name", {"Courtyard"}, {"''", "{}"}}}},
    {&Parts::port,
     "artnet",
     {kLoopback,
      {"universe", {"0", "15"}, {"16", "-1"}},
      {"node", {"127.0.0.1"}, {"node.local", "239.0.0.1", "[]"}},
      {"sync", {"true"}, {"1"}},
      {"poll", {"false"}, {"0"}}}},
    {&Parts::port,
     "enttec_pro",
     {{"port", {"/dev/fantascope-none"}, {"ttyUSB0", "[]"}, true},
      {"number", {"'01234567'"}, {"123", "abcdefgh"}},
      {"break", {"97", "1000"}, {"20", "9999"}},
      {"mark_after_break", {"12"}, {"1"}},
      {"rate", {"1", "40"}, {"0", "41", "2.5"}}}},
    {&Parts::port,
     "open_dmx",
     {{"port", {"/dev/fantascope-none"}, {"ttyUSB0"}, true},
      {"break", {"92"}, {"91", "1001"}},
      {"mark_after_break", {"12"}, {"11"}},
      {"rate", {"1", "44"}, {"45", "x"}}}},
    {&Parts::desk, "simulated", {}},
    {&Parts::desk, "sacn", {kLoopback}},
    {&Parts::desk, "artnet", {kLoopback, {"universe", {"0"}, {"99"}}}},
    {&Parts::desk, "enttec_pro", {{"port", {"/dev/fantascope-other"}, {"here"}, true}, {"number", {"'76543210'"}, {"1"}}}},
    {&Parts::relays, "simulated", {}},
    {&Parts::relays, "modbus_tcp", with(kTcp, kRelayKeys)},
    {&Parts::relays, "modbus_rtu", with(kRtu, kRelayKeys)},
    {&Parts::contacts, "simulated", {}},
    {&Parts::contacts, "modbus_tcp", with(kTcp, kContactKeys)},
    {&Parts::contacts, "modbus_rtu", with(kRtu, kContactKeys)},
    {&Parts::controller, "simulated", {}},
    {&Parts::controller,
     "usb_hid",
     {{"vendor", {"ffff"}, {"fff", "xyzw", "[]"}, true},
      {"product", {"fffe"}, {"1"}},
      {"serial", {"none"}, {"''", "{}"}},
      {"profile", {"stream_deck", "xkeys_24"}, {"stream_dek", "7"}},
      {"debounce", {"0", "0.5"}, {"1", "-1"}},
      {"ask_state", {"false"}, {"no thanks"}},
      {"brightness", {"0", "1"}, {"2", "full"}}}},
    {&Parts::camera, "simulated", {}},
    {&Parts::camera,
     "v4l2",
     {{"device", {"/dev/fantascope-none"}, {"video0", "{}"}, true},
      {"size", {"[640, 480]"}, {"[640]", "[0, 1]", "big"}},
      {"rate", {"25"}, {"0", "2000"}},
      {"format", {"YUYV", "MJPG"}, {"MJPEG", "yuyv2"}},
      {"range", {"full"}, {"half"}},
      {"exposure", {"auto", "100"}, {"bright", "1.5"}},
      {"focus", {"0"}, {"near"}}}}};

// The file passes if and only if everything in it opens.
// Example failure: `driver: sACN` is said to be ok at noon and refused at nightfall.
TEST_F(SiteFileTest, check_passes_exactly_those_sites_whose_devices_open) {
    Rng rng(36);
    const auto below = [&](std::size_t count) { return static_cast<std::size_t>(rng.below(static_cast<std::uint32_t>(count))); };
    const char* const changes = std::getenv("FANTASCOPE_CHANGES");  // of each section; 500 for a thorough run
    const int each = changes == nullptr ? 60 : std::atoi(changes);
    int passed = 0, refused = 0;
    for (const Section& section : kSections)
        for (int i = 0; i < each; ++i) {
            std::vector<std::pair<std::string, std::string>> entries{{"driver", std::string(section.driver)}};
            for (const SiteKey& key : section.keys)
                if (key.isNeeded || below(3) == 0) entries.emplace_back(key.name, key.right[below(key.right.size())]);
            bool isWrong = true;
            switch (i % 6) {
                case 1:  // a key that nobody has
                    entries.emplace_back("hots", "1");
                    break;
                case 2:  // a driver that nobody has
                    entries[0].second = i % 4 == 0 ? "sACN" : std::string(section.driver) + "x";
                    break;
                case 3: {  // a key misspelt
                    std::string& key = entries[below(entries.size())].first;
                    key.insert(key.begin() + static_cast<std::ptrdiff_t>(key.size() / 2), 'q');
                    break;
                }
                case 4: {  // a wrong value
                    isWrong = !section.keys.empty();
                    if (!isWrong) break;
                    const SiteKey& key = section.keys[below(section.keys.size())];
                    std::erase_if(entries, [&](const auto& entry) { return entry.first == key.name; });
                    entries.emplace_back(key.name, key.wrong[below(key.wrong.size())]);
                    break;
                }
                case 5:  // something missing; on the loopback all the same
                    isWrong = false;
                    std::erase_if(entries, [&](const auto& entry) { return entry.first != "interface" && below(3) == 0; });
                    break;
                default:
                    isWrong = false;
            }
            std::string options;
            for (const auto& [key, value] : entries) options += fmt::format("{}{}: {}", options.empty() ? "" : ", ", key, value);
            Parts parts;
            parts.display = "{driver: glfw, monitor: NONE-1}";
            parts.*section.part = "{" + options + "}";
            const std::string text = siteOf(parts), checked = refusal(text), opened = refusalOfOpening(text);
            EXPECT_EQ(checked.empty(), opened.empty()) << text << "check: " << checked << "\nopening: " << opened;
            EXPECT_TRUE(!isWrong || !checked.empty()) << text;
            EXPECT_TRUE(checked.empty() || checked.starts_with("site.yaml:")) << checked;
            ++(checked.empty() ? passed : refused);
        }
    EXPECT_GT(passed, 4 * each);
    EXPECT_GT(refused, 10 * each);
}

// Example failure: the technician mends one line after the other, and starts the program each time.
TEST_F(SiteFileTest, all_faults_of_a_file_are_told_at_once_in_the_files_order) {
    Parts parts;
    parts.display = "{driver: headles}";
    parts.port = "{driver: sACN, interface: lo}";
    parts.desk = "{driver: artnet, interface: lo, net: 200}";
    parts.relays = "{driver: modbus_tcp, hots: 10.0.0.5, port: 99999}";
    parts.contacts = "{driver: modbus_tcp, host: relay.local, normally_closed: [9]}";
    parts.controller = "{driver: usb_hid, vendor: 46d}";
    parts.camera = "{driver: v4l2, device: video0}";
    parts.more = std::string(kSimulation) + "  camra: {}\n  faults: [{kind: unplug, at: 1, device: lamsp}]\n";
    std::vector<std::string> lines;
    std::istringstream all(refusal(siteOf(parts)));
    for (std::string line; std::getline(all, line);) lines.push_back(line);
    EXPECT_THAT(lines, testing::ElementsAre(HasSubstr("headles"), HasSubstr("sACN"), HasSubstr("net: 200"),
                                            HasSubstr("'host' is missing"), HasSubstr("hots: unknown key"),
                                            HasSubstr("port: 99999"), HasSubstr("relay.local"), HasSubstr("normally_closed"),
                                            HasSubstr("46d"), HasSubstr("video0"), HasSubstr("camra"), HasSubstr("lamsp")));
    EXPECT_THAT(lines, testing::Each(StartsWith("site.yaml:")));
    int before = 0;
    for (const std::string& line : lines) {
        const int number = std::atoi(line.c_str() + line.find(':') + 1);
        EXPECT_LE(before, number) << line;
        before = number;
    }
}

TEST_F(SiteFileTest, faults_of_show_and_of_drivers_are_told_together) {
    Parts parts;
    parts.port = "{driver: sACN}";
    parts.more = "fixtures: [{name: lamp, universe: 7, address: 600, channels: [red]}]\nrelays: []\nrely: 1\n";
    EXPECT_THAT(refusal(siteOf(parts)),
                AllOf(HasSubstr("here is 'sACN'"), HasSubstr("universe 7 is not declared"), HasSubstr("600 is out of range"),
                      HasSubstr("rely: unknown key (did you mean 'relays'?)")));
}

// A mistake is told once. Example failure: a bank's wrong key makes three relays of it look wrong,
// too.
TEST_F(SiteFileTest, what_follows_from_a_fault_is_not_told_as_another) {
    Parts parts;
    parts.relays = "{driver: modbus_tcp, host: 127.0.0.1}\n    rate: 4";
    EXPECT_THAT(refusal(siteOf(parts)), AllOf(HasSubstr("rate: unknown key"), Not(HasSubstr("\n"))));
    parts.relays = "{drver: modbus_tcp}";
    EXPECT_THAT(refusal(siteOf(parts)), AllOf(HasSubstr("'driver' is missing"), Not(HasSubstr("\n"))));
}

TEST_F(SiteFileTest, devices_that_cannot_share_a_line_are_refused_with_both_places) {
    Parts parts;
    parts.relays = "{driver: modbus_rtu, device: /dev/fantascope-none, baud: 9600}";
    parts.contacts = "{driver: modbus_rtu, device: /dev/fantascope-none, baud: 9600, unit: 2}";
    EXPECT_EQ(refusal(siteOf(parts)), "");
    parts.contacts = "{driver: modbus_rtu, device: /dev/fantascope-none, baud: 19200, unit: 2}";
    EXPECT_THAT(refusal(siteOf(parts)), AllOf(StartsWith("site.yaml:20:13:"), HasSubstr("baud 19200"), HasSubstr("baud 9600"),
                                              HasSubstr("the device at"), HasSubstr(":14:13")));
    parts.contacts.clear();
    parts.port = "{driver: open_dmx, port: /dev/fantascope-none}";
    EXPECT_THAT(refusal(siteOf(parts)), HasSubstr("/dev/fantascope-none is already used by the device at"));
    parts.relays.clear();
    parts.port = "{driver: enttec_pro, port: /dev/fantascope-none}";
    parts.desk = parts.port;
    EXPECT_THAT(refusal(siteOf(parts)), HasSubstr("/dev/fantascope-none is already used by the device at"));
}

TEST_F(SiteFileTest, a_simulation_is_read_beside_the_devices) {
    Parts parts;
    parts.more = kSimulation;
    EXPECT_EQ(refusal(siteOf(parts)), "");
    parts.more = "simulation: {objcts: []}\n";
    EXPECT_THAT(refusal(siteOf(parts)),
                AllOf(HasSubstr("simulation.objcts: unknown key (did you mean 'objects'?)"), Not(HasSubstr("\n"))));
    parts.more = std::string(kSimulation) + "  lamps: {lmap: {}}\n  projectors: {left: {lumens: -1}, lefd: {}}\n";
    EXPECT_THAT(refusal(siteOf(parts)),
                AllOf(HasSubstr("no fixture 'lmap'"), HasSubstr("lumens: -1 is out of range"), HasSubstr("no output 'lefd'")));
}

TEST_F(SiteFileTest, check_says_what_a_run_would_refuse) {
    Parts parts;
    parts.relays = "{driver: modbus_tcp, host: relay.local}";
    std::ostringstream out;
    EXPECT_FALSE(checkFiles({{folder_.file("site.yaml", siteOf(parts))}, std::nullopt}, out));
    EXPECT_THAT(out.str(), HasSubstr("'relay.local' is not an IPv4 address"));
}

}  // namespace
}  // namespace fantascope::app
