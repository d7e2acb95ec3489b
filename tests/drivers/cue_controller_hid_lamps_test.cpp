#include "drivers/cue_controller/button_lights.h"
#include "drivers/cue_controller/hid_lamps.h"
#include "drivers/cue_controller/hid_profile.h"

#include "cue_controller_devices.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace fantascope::drivers {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;
using enum ButtonLight::State;
using Bytes = std::vector<std::uint8_t>;

std::unique_ptr<HidLamps> lampsOfDevice(std::uint16_t vendor, std::uint16_t product) {
    return lampsOf(hidProfileOf(vendor, product)->lamps, {});
}

Bytes padded(Bytes bytes, std::size_t size) {
    bytes.resize(size);
    return bytes;
}
std::vector<Bytes> wireOf(const std::vector<HidOutReport>& reports) {
    std::vector<Bytes> all;
    for (const HidOutReport& report : reports) all.push_back(report.bytes);
    return all;
}

// The commands and indices of P.I. Engineering's data report of the XK-16, XK-8 and XK-4 Stick.
TEST(XkeysLamps, of_a_stick_are_blue_and_go_by_columns_of_six) {
    const auto stick = lampsOfDevice(0x05f3, 1049);
    ASSERT_EQ(stick->count(), 16);
    EXPECT_THAT(wireOf(stick->begin(0.5)), ElementsAre(padded({187, 128, 0}, 35)));
    const auto index = [&](int button) { return stick->show(button, {Ready, ""}).at(0).bytes.at(1); };
    EXPECT_THAT((std::array{index(1), index(6), index(7), index(12), index(13), index(16)}), ElementsAre(0, 5, 8, 13, 16, 19));
    EXPECT_THAT(wireOf(stick->show(7, {Ready, "GO"})), ElementsAre(padded({181, 8, 1, 1}, 35)));
    EXPECT_THAT(wireOf(stick->show(7, {Active, ""})), ElementsAre(padded({181, 8, 2, 1}, 35)));
    EXPECT_THAT(wireOf(stick->show(7, {Alarm, ""})), ElementsAre(padded({181, 8, 2, 1}, 35)));
    EXPECT_THAT(wireOf(stick->show(7, {Off, "GO"})), ElementsAre(padded({181, 8, 0, 1}, 35)));
    EXPECT_THAT(stick->show(0, {Ready, ""}), IsEmpty());
    EXPECT_THAT(stick->show(17, {Ready, ""}), IsEmpty());
    EXPECT_FALSE(stick->show(1, {Ready, ""}).at(0).feature);
    EXPECT_EQ(stick->show(1, {Ready, ""}).at(0).id, 0);
}

// Blue 0 to 29, red 32 higher: from its data report.
TEST(XkeysLamps, of_a_panel_are_blue_and_red) {
    const auto panel = lampsOfDevice(0x05f3, 0x0405);
    ASSERT_EQ(panel->count(), 24);
    EXPECT_THAT(wireOf(panel->show(8, {Ready, ""})), ElementsAre(padded({181, 9, 1, 1}, 35), padded({181, 41, 0, 1}, 35)));
    EXPECT_THAT(wireOf(panel->show(8, {Active, ""})), ElementsAre(padded({181, 9, 2, 1}, 35), padded({181, 41, 0, 1}, 35)));
    EXPECT_THAT(wireOf(panel->show(24, {Alarm, ""})), ElementsAre(padded({181, 29, 0, 1}, 35), padded({181, 61, 1, 1}, 35)));
    EXPECT_THAT(wireOf(panel->show(24, {Off, ""})), ElementsAre(padded({181, 29, 0, 1}, 35), padded({181, 61, 0, 1}, 35)));
}

// The contents of a picture's reports: their headers, and the file after them.
struct Sent {
    std::vector<Bytes> heads;
    Bytes file;
};
Sent pictureIn(const std::vector<HidOutReport>& reports, std::size_t head, std::size_t fileBytes) {
    Sent sent;
    for (const HidOutReport& report : reports) {
        sent.heads.emplace_back(report.bytes.begin(), report.bytes.begin() + static_cast<std::ptrdiff_t>(head));
        // The length is in the header, or follows from the file's.
        const std::size_t rest = fileBytes == 0 ? report.bytes.at(4) + 256u * report.bytes.at(5)
                                                : std::min(fileBytes - sent.file.size(), report.bytes.size() - head);
        const auto from = report.bytes.begin() + static_cast<std::ptrdiff_t>(head);
        sent.file.insert(sent.file.end(), from, from + static_cast<std::ptrdiff_t>(rest));
    }
    return sent;
}

