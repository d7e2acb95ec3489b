#pragma once
// The report descriptors of real devices, from public sources. Each names its source, and whether
// it is complete or only has the described shape. None was read from a device at hand.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fantascope::drivers {

// "05 01 09 06": bytes in the usual notation for descriptors.
inline std::vector<std::uint8_t> bytesOf(std::string_view text) {
    std::vector<std::uint8_t> bytes;
    int digits = 0, value = 0;
    for (const char letter : text) {
        if (letter == ' ' || letter == '\n') continue;
        value = value * 16 + (letter <= '9' ? letter - '0' : (letter | 0x20) - 'a' + 10);
        if (++digits % 2 != 0) continue;
        bytes.push_back(static_cast<std::uint8_t>(value));
        value = 0;
    }
    return bytes;
}

// HID 1.11, appendix B.1 and E.6: modifiers, lamps, six keys.
inline const std::vector<std::uint8_t> kBootKeyboard = bytesOf(
    "05 01 09 06 a1 01 05 07 19 e0 29 e7 15 00 25 01 75 01 95 08 81 02 95 01 75 08 81 01 95 05 75 01 05 08 19 01 29 05 91 02 95 "
    "01 75 03 "
    "91 01 95 06 75 08 15 00 25 65 05 07 19 00 29 65 81 00 c0");

// HID 1.11, appendix B.2 and E.10, with the usual wheel: three buttons, X, Y, wheel. Like a
// Logitech USB Optical Mouse (046d:c077), https://github.com/libusb/hidapi/pull/306.
inline const std::vector<std::uint8_t> kMouse = bytesOf(
    "05 01 09 02 a1 01 09 01 a1 00 05 09 19 01 29 03 15 00 25 01 75 01 95 03 81 02 75 05 95 01 81 03 05 01 09 30 09 31 09 38 15 "
    "81 25 7f "
    "75 08 95 03 81 06 c0 c0");

// The shape of a presenter's second interface: consumer control with an array of two-byte usages up
// to 0x28c, and system control with three usages, as in Logitech's receivers (Linux,
// drivers/hid/hid-logitech-dj.c, consumer_descriptor and syscontrol_descriptor).
inline const std::vector<std::uint8_t> kPresenterConsumer = bytesOf(
    "05 0c 09 01 a1 01 85 03 75 10 95 02 15 01 26 8c 02 19 01 2a 8c 02 81 00 c0 05 01 09 80 a1 01 85 04 75 02 95 01 15 01 25 03 "
    "09 82 09 "
    "81 09 83 81 60 75 06 81 03 c0");

// Sony DualShock 4 (054c:09cc): its input report as https://github.com/fraca7/dsremap (DS4HID.h)
// and Linux's hid-playstation have it, and the first of its many vendor reports.
inline const std::vector<std::uint8_t> kDualShock4 = bytesOf(
    "05 01 09 05 a1 01 85 01 09 30 09 31 09 32 09 35 15 00 26 ff 00 75 08 95 04 81 02 09 39 15 00 25 07 35 00 46 3b 01 65 14 75 "
    "04 95 01 "
    "81 42 65 00 05 09 19 01 29 0e 15 00 25 01 75 01 95 0e 81 02 06 00 ff 09 20 75 06 95 01 15 00 25 7f 81 02 05 01 09 33 09 34 "
    "15 00 26 "
    "ff 00 75 08 95 02 81 02 06 00 ff 09 21 95 36 81 02 85 05 09 22 95 1f 91 02 85 04 09 23 95 24 b1 02 c0");

// The shape of an Xbox controller over HID (https://github.com/DJm00n/ControllersInfo): sticks of
// 16 bits in physical collections, triggers of 10 bits with padding, a hat from 1 to 8 with a null
// state, ten buttons and one of the system.
inline const std::vector<std::uint8_t> kXboxGamepad = bytesOf(
    "05 01 09 05 a1 01 85 01 09 01 a1 00 09 30 09 31 15 00 27 ff ff 00 00 95 02 75 10 81 02 c0 09 01 a1 00 09 33 09 34 15 00 27 "
    "ff ff 00 "
    "00 95 02 75 10 81 02 c0 05 01 09 32 15 00 26 ff 03 95 01 75 0a 81 02 15 00 25 00 75 06 95 01 81 03 05 01 09 35 15 00 26 ff "
    "03 95 01 "
    "75 0a 81 02 15 00 25 00 75 06 95 01 81 03 05 01 09 39 15 01 25 08 35 00 46 3b 01 66 14 00 75 04 95 01 81 42 75 04 95 01 15 "
    "00 25 00 "
    "35 00 45 00 65 00 81 03 05 09 19 01 29 0a 15 00 25 01 75 01 95 0a 81 02 15 00 25 00 75 06 95 01 81 03 05 01 09 80 85 02 a1 "
    "00 09 85 "
    "15 00 25 01 95 01 75 01 81 02 15 00 25 00 75 07 95 01 81 03 c0 c0");

