#include "drivers/cue_controller/hid_profile.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::drivers {
namespace {

using Kind = HidControl::Kind;

// A control at a place in a report; withControls() fills in the report's length.
HidControl control(Kind kind, std::string name, int report, int offset, int bits, std::int64_t low, std::int64_t high) {
    HidControl made;
    made.kind = kind;
    made.name = std::move(name);
    made.field.report = report;
    made.field.offset = static_cast<std::size_t>(offset);
    made.field.bits = bits;
    made.field.low = low;
    made.field.high = high;
    return made;
}

// `count` keys, `step` bits apart.
struct Run {
    int report, offset, bits, step, count;
};
std::vector<HidControl> keys(const std::vector<Run>& runs) {
    std::vector<HidControl> made;
    for (const Run& run : runs)
        for (int i = 0; i < run.count; ++i)
            made.push_back(control(Kind::Key, fmt::format("key {}", made.size() + 1), run.report, run.offset + i * run.step,
                                   run.bits, 0, 1));
    return made;
}

std::vector<HidControl> joined(std::vector<HidControl> first, std::vector<HidControl> second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

HidProfile withControls(std::string_view name, std::string_view what,
                        std::vector<std::pair<std::uint16_t, std::uint16_t>> devices, std::vector<HidControl> controls,
                        HidLampKind lamps = {}) {
    std::size_t bits = 0;
    int next = 1;
    for (HidControl& each : controls) {
        bits = std::max(bits, each.field.offset + static_cast<std::size_t>(each.field.bits));
        each.first = next;
        next += each.buttons();
    }
    for (HidControl& each : controls) each.reportBytes = (bits + 7) / 8;
    return {name, what, std::move(devices), {}, std::move(controls), std::move(lamps)};
}

// The sticks have the lamps of an XK-24, whose columns of six start at multiples of eight.
XkeysLamps stickLamps(int keys) {
    XkeysLamps lamps;
    for (int key = 0; key < keys; ++key) lamps.blue.push_back(key / 6 * 8 + key % 6);
    return lamps;
}

using Protocol = StreamDeckLamps::Protocol;
using Coding = KeyPictureFormat::Coding;
using Turn = KeyPictureFormat::Turn;

StreamDeckLamps deck(int keys, int side, Turn turn = Turn::Half) {
    return {Protocol::Main, keys, keys, {side, Coding::Jpeg, turn}, 0};
}

// https://docs.elgato.com/streamdeck/hid/stream-deck-plus: byte 1 is the kind of report: 0 keys, 2
// the touch strip, 3 dials.
std::vector<HidControl> dialsAndStrip() {
    std::vector<HidControl> made = keys({{1, 32, 8, 8, 8}});
    for (HidControl& key : made) key.marks = {{1, 0, 0}};
    for (int dial = 0; dial < 4; ++dial) {
        made.push_back(control(Kind::Key, fmt::format("dial {}", dial + 1), 1, 40 + 8 * dial, 8, 0, 1));
        made.back().marks = {{1, 3, 3}, {4, 0, 0}};
    }
    for (int dial = 0; dial < 4; ++dial) {
        made.push_back(control(Kind::Wheel, fmt::format("dial {}", dial + 1), 1, 40 + 8 * dial, 8, -128, 127));
        made.back().marks = {{1, 3, 3}, {4, 1, 1}};
    }
    // The strip, 800 wide, reports a short or long touch once the finger has left it. Swipes are
    // not used.
    for (int part = 0; part < 4; ++part) {
        made.push_back(
            control(Kind::Touch, fmt::format("strip above dial {}", part + 1), 1, 48, 16, 200 * part, 200 * part + 199));
        made.back().marks = {{1, 2, 2}, {4, 1, 2}};
    }
    return made;
}

// The jog is a position that wraps, and the shuttle springs back; the descriptor declares both as
// relative. From Contour's descriptor (0b33:0020), which has the bits of 13 buttons, five of them
// present.
std::vector<HidControl> jogAndShuttle() {
    return {control(Kind::Counter, "jog", 0, 8, 8, 0, 255), control(Kind::Axis, "shuttle", 0, 0, 8, -7, 7)};
}

void addPresenters(std::vector<HidProfile>& all) {
    // Keyboard: Page Down, Page Up, F5, Escape, period, B, Right, Left. Consumer page: volume up
    // and down.
    const std::vector<HidUsage> presenterKeys = {0x0007004e, 0x0007004b, 0x0007003e, 0x00070029, 0x00070037,
                                                 0x00070005, 0x0007004f, 0x00070050, 0x000c00e9, 0x000c00ea};
    all.push_back({"presenter",
                   "presenter",
                   {{0x046d, 0xc52d},   // Logitech R400, R700
                    {0x046d, 0xc53e},   // Logitech Spotlight
                    {0x0c45, 0x8101},   // AVATTO H100, August WP200
                    {0x2571, 0x4109},   // August LP315
                    {0x3243, 0x0122},   // Norwii
                    {0x69a7, 0x9803}},  // AVATTO i10 Pro
                   presenterKeys,
                   {}});
}

void addShuttles(std::vector<HidProfile>& all) {
    all.push_back(withControls("shuttle_xpress", "Contour ShuttleXpress", {{0x0b33, 0x0020}},
                               joined(keys({{0, 28, 1, 1, 5}}), jogAndShuttle())));
    all.push_back(withControls("shuttle_pro", "Contour ShuttlePRO", {{0x0b33, 0x0010}, {0x0b33, 0x0030}},
                               joined(keys({{0, 24, 1, 1, 15}}), jogAndShuttle())));
}

void addXkeys(std::vector<HidProfile>& all) {
    // X-keys send the unit's number, the program switch, and one byte per column.
    all.push_back(withControls("xkeys_4", "X-keys XK-4 Stick", {{0x05f3, 0x0467}, {0x05f3, 0x0469}}, keys({{0, 16, 1, 8, 4}}),
                               stickLamps(4)));
    all.push_back(withControls("xkeys_8", "X-keys XK-8 Stick", {{0x05f3, 0x046a}, {0x05f3, 0x046c}},
                               keys({{0, 16, 1, 8, 4}, {0, 17, 1, 8, 4}}), stickLamps(8)));
    all.push_back(withControls("xkeys_16", "X-keys XK-16 Stick",
                               {{0x05f3, 0x0419}, {0x05f3, 0x041b}, {0x05f3, 0x04bd}, {0x05f3, 0x04c0}},
                               keys({{0, 16, 1, 8, 4}, {0, 17, 1, 8, 4}, {0, 18, 1, 8, 4}, {0, 19, 1, 8, 4}}), stickLamps(16)));
    XkeysLamps blueAndRed = stickLamps(24);
    blueAndRed.red = 32;
    all.push_back(withControls("xkeys_24", "X-keys XK-24", {{0x05f3, 0x0403}, {0x05f3, 0x0405}},
                               keys({{0, 16, 1, 1, 6}, {0, 24, 1, 1, 6}, {0, 32, 1, 1, 6}, {0, 40, 1, 1, 6}}), blueAndRed));
    all.push_back(
        withControls("xkeys_pedal", "X-keys XK-3 Foot Pedal", {{0x05f3, 0x0438}, {0x05f3, 0x043a}}, keys({{0, 17, 1, 1, 3}})));
}

void addStreamDecks(std::vector<HidProfile>& all) {
    // Stream Decks send one byte per key. The first version counts each row from the right.
    all.push_back(withControls("stream_deck_original", "Elgato Stream Deck", {{0x0fd9, 0x0060}},
                               keys({{1, 40, 8, -8, 5}, {1, 80, 8, -8, 5}, {1, 120, 8, -8, 5}}),
                               StreamDeckLamps{Protocol::Original, 15, 5, {72, Coding::Bmp, Turn::Half}, 0}));
    all.push_back(withControls("stream_deck_mini", "Elgato Stream Deck Mini",
                               {{0x0fd9, 0x0063}, {0x0fd9, 0x0090}, {0x0fd9, 0x00b3}, {0x0fd9, 0x00b8}}, keys({{1, 8, 8, 8, 6}}),
                               StreamDeckLamps{Protocol::Mini, 6, 3, {80, Coding::Bmp, Turn::Transposed}, 0}));
    all.push_back(withControls("stream_deck", "Elgato Stream Deck",
                               {{0x0fd9, 0x006d}, {0x0fd9, 0x0080}, {0x0fd9, 0x00a5}, {0x0fd9, 0x00b9}},
                               keys({{1, 32, 8, 8, 15}}), deck(15, 72)));
    all.push_back(withControls("stream_deck_xl", "Elgato Stream Deck XL", {{0x0fd9, 0x006c}, {0x0fd9, 0x008f}, {0x0fd9, 0x00ba}},
                               keys({{1, 32, 8, 8, 32}}), deck(32, 96)));
    StreamDeckLamps neo = deck(8, 96);
    neo.colours = 2;
    all.push_back(withControls("stream_deck_neo", "Elgato Stream Deck Neo", {{0x0fd9, 0x009a}}, keys({{1, 32, 8, 8, 10}}), neo));
    all.push_back(
        withControls("stream_deck_plus", "Elgato Stream Deck +", {{0x0fd9, 0x0084}}, dialsAndStrip(), deck(8, 120, Turn::None)));
    all.push_back(withControls("stream_deck_pedal", "Elgato Stream Deck Pedal", {{0x0fd9, 0x0086}}, keys({{1, 32, 8, 8, 3}})));
}

void addByDescriptor(std::vector<HidProfile>& all) {
    // Descriptors name lamps, but not their purpose. So the Num Lock lamp serves as GO's only if
    // the site file asks for it.
    all.push_back({"number_pad",
                   "number pad",
                   {},
                   // Keypad Enter, 0, period, plus, minus, star, slash, then 1 to 9.
                   {0x00070058, 0x00070062, 0x00070063, 0x00070057, 0x00070056, 0x00070055, 0x00070054, 0x00070059, 0x0007005a,
                    0x0007005b, 0x0007005c, 0x0007005d, 0x0007005e, 0x0007005f, 0x00070060, 0x00070061},
                   {},
                   LedPageLamps{}});
    all.push_back({"lamps_by_descriptor", "device with lamps", {}, {}, {}, LedPageLamps{}});
}

std::vector<HidProfile> allProfiles() {
    std::vector<HidProfile> all;
    addPresenters(all);
    addShuttles(all);
    addXkeys(all);
    addStreamDecks(all);
    addByDescriptor(all);
    return all;
}

}  // namespace

std::span<const HidProfile> hidProfiles() {
    static const std::vector<HidProfile> all = allProfiles();
    return all;
}

const HidProfile* hidProfileOf(std::uint16_t vendor, std::uint16_t product) {
    for (const HidProfile& profile : hidProfiles())
        if (std::find(profile.devices.begin(), profile.devices.end(), std::pair(vendor, product)) != profile.devices.end())
            return &profile;
    return nullptr;
}

const HidProfile* hidProfileNamed(std::string_view name) {
    for (const HidProfile& profile : hidProfiles())
        if (profile.name == name) return &profile;
    return nullptr;
}

HidLayout layoutOf(const std::vector<HidInterface>& interfaces, const HidProfile* profile) {
    HidLayout layout;
    if (profile != nullptr && !profile->controls.empty()) {
        layout.controls = profile->controls;
        return layout;
    }
    layout.controls = controlsOf(interfaces);
    if (profile == nullptr) return layout;
    for (const HidUsage usage : profile->firstKeys) layout.firstKeys.push_back(buttonOf(layout.controls, usage));
    return layout;
}

}  // namespace fantascope::drivers