cv::Mat decoded(const Bytes& file) { return cv::imdecode(file, cv::IMREAD_COLOR); }

// An "L" has ink at the left, up to the top, and at the bottom right; none at the top right. White
// on green, so blue shows the ink.
bool isUpright(const cv::Mat& picture) {
    const int side = picture.cols;
    int topLeft = 0, topRight = 0, bottomRight = 0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            if (picture.at<cv::Vec3b>(y, x)[0] < 200) continue;
            const bool top = y < side / 2, left = x < side / 2;
            (top ? left ? topLeft : topRight : left ? topLeft : bottomRight) += 1;
        }
    return topLeft > 20 && bottomRight > 5 && topRight == 0;
}

TEST(StreamDeckLamps, begin_with_an_empty_report_and_the_brightness) {
    const auto deck = lampsOfDevice(0x0fd9, 0x0080), first = lampsOfDevice(0x0fd9, 0x0060);
    const auto begun = deck->begin(0.5), begunFirst = first->begin(1);
    EXPECT_THAT(wireOf(begun), ElementsAre(padded({2}, 1024), padded({3, 8, 50}, 32)));
    EXPECT_THAT(wireOf(begunFirst), ElementsAre(padded({2}, 8191), padded({5, 0x55, 0xaa, 0xd1, 1, 100}, 17)));
    EXPECT_FALSE(begun[0].feature);
    EXPECT_EQ(begun[0].id, 2);
    EXPECT_TRUE(begun[1].feature);
    EXPECT_EQ(begun[1].id, 3);
}

TEST(StreamDeckLamps, since_the_second_version_are_jpeg_files_in_reports_that_count_their_bytes) {
    const auto deck = lampsOfDevice(0x0fd9, 0x0080);
    ASSERT_EQ(deck->count(), 15);
    const auto reports = deck->show(13, {Ready, "L"});
    ASSERT_GT(reports.size(), 1u);
    const Sent sent = pictureIn(reports, 8, 0);
    for (std::size_t page = 0; page < reports.size(); ++page) {
        EXPECT_EQ(reports[page].bytes.size(), 1024u);
        const bool last = page + 1 == reports.size();
        const std::size_t count = last ? sent.file.size() - page * 1016 : 1016;
        EXPECT_THAT(sent.heads[page], ElementsAre(2, 7, 12, last, count & 0xff, count >> 8, page, 0));
    }
    EXPECT_EQ(sent.file[0], 0xff);
    EXPECT_EQ(sent.file[1], 0xd8);
    cv::Mat picture = decoded(sent.file);
    ASSERT_EQ(picture.size(), cv::Size(72, 72));
    EXPECT_FALSE(isUpright(picture));
    cv::flip(picture, picture, -1);
    EXPECT_TRUE(isUpright(picture)) << "its display hangs upside down";
}

TEST(StreamDeckLamps, have_the_size_and_the_way_up_of_their_model) {
    struct Model {
        std::uint16_t product;
        int keys, side;
        bool hangsUpsideDown;
    };
    for (const auto& [product, keys, side, upsideDown] :
         {Model{0x006d, 15, 72, true}, {0x006c, 32, 96, true}, {0x009a, 10, 96, true}, {0x0084, 8, 120, false}}) {
        const auto deck = lampsOfDevice(0x0fd9, product);
        EXPECT_EQ(deck->count(), keys) << product;
        cv::Mat picture = decoded(pictureIn(deck->show(1, {Ready, "L"}), 8, 0).file);
        ASSERT_EQ(picture.size(), cv::Size(side, side)) << product;
        if (upsideDown) cv::flip(picture, picture, -1);
        EXPECT_TRUE(isUpright(picture)) << product;
    }
}