// Contour ShuttleXpress (0b33:0020): a wheel and a dial declared as relative, a spare byte,
// thirteen buttons, from the input capabilities that Windows lists
// (https://github.com/EMATech/ContourShuttle).
inline const std::vector<std::uint8_t> kShuttleXpress = bytesOf(
    "05 0c 09 01 a1 01 a1 02 05 01 09 38 15 80 25 7f 75 08 95 01 81 06 09 37 15 00 26 ff 00 75 08 95 01 81 2e 75 08 95 01 81 03 "
    "05 09 19 "
    "01 29 0d 15 00 25 01 75 01 95 0d 81 02 75 03 95 01 81 03 c0 c0");

// 3Dconnexion SpaceNavigator (046d:c626), complete:
// https://libevdev.pages.freedesktop.org/udev-hid-bpf, its case study. Six axes in two reports,
// wrongly declared as relative, two buttons, a lamp.
inline const std::vector<std::uint8_t> kSpaceNavigator = bytesOf(
    "05 01 09 08 a1 01 a1 00 85 01 16 a2 fe 26 5e 01 36 88 fa 46 78 05 55 0c 65 11 09 30 09 31 09 32 75 10 95 03 81 06 c0 a1 00 "
    "85 02 09 "
    "33 09 34 09 35 75 10 95 03 81 06 c0 a1 02 85 03 05 01 05 09 19 01 29 02 15 00 25 01 35 00 45 01 75 01 95 02 81 02 95 0e 81 "
    "03 c0 a1 "
    "02 85 04 05 08 09 4b 15 00 25 01 95 01 75 01 91 02 95 01 75 07 91 03 c0 06 00 ff 09 01 a1 02 15 80 25 7f 75 08 09 3a a1 02 "
    "85 05 09 "
    "20 95 01 b1 02 c0 a1 02 85 06 09 21 95 01 b1 02 c0 a1 02 85 07 09 22 95 01 b1 02 c0 a1 02 85 08 09 23 95 07 b1 02 c0 a1 02 "
    "85 09 09 "
    "24 95 07 b1 02 c0 a1 02 85 0a 09 25 95 07 b1 02 c0 a1 02 85 0b 09 26 95 01 b1 02 c0 a1 02 85 13 09 2e 95 01 b1 02 c0 a1 02 "
    "85 19 09 "
    "31 95 04 b1 02 c0 c0 c0");

// A foot pedal of PCsensor's kind (1a86:e026): a keyboard with report ids beside a mouse and a
// gamepad, in the shape listed at
// https://gitlab.freedesktop.org/libevdev/udev-hid-bpf/-/merge_requests/102.
inline const std::vector<std::uint8_t> kFootPedal = bytesOf(
    "05 01 09 06 a1 01 85 01 05 07 19 e0 29 e7 15 00 25 01 75 01 95 08 81 02 95 01 75 08 81 01 95 03 75 01 05 08 19 01 29 03 91 "
    "02 95 05 "
    "75 01 91 01 95 06 75 08 15 00 26 ff 00 05 07 19 00 29 91 81 00 c0 05 01 09 02 a1 01 85 02 09 01 a1 00 05 09 19 01 29 05 15 "
    "00 25 01 "
    "95 05 75 01 81 02 95 01 75 03 81 01 05 01 09 30 09 31 09 38 15 81 25 7f 75 08 95 03 81 06 c0 c0");

// Griffin PowerMate (077d:0410): the six bytes that Linux's powermate driver reads
// (drivers/input/misc/powermate.c): a button, a turn, four bytes of lamp state. Its descriptor is
// not published; this one declares the same.
inline const std::vector<std::uint8_t> kPowerMate = bytesOf(
    "05 0c 09 01 a1 01 05 09 09 01 15 00 25 01 75 01 95 01 81 02 75 07 95 01 81 03 05 01 09 37 15 81 25 7f 75 08 95 01 81 06 06 "
    "00 ff 09 "
    "01 15 00 26 ff 00 75 08 95 04 81 02 c0");

// X-keys sticks (P.I. Engineering): 32 vendor bytes without an id, and 35 for lamps, which no
// descriptor explains (https://github.com/Xkeys-Lib/xkeys, products). Only the lengths are real.
inline const std::vector<std::uint8_t> kXkeys =
    bytesOf("06 00 ff 09 01 a1 01 09 01 15 00 26 ff 00 75 08 95 20 81 02 09 02 95 23 91 02 c0");

// Elgato Stream Decks: bytes on the button page after id 1
// (https://docs.elgato.com/streamdeck/hid); 511 of them from the second version on.
inline const std::vector<std::uint8_t> kStreamDeck = bytesOf(
    "05 0c 09 01 a1 01 09 01 05 09 19 01 29 10 15 00 26 ff 00 75 08 96 ff 01 85 01 81 02 0a 00 ff 96 ff 03 85 02 91 02 c0");

}  // namespace fantascope::drivers
