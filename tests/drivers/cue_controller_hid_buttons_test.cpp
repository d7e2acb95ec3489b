#include "drivers/cue_controller/hid_buttons.h"
#include "drivers/cue_controller/hid_profile.h"
#include "drivers/cue_controller_devices.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>

namespace fantascope::drivers {
namespace {

using testing::IsEmpty;

std::vector<HidInterface> interfacesOf(const std::vector<std::vector<std::uint8_t>>& descriptors) {
    std::vector<HidInterface> interfaces;
    for (const auto& bytes : descriptors)
        interfaces.push_back({static_cast<int>(interfaces.size()), parseHidDescriptor(bytes).value()});
    return interfaces;
}

class Device {
public:
    explicit Device(const std::vector<std::vector<std::uint8_t>>& descriptors, const HidProfile* profile = nullptr)
        : layout_(layoutOf(interfacesOf(descriptors), profile)), buttons_(layout_) {}

    // The changes by a report: "+3" down, "-3" up, "~3" a detent.
    std::string after(std::string_view report, int interface = 0) {
        std::string changes;
        for (const auto& [button, what] : buttons_.take(interface, bytesOf(report)))
            changes += fmt::format("{}{}",
                                   what == ButtonChange::What::Down ? '+'
                                   : what == ButtonChange::What::Up ? '-'
                                                                    : '~',
                                   button);
        return changes;
    }
    std::string name(int button) const {
        for (const NamedButton& each : buttonsOf(layout_))
            if (each.number == button) return each.name;
        return "";
    }
    std::size_t count() const { return buttonsOf(layout_).size(); }

private:
    HidLayout layout_;
    HidButtons buttons_;
};

TEST(HidButtons, of_a_keyboard_are_its_modifiers_and_then_its_keys) {
    Device keyboard({kBootKeyboard});
    EXPECT_EQ(keyboard.count(), 8u + 98);
    EXPECT_EQ(keyboard.name(2), "left Shift");
    EXPECT_EQ(keyboard.name(9), "A");
    EXPECT_EQ(keyboard.after("02 00 04 00 00 00 00 00"), "+2+9");
    EXPECT_EQ(keyboard.after("02 00 04 05 00 00 00 00"), "+10");
    EXPECT_EQ(keyboard.after("02 00 05 00 00 00 00 00"), "-9") << "a key may change its place";
    EXPECT_EQ(keyboard.after("00 00 00 00 00 00 00 00"), "-2-10");
}

// Example failure: seven keys at once release all of them, and press them again.
TEST(HidButtons, stay_where_they_are_while_a_keyboard_cannot_tell) {
    Device keyboard({kBootKeyboard});
    EXPECT_EQ(keyboard.after("00 00 04 05 06 07 08 09"), "+9+10+11+12+13+14");
    EXPECT_EQ(keyboard.after("01 00 01 01 01 01 01 01"), "+1") << "modifiers have bits of their own";
    EXPECT_EQ(keyboard.after("00 00 04 00 00 00 00 00"), "-1-10-11-12-13-14");
}

TEST(HidButtons, of_a_mouse_are_its_keys_and_its_wheel_but_not_its_way) {
    Device mouse({kMouse});
    EXPECT_EQ(mouse.count(), 5u);
    EXPECT_EQ(mouse.name(4), "wheel on");
    EXPECT_EQ(mouse.after("01 14 ec 00"), "+1");
    EXPECT_EQ(mouse.after("01 00 00 02"), "~4~4");
    EXPECT_EQ(mouse.after("00 00 00 ff"), "-1~5");
}

TEST(HidButtons, of_several_interfaces_are_numbered_one_interface_after_the_other) {
    Device presenter({kBootKeyboard, kPresenterConsumer, kMouse});
    const int consumer = 8 + 98, system = consumer + 0x28c, mouse = system + 3;
    EXPECT_EQ(presenter.count(), static_cast<std::size_t>(mouse + 5));
    EXPECT_EQ(presenter.after("03 e9 00 00 00", 1), fmt::format("+{}", consumer + 0xe9));
    EXPECT_EQ(presenter.name(consumer + 0xe9), "volume up");
    EXPECT_EQ(presenter.after("03 ea 00 e9 00", 1), fmt::format("+{}", consumer + 0xea));
    EXPECT_EQ(presenter.after("03 00 00 00 00", 1), fmt::format("-{}-{}", consumer + 0xe9, consumer + 0xea));
    EXPECT_EQ(presenter.after("04 02", 1), fmt::format("+{}", system + 2));
    EXPECT_EQ(presenter.after("04 00", 1), fmt::format("-{}", system + 2));
    EXPECT_EQ(presenter.after("04 00 00 00", 2), fmt::format("+{}", mouse + 3));
}

TEST(HidButtons, of_a_presenter_are_the_same_on_every_one) {
    const HidProfile* const profile = hidProfileOf(0x046d, 0xc52d);
    ASSERT_NE(profile, nullptr);
    Device presenter({kBootKeyboard, kPresenterConsumer}, profile), plain({kFootPedal}, hidProfileNamed("presenter"));
    for (Device* device : {&presenter, &plain}) {
        EXPECT_EQ(device->name(1), "Page Down");
        EXPECT_EQ(device->name(2), "Page Up");
        EXPECT_EQ(device->name(6), "B");
    }
    EXPECT_EQ(presenter.after("00 00 4e 00 00 00 00 00"), "+1");
    EXPECT_EQ(presenter.after("00 00 4b 00 00 00 00 00"), "-1+2");
    EXPECT_EQ(presenter.after("03 e9 00 00 00", 1), "+9");
    EXPECT_EQ(plain.after("01 00 00 4e 00 00 00 00 00"), "+1");
    EXPECT_EQ(plain.name(9), "") << "it has no volume; the number stays free";
    EXPECT_EQ(plain.name(11), "left Control") << "then come the others";
    EXPECT_EQ(presenter.count(), 8u + 98 + 0x28c + 3) << "none is lost and none is there twice";
}

TEST(HidButtons, of_a_gamepad_are_its_keys_then_its_hat_then_its_axes) {
    Device pad({kDualShock4});
    EXPECT_EQ(pad.count(), 14u + 4 + 2 * 6);
    EXPECT_EQ(pad.name(14), "button 14");
    EXPECT_EQ(pad.name(15), "hat up");
    EXPECT_EQ(pad.name(19), "X high");
    EXPECT_EQ(pad.name(20), "X low");
    const auto report = [](std::string_view head) {
        std::string bytes(head);
        for (int i = 0; i < 54; ++i) bytes += " a5";
        return bytes;
    };
    EXPECT_EQ(pad.after(report("01 80 80 80 80 08 00 00 80 80")), "") << "a pad at rest; triggers in the middle, for the test";
    EXPECT_EQ(pad.after(report("01 80 80 80 80 28 00 00 80 80")), "+2");
    EXPECT_EQ(pad.after(report("01 80 80 80 80 01 00 00 80 80")), "-2+15+16") << "up and right";
    EXPECT_EQ(pad.after(report("01 80 80 80 80 02 00 00 80 80")), "-15");
    EXPECT_EQ(pad.after(report("01 80 80 80 80 07 00 00 80 80")), "-16+15+18") << "up and left";
    EXPECT_EQ(pad.after(report("01 ff 80 80 80 08 00 00 80 80")), "-15-18+19");
    EXPECT_EQ(pad.after(report("01 00 80 80 80 08 00 00 80 80")), "-19+20");
    EXPECT_EQ(pad.after("01 80 80 80 80 08 00 00 80"), "") << "a report that is cut off is none";
    EXPECT_EQ(pad.after("05 80 80 80 80 08 00 00 80 80"), "") << "nor is one of another id";
}

// A hand that holds a stick at the edge must not press many times.
TEST(HidButtons, of_an_axis_are_left_at_another_place_than_reached) {
    Device pad({kDualShock4});
    const auto x = [&](int value) {
        std::string bytes = fmt::format("01 {:02x} 80 80 80 08 00 00 80 80", value);
        for (int i = 0; i < 54; ++i) bytes += " 00";
        return pad.after(bytes);
    };
    EXPECT_EQ(x(190), "");
    EXPECT_EQ(x(192), "+19");
    EXPECT_EQ(x(190), "");
    EXPECT_EQ(x(192), "");
    EXPECT_EQ(x(160), "");
    EXPECT_EQ(x(159), "-19");
    EXPECT_EQ(x(190), "");
}

TEST(HidButtons, of_a_hat_that_counts_from_one_has_its_rest_at_zero) {
    Device pad({kXboxGamepad});
    const std::string head = "01 00 80 00 80 00 80 00 80 00 02 00 02 ";
    EXPECT_EQ(pad.count(), 10u + 1 + 4 + 12);
    EXPECT_EQ(pad.after(head + "00 00 00"), "");
    EXPECT_EQ(pad.after(head + "01 00 00"), "+12") << "ten buttons, the system's, then up";
    EXPECT_EQ(pad.after(head + "05 00 00"), "-12+14");
    EXPECT_EQ(pad.after(head + "00 01 02"), "-14+1+10");
    EXPECT_EQ(pad.after("02 01"), "+11");
}

// A six-axis knob has no detents, whatever its descriptor says, and it exceeds its declared range.
TEST(HidButtons, of_a_knob_that_springs_back_are_its_directions) {
    Device knob({kSpaceNavigator});
    EXPECT_EQ(knob.count(), 2u + 12);
    EXPECT_EQ(knob.after("01 00 00 00 00 00 00"), "");
    EXPECT_EQ(knob.after("01 2c 01 00 00 00 00"), "+3") << "X at 300";
    EXPECT_EQ(knob.after("01 2c 01 00 00 00 00"), "");
    EXPECT_EQ(knob.after("01 f4 01 00 00 00 00"), "") << "at 500";
    EXPECT_EQ(knob.after("02 00 00 00 00 0c fe"), "+14") << "Rz at -500";
    EXPECT_EQ(knob.after("01 00 00 00 00 00 00"), "-3");
    EXPECT_EQ(knob.after("03 03 00"), "+1+2");
}

TEST(HidButtons, of_a_jog_wheel_are_its_detents_the_shorter_way_round) {
    Device shuttle({kShuttleXpress}, hidProfileOf(0x0b33, 0x0020));
    EXPECT_EQ(shuttle.count(), 5u + 2 + 2);
    EXPECT_EQ(shuttle.name(6), "jog on");
    EXPECT_EQ(shuttle.name(8), "shuttle high");
    EXPECT_EQ(shuttle.after("00 fe 00 00 00"), "") << "where it stands is no turn";
    EXPECT_EQ(shuttle.after("00 01 00 00 00"), "~6~6~6");
    EXPECT_EQ(shuttle.after("00 ff 00 10 00"), "+1~7~7");
    EXPECT_EQ(shuttle.after("00 ff 00 00 01"), "-1+5");
    EXPECT_EQ(shuttle.after("07 ff 00 00 00"), "-5+8");
    EXPECT_EQ(shuttle.after("00 ff 00 00 00"), "-8");
    EXPECT_EQ(shuttle.after("f9 ff 00 00 00"), "+9");
}

// Without its profile the dial is recognised by its wrap.
TEST(HidButtons, of_a_dial_that_wraps_are_its_detents) {
    Device shuttle({kShuttleXpress});
    EXPECT_EQ(shuttle.count(), 13u + 2 + 2);
    EXPECT_EQ(shuttle.after("00 05 00 00 00"), "");
    EXPECT_EQ(shuttle.after("00 06 00 00 00"), "~16") << "thirteen buttons, the wheel, the dial";
    EXPECT_EQ(shuttle.after("00 05 00 10 00"), "+5~17");
}

TEST(HidButtons, of_a_turning_knob_are_its_detents) {
    Device knob({kPowerMate});
    EXPECT_EQ(knob.count(), 3u);
    EXPECT_EQ(knob.after("01 00 00 80 00 00"), "+1");
    EXPECT_EQ(knob.after("01 03 00 80 00 00"), "~2~2~2");
    EXPECT_EQ(knob.after("00 fe 00 80 00 00"), "-1~3~3");
}

TEST(HidButtons, of_a_stick_of_keys_come_from_its_profile) {
    EXPECT_EQ(Device({kXkeys}).count(), 0u) << "its descriptor says nothing";
    Device stick({kXkeys}, hidProfileOf(0x05f3, 1049));
    EXPECT_EQ(stick.count(), 16u);
    EXPECT_EQ(stick.after("00 00 01 00 00 00"), "+1");
    EXPECT_EQ(stick.after("00 00 01 01 00 00"), "+2");
    EXPECT_EQ(stick.after("00 00 02 00 00 08"), "-1-2+5+16");
}

TEST(HidButtons, of_a_key_pad_come_from_its_profile) {
    Device pad({kStreamDeck}, hidProfileOf(0x0fd9, 0x0080)), first({kStreamDeck}, hidProfileOf(0x0fd9, 0x0060));
    EXPECT_EQ(pad.count(), 15u);
    EXPECT_EQ(pad.after("01 00 0f 00 01 00 00 00 00 00 00 00 00 00 00 00 00 00 01"), "+1+15");
    EXPECT_EQ(pad.after("01 00 0f 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 01"), "-1");
    EXPECT_EQ(pad.after("02 00 0f 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00"), "") << "another report";
    EXPECT_EQ(first.after("01 01 00 00 00 00 00 00 00 00 00 01 00 00 00 00"), "+5+15") << "its rows run from the right";
}

// https://docs.elgato.com/streamdeck/hid/stream-deck-plus: one id for keys, dials and the strip;
// byte 1 says which.
TEST(HidButtons, of_a_pad_with_dials_are_its_keys_then_its_dials_then_its_strip) {
    Device pad({kStreamDeck}, hidProfileOf(0x0fd9, 0x0084));
    EXPECT_EQ(pad.count(), 8u + 4 + 2 * 4 + 4);
    EXPECT_EQ(pad.name(9), "dial 1");
    EXPECT_EQ(pad.name(13), "dial 1 on");
    EXPECT_EQ(pad.name(14), "dial 1 back");
    EXPECT_EQ(pad.name(24), "strip above dial 4");
    EXPECT_EQ(pad.after("01 00 08 00 00 00 00 00 00 00 00 01"), "+8");
    EXPECT_EQ(pad.after("01 03 05 00 01 02 00 00 ff 00 00 00"), "~13~13~20") << "two on at the first dial, one back at the last";
    EXPECT_EQ(pad.after("01 03 05 00 00 00 01 00 00 00 00 00"), "+10") << "a dial is a key too";
    EXPECT_EQ(pad.after("01 03 05 00 01 00 01 00 00 00 00 00"), "~15") << "turned while it is held down";
    EXPECT_EQ(pad.after("01 03 05 00 00 00 00 00 00 00 00 00"), "-10");
    EXPECT_EQ(pad.after("01 02 0a 00 01 00 00 00 32 00 00 00"), "~21") << "the strip at its left end";
    EXPECT_EQ(pad.after("01 02 0a 00 02 00 1f 03 32 00 00 00"), "~24") << "for long, at 799";
    EXPECT_EQ(pad.after("01 02 0e 00 03 00 64 00 32 00 90 01"), "") << "a finger in passing";
    EXPECT_EQ(pad.after("01 00 08 00 00 00 00 00 00 00 00 00"), "-8") << "none of all this let go of the key";
}

TEST(HidButtons, of_a_number_pad_begin_with_the_largest_key) {
    Device pad({kBootKeyboard}, hidProfileNamed("number_pad"));
    EXPECT_EQ(pad.name(1), "keypad Enter");
    EXPECT_EQ(pad.name(2), "keypad 0");
    EXPECT_EQ(pad.name(16), "keypad 9");
    EXPECT_EQ(pad.after("00 00 58 00 00 00 00 00"), "+1");
    EXPECT_EQ(pad.after("00 00 62 00 00 00 00 00"), "-1+2");
}

// A vendor's own bits are buttons, too; its bytes are not, because they could be anything.
TEST(HidButtons, of_an_unknown_device_are_its_bits) {
    Device box({bytesOf(
        "06 00 ff 09 01 a1 01 09 10 09 11 15 00 25 01 75 01 95 02 81 02 95 06 81 03 09 20 26 ff 00 75 08 95 03 81 02 09 30 "
        "95 04 81 00 c0")});
    EXPECT_EQ(box.count(), 2u);
    EXPECT_EQ(box.after("02 ff ff ff 00 01 02 03"), "+2");
    EXPECT_EQ(box.name(2), "usage 0xff00 0x11");
}

// Some count their buttons from 0, and some report how hard they are pressed.
TEST(HidButtons, of_the_button_page_count_however_they_are_written) {
    Device box(
        {bytesOf("05 01 09 04 a1 01 05 09 19 00 29 07 15 00 25 01 75 01 95 08 81 02 19 01 29 02 26 ff 00 75 08 95 02 81 02 c0")});
    EXPECT_EQ(box.count(), 10u);
    EXPECT_EQ(box.after("81 00 00"), "+1+8");
    EXPECT_EQ(box.after("81 90 00"), "+9");
    EXPECT_EQ(box.after("81 70 00"), "") << "no flutter in the middle";
    EXPECT_EQ(box.after("81 10 ff"), "-9+10");
}

// A device that declares more keys than there are usages has none of the surplus; the numbers stay
// valid.
TEST(HidButtons, have_an_end) {
    std::vector<std::uint8_t> bytes = bytesOf("05 01 09 06 a1 01 15 00 26 ff 00 75 08 95 01 05 0c");
    for (int array = 0; array < 40; ++array) {
        const auto keys = bytesOf("1b 01 00 0c 00 2b 00 40 0c 00 81 00");
        bytes.insert(bytes.end(), keys.begin(), keys.end());
    }
    bytes.push_back(0xc0);
    const auto controls = controlsOf(interfacesOf({bytes}));
    EXPECT_EQ(controls.size(), 3u);
    EXPECT_LT(HidLayout({controls, {}}).count(), 1 << 16);
}

TEST(HidProfiles, have_names_that_are_one_word_and_devices_of_their_own) {
    std::set<std::pair<int, int>> devices;
    for (const HidProfile& profile : hidProfiles()) {
        EXPECT_EQ(profile.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"), std::string_view::npos)
            << profile.name;
        EXPECT_EQ(hidProfileNamed(profile.name), &profile);
        EXPECT_TRUE(profile.firstKeys.empty() || profile.controls.empty()) << profile.name;
        EXPECT_FALSE(profile.firstKeys.empty() && profile.controls.empty() &&
                     std::holds_alternative<std::monostate>(profile.lamps))
            << profile.name;
        for (const auto& device : profile.devices) EXPECT_TRUE(devices.insert(device).second) << profile.name;
    }
}

}  // namespace
}  // namespace fantascope::drivers