TEST(StreamDeckLamps, of_touch_keys_are_colours_in_a_feature_report) {
    const auto neo = lampsOfDevice(0x0fd9, 0x009a);
    const auto off = neo->show(10, {Off, "GO"}), alarm = neo->show(9, {Alarm, ""});
    EXPECT_THAT(wireOf(off), ElementsAre(padded({3, 6, 9}, 32)));
    ASSERT_THAT(alarm, SizeIs(1));
    EXPECT_TRUE(alarm[0].feature);
    EXPECT_EQ(alarm[0].bytes[2], 8);
    EXPECT_GT(alarm[0].bytes[3], 128) << "red";
    EXPECT_EQ(alarm[0].bytes[4], 0);
}

// https://gist.github.com/cliffrowley/d18a9c4569537b195f2b1eb6c68469e0 has the file's header as
// sent by Elgato's own program.
TEST(StreamDeckLamps, of_the_first_one_are_bmp_files_in_two_halves_with_the_keys_counted_from_the_right) {
    const auto first = lampsOfDevice(0x0fd9, 0x0060);
    const auto reports = first->show(6, {Ready, "L"});  // the leftmost key of the second row
    ASSERT_THAT(reports, SizeIs(2));
    EXPECT_THAT(reports, Each(testing::Field(&HidOutReport::bytes, SizeIs(8191))));
    const auto head = [&](std::size_t report) {
        return Bytes(reports[report].bytes.begin(), reports[report].bytes.begin() + 16);
    };
    EXPECT_EQ(head(0), padded({2, 1, 1, 0, 0, 10}, 16));
    EXPECT_EQ(head(1), padded({2, 1, 2, 0, 1, 10}, 16));
    Bytes file;
    for (const HidOutReport& report : reports)
        file.insert(file.end(), report.bytes.begin() + 16, report.bytes.begin() + 16 + 7803);
    EXPECT_EQ(
        Bytes(file.begin(), file.begin() + 54),
        bytesOf("42 4D F6 3C 00 00 00 00 00 00 36 00 00 00 28 00 00 00 48 00 00 00 48 00 00 00 01 00 18 00 00 00 00 00 C0 3C 00 "
                "00 C4 0E 00 00 C4 0E 00 00 00 00 00 00 00 00 00 00"));
    cv::Mat picture = decoded(file);
    ASSERT_EQ(picture.size(), cv::Size(72, 72));
    cv::flip(picture, picture, -1);
    EXPECT_TRUE(isUpright(picture));
}

// Boatswain's doc/stream-deck.md: mirrored and rotated by 90 degrees.
TEST(StreamDeckLamps, of_the_mini_are_bmp_files_on_their_side) {
    const auto mini = lampsOfDevice(0x0fd9, 0x0063);
    ASSERT_EQ(mini->count(), 6);
    const auto reports = mini->show(6, {Ready, "L"});
    constexpr std::size_t kFile = 54 + 80 * 80 * 3;
    ASSERT_THAT(reports, SizeIs((kFile + 1007) / 1008));
    const Sent sent = pictureIn(reports, 16, kFile);
    for (std::size_t page = 0; page < reports.size(); ++page) {
        EXPECT_EQ(reports[page].bytes.size(), 1024u);
        const auto number = static_cast<std::uint8_t>(page);
        EXPECT_EQ(sent.heads[page], padded({2, 1, number, 0, page + 1 == reports.size(), 6}, 16));
    }
    cv::Mat picture = decoded(sent.file);
    ASSERT_EQ(picture.size(), cv::Size(80, 80));
    EXPECT_FALSE(isUpright(picture));
    cv::flip(picture, picture, 0);
    cv::rotate(picture, picture, cv::ROTATE_90_CLOCKWISE);
    EXPECT_TRUE(isUpright(picture));
}

TEST(LedPageLamps, are_the_outputs_that_a_descriptor_calls_lamps_in_their_order) {
    const auto interfaces = std::vector<HidInterface>{{2, parseHidDescriptor(kBootKeyboard).value()}};
    const auto keyboard = lampsOf(hidProfileNamed("number_pad")->lamps, interfaces);
    ASSERT_NE(keyboard, nullptr);
    EXPECT_EQ(keyboard->count(), 5) << "Num, Caps and Scroll Lock, Compose, Kana";
    EXPECT_THAT(keyboard->begin(1), IsEmpty());
    const auto after = [&](int button, ButtonLight::State state) { return keyboard->show(button, {state, ""}).at(0).bytes; };
    EXPECT_THAT(after(1, Ready), ElementsAre(0x01));
    EXPECT_THAT(after(3, Alarm), ElementsAre(0x05)) << "the first one stays on";
    EXPECT_THAT(after(1, Off), ElementsAre(0x04));
    EXPECT_EQ(keyboard->show(1, {Ready, ""}).at(0).interface, 2);
    EXPECT_THAT(keyboard->show(6, {Ready, ""}), IsEmpty());
}

// Two lamps after id 3, and a brightness byte, which is no lamp.
TEST(LedPageLamps, stand_in_a_report_with_an_id_where_it_has_one) {
    const auto descriptor = bytesOf(
        "05 01 09 05 a1 01 85 03 05 09 19 01 29 08 15 00 25 01 75 01 95 08 81 02 05 08 09 4b 09 4b 95 02 91 02 95 06 91 03 06 00 "
        "ff 09 01 26 ff 00 75 08 95 01 91 02 c0");
    const auto box = lampsOf(hidProfileNamed("lamps_by_descriptor")->lamps, {{0, parseHidDescriptor(descriptor).value()}});
    ASSERT_NE(box, nullptr);
    EXPECT_EQ(box->count(), 2);
    const auto reports = box->show(2, {Ready, ""});
    ASSERT_THAT(reports, SizeIs(1));
    EXPECT_EQ(reports[0].id, 3);
    EXPECT_THAT(reports[0].bytes, ElementsAre(3, 2, 0));
}

// Num Lock must not be lit on a guess.
TEST(HidLamps, are_none_where_no_profile_says_so) {
    const auto keyboard = std::vector<HidInterface>{{0, parseHidDescriptor(kBootKeyboard).value()}};
    EXPECT_EQ(lampsOf(hidProfileNamed("presenter")->lamps, keyboard), nullptr);
    EXPECT_EQ(lampsOf(hidProfileNamed("shuttle_xpress")->lamps, keyboard), nullptr);
    EXPECT_EQ(lampsOf(hidProfileNamed("number_pad")->lamps, {{0, parseHidDescriptor(kMouse).value()}}), nullptr);
}

TEST(KeyPicture, is_the_colour_of_its_state_with_the_word_in_its_middle) {
    for (const auto state : {Off, Ready, Active, Alarm}) {
        const RgbaImage plain = keyPicture({state, ""}, 72), word = keyPicture({state, "BACK"}, 72);
        EXPECT_THAT(plain.pixels(), Each(colourOf(state)));
        EXPECT_EQ(word.at(2, 36), colourOf(state)) << "a margin";
        EXPECT_EQ(word.at(36, 8), colourOf(state));
        int ink = 0;
        for (const Rgba8& pixel : word.pixels()) ink += pixel != colourOf(state);
        EXPECT_GT(ink, 72 * 72 / 20);
        EXPECT_LT(ink, 72 * 72 / 3);
    }
    EXPECT_EQ(keyPicture({Ready, "\x01"}, 72), keyPicture({Ready, ""}, 72)) << "what cannot be written is left out";
}

// Otherwise a light that changes back is sent twice, and a lamp without a light stays as the last
// program left it.
TEST(ButtonLights, give_what_differs_oldest_first_and_all_of_it_anew) {
    ButtonLights lights;
    const auto given = [&] {
        std::string all;
        while (const auto next = lights.next()) all += fmt::format("{}:{} ", next->first, static_cast<int>(next->second.state));
        return all;
    };
    EXPECT_FALSE(lights.set(1, {}));
    EXPECT_TRUE(lights.set(3, {Ready, ""}));
    EXPECT_TRUE(lights.set(1, {Alarm, ""}));
    EXPECT_TRUE(lights.set(3, {Active, ""}));
    EXPECT_EQ(given(), "3:2 1:3 ");
    EXPECT_FALSE(lights.set(1, {Alarm, ""}));
    EXPECT_TRUE(lights.set(1, {Off, ""}));
    EXPECT_TRUE(lights.set(1, {Alarm, ""}));
    EXPECT_EQ(given(), "");
    EXPECT_THAT(lights.lit(), ElementsAre(1, 3));
    lights.invalidate(4);
    EXPECT_THAT(lights.lit(), IsEmpty());
    EXPECT_EQ(given(), "1:3 3:2 2:0 4:0 ");
}

}  // namespace
}  // namespace fantascope::drivers
