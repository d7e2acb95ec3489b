#include "drivers/cue_controller/hid_buttons.h"
#include "drivers/cue_controller/hid_descriptor.h"
#include "drivers/cue_controller_devices.h"

#include "core/random.h"

#include <gmock/gmock.h>

namespace fantascope::drivers {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

HidDescriptor parsed(const std::vector<std::uint8_t>& bytes) { return parseHidDescriptor(bytes).value(); }
std::string refusalOf(std::string_view bytes) {
    const auto result = parseHidDescriptor(bytesOf(bytes));
    return result ? "" : result.error().message();
}

TEST(HidDescriptor, of_a_boot_keyboard_has_modifiers_lamps_and_an_array_of_keys) {
    const HidDescriptor keyboard = parsed(kBootKeyboard);
    ASSERT_THAT(keyboard.inputs, SizeIs(9));
    EXPECT_EQ(keyboard.inputs[0].usage(), 0x000700e0u);
    EXPECT_EQ(keyboard.inputs[7].usage(), 0x000700e7u);
    const HidField& keys = keyboard.inputs[8];
    EXPECT_TRUE(keys.array);
    EXPECT_EQ(keys.offset, 16u) << "behind the byte of padding";
    EXPECT_EQ(keys.places, 6);
    EXPECT_THAT(keys.usages, ElementsAre(HidUsages{0x00070000, 0x00070065}));
    EXPECT_EQ(keys.application, 0x00010006u);
    EXPECT_THAT(keyboard.outputs, SizeIs(5));
    EXPECT_THAT(keyboard.inputReports, ElementsAre(HidReport{0, 8}));
}

TEST(HidDescriptor, tells_relative_from_absolute_and_signed_from_unsigned) {
    const HidDescriptor mouse = parsed(kMouse);
    ASSERT_THAT(mouse.inputs, SizeIs(6));
    EXPECT_FALSE(mouse.inputs[0].relative);
    EXPECT_TRUE(mouse.inputs[3].relative);
    EXPECT_EQ(mouse.inputs[3].low, -127);
    const std::vector<std::uint8_t> report = {0x05, 0x80, 0x7f, 0xff};
    EXPECT_EQ(mouse.inputs[0].valueIn(report), 1);
    EXPECT_EQ(mouse.inputs[1].valueIn(report), 0);
    EXPECT_EQ(mouse.inputs[2].valueIn(report), 1);
    EXPECT_EQ(mouse.inputs[3].valueIn(report), -128);
    EXPECT_EQ(mouse.inputs[4].valueIn(report), 127);
    EXPECT_EQ(mouse.inputs[5].valueIn(report), -1);
}

TEST(HidDescriptor, keeps_the_reports_of_several_ids_apart) {
    const HidDescriptor knob = parsed(kSpaceNavigator);
    EXPECT_THAT(knob.inputReports, ElementsAre(HidReport{1, 7}, HidReport{2, 7}, HidReport{3, 3}));
    ASSERT_THAT(knob.inputs, SizeIs(8));
    EXPECT_EQ(knob.inputs[3].report, 2);
    EXPECT_EQ(knob.inputs[3].usage(), 0x00010033u);
    EXPECT_EQ(knob.inputs[3].offset, 8u) << "behind the id";
    EXPECT_EQ(knob.inputs[3].low, -350);
    EXPECT_EQ(knob.inputs[3].application, 0x00010008u);
    EXPECT_EQ(knob.inputs[7].usage(), 0x00090002u);
    EXPECT_EQ(knob.inputs[5].valueIn(std::vector<std::uint8_t>{2, 0, 0, 0, 0, 0xa2, 0xfe}), -350);
}

// Example failure: 25 FF, literally -1 but always meant as 255, makes an empty range.
TEST(HidDescriptor, takes_a_maximum_for_unsigned_where_the_minimum_is_not_negative) {
    const HidDescriptor byte = parsed(bytesOf("05 01 09 04 a1 01 09 30 15 00 25 ff 75 08 95 01 81 02 c0"));
    EXPECT_EQ(byte.inputs.at(0).high, 255);
    EXPECT_EQ(byte.inputs.at(0).valueIn(std::vector<std::uint8_t>{0xff}), 255);
}

TEST(HidDescriptor, reads_fields_that_lie_across_bytes) {
    const HidDescriptor odd = parsed(bytesOf("05 01 09 04 a1 01 75 05 95 01 81 01 09 30 15 00 27 ff ff ff 7f 75 20 81 02 c0"));
    EXPECT_EQ(odd.inputs.at(0).offset, 5u);
    const std::vector<std::uint8_t> report = {0xff, 0xff, 0xff, 0xff, 0x0f};
    EXPECT_EQ(odd.inputs.at(0).valueIn(report), 0x7fffffff);
    EXPECT_THAT(odd.inputReports, ElementsAre(HidReport{0, 5}));
}

TEST(HidDescriptor, gives_usages_out_one_by_one_and_the_last_one_to_the_rest) {
    const HidDescriptor keys = parsed(bytesOf("05 0c 09 01 a1 01 09 e9 09 ea 15 00 25 01 75 01 95 04 81 02 c0"));
    ASSERT_THAT(keys.inputs, SizeIs(4));
    EXPECT_EQ(keys.inputs[0].usage(), 0x000c00e9u);
    EXPECT_EQ(keys.inputs[1].usage(), 0x000c00eau);
    EXPECT_EQ(keys.inputs[3].usage(), 0x000c00eau);
}

TEST(HidDescriptor, takes_usages_with_their_page_and_ranges_whose_ends_come_in_either_order) {
    const HidDescriptor keys =
        parsed(bytesOf("05 01 09 06 a1 01 0b e9 00 0c 00 2b e7 00 07 00 1b e0 00 07 00 2a 02 00 1b 01 00 09 00 15 00 25 01 75 01 "
                       "95 0b 81 02 c0"));
    ASSERT_THAT(keys.inputs, SizeIs(11));
    EXPECT_EQ(keys.inputs[0].usage(), 0x000c00e9u);
    EXPECT_EQ(keys.inputs[1].usage(), 0x000700e0u);
    EXPECT_EQ(keys.inputs[8].usage(), 0x000700e7u);
    EXPECT_EQ(keys.inputs[9].usage(), 0x00090001u) << "one end with its page is enough";
    EXPECT_EQ(keys.inputs[10].usage(), 0x00090002u);
}

// Section 6.2.2.8: a usage takes the page in force at the main item, not where the usage stands.
TEST(HidDescriptor, takes_the_page_that_holds_at_the_main_item) {
    const HidDescriptor keys = parsed(bytesOf("05 01 09 06 a1 01 09 01 05 09 15 00 25 01 75 01 95 01 81 02 c0"));
    EXPECT_EQ(keys.inputs.at(0).usage(), 0x00090001u);
}

TEST(HidDescriptor, brings_back_what_was_pushed) {
    const HidDescriptor keys =
        parsed(bytesOf("05 09 15 00 25 01 75 01 95 02 a4 05 0c 75 08 95 01 25 7f 09 e0 81 02 b4 19 01 29 02 81 02"));
    ASSERT_THAT(keys.inputs, SizeIs(3));
    EXPECT_EQ(keys.inputs[0].bits, 8);
    EXPECT_EQ(keys.inputs[2].bits, 1);
    EXPECT_EQ(keys.inputs[2].usage(), 0x00090002u);
    EXPECT_EQ(keys.inputs[2].offset, 9u);
}

TEST(HidDescriptor, takes_the_first_of_alternative_usages_and_skips_what_it_has_no_use_for) {
    const HidDescriptor keys = parsed(bytesOf(
        "05 09 fe 03 11 aa bb cc a9 01 09 01 09 02 a9 00 09 03 39 04 55 0e 65 11 79 02 c4 15 00 25 01 75 01 95 02 81 02 f1 00"));
    ASSERT_THAT(keys.inputs, SizeIs(2));
    EXPECT_EQ(keys.inputs[0].usage(), 0x00090001u);
    EXPECT_EQ(keys.inputs[1].usage(), 0x00090003u);
}

TEST(HidDescriptor, refuses_what_is_broken_and_says_where) {
    EXPECT_THAT(refusalOf("05 01 26 ff"), HasSubstr("byte 2: it ends inside an item"));
    EXPECT_THAT(refusalOf("fe 04 00 00"), HasSubstr("long item"));
    EXPECT_THAT(refusalOf("fe"), HasSubstr("long item"));
    EXPECT_THAT(refusalOf("a1 01"), HasSubstr("no end"));
    EXPECT_THAT(refusalOf("c0"), HasSubstr("without a collection"));
    EXPECT_THAT(refusalOf("b4"), HasSubstr("pop without a push"));
    EXPECT_THAT(refusalOf("85 00"), HasSubstr("0 is not a report id"));
    EXPECT_THAT(refusalOf("86 00 01"), HasSubstr("256 is not a report id"));
    EXPECT_THAT(refusalOf("a9 00"), HasSubstr("delimiter"));
    EXPECT_THAT(refusalOf("a9 01 09 01"), HasSubstr("delimiter has no end"));
    EXPECT_THAT(refusalOf("19 05 29 03"), HasSubstr("range of usages"));
    EXPECT_THAT(refusalOf("1b 01 00 09 00 2b 01 00 0c 00"), HasSubstr("range of usages")) << "over two pages";
    EXPECT_THAT(refusalOf("15 05 25 03 75 08 95 01 09 01 81 02"), HasSubstr("from 5 to 3"));
    EXPECT_THAT(refusalOf("77 ff ff ff ff 97 ff ff ff ff 81 02"), HasSubstr("too long"));
    EXPECT_THAT(refusalOf("75 01 96 00 80 15 00 25 01 81 02"), HasSubstr("too many"));
}

TEST(HidDescriptor, that_says_nothing_has_no_controls) {
    EXPECT_THAT(parsed({}).inputs, IsEmpty());
    EXPECT_THAT(parsed(bytesOf("05 01 09 06 a1 01 c0")).inputs, IsEmpty());
}

// Mutations of real descriptors and reports: truncated, with bytes changed, inserted or removed.
// The sanitizers watch; here the parser must end, and whatever is read lies inside its report.
TEST(HidDescriptor, survives_garbage) {
    const std::vector<std::vector<std::uint8_t>> seeds = {kBootKeyboard, kMouse,         kPresenterConsumer, kDualShock4,
                                                          kXboxGamepad,  kShuttleXpress, kSpaceNavigator,    kFootPedal,
                                                          kPowerMate,    kXkeys,         kStreamDeck};
    Rng rng(20261122);
    int taken = 0, refused = 0;
    for (int round = 0; round < 20'000; ++round) {
        std::vector<std::uint8_t> bytes = seeds[rng.below(static_cast<std::uint32_t>(seeds.size()))];
        for (std::uint32_t change = 0; change <= rng.below(8); ++change) {
            const std::uint32_t at = rng.below(static_cast<std::uint32_t>(bytes.size()));
            switch (rng.below(4)) {
                case 0:
                    bytes[at] = static_cast<std::uint8_t>(rng.below(256));
                    break;
                case 1:
                    bytes[at] ^= static_cast<std::uint8_t>(1u << rng.below(8));
                    break;
                case 2:
                    bytes.insert(bytes.begin() + at, static_cast<std::uint8_t>(rng.below(256)));
                    break;
                default:
                    if (bytes.size() > 1) bytes.erase(bytes.begin() + at);
            }
        }
        if (rng.below(4) == 0) bytes.resize(rng.below(static_cast<std::uint32_t>(bytes.size())) + 1);
        auto result = parseHidDescriptor(bytes);
        ++(result ? taken : refused);
        if (!result) continue;
        std::vector<std::size_t> lengths;
        for (const HidReport& report : result->inputReports) lengths.push_back(report.bytes);
        for (const HidField& field : result->inputs)
            for (const HidReport& report : result->inputReports)
                if (report.id == field.report) {
                    EXPECT_LE(field.offset + static_cast<std::size_t>(field.bits) * static_cast<std::size_t>(field.places),
                              8 * report.bytes);
                }
        HidButtons buttons({controlsOf({{0, std::move(result).value()}}), {}});
        for (const std::size_t length : lengths)
            for (std::size_t bytesSent : {length, length / 2, std::size_t{1}}) {
                std::vector<std::uint8_t> report(std::min<std::size_t>(bytesSent, 64));
                for (std::uint8_t& byte : report) byte = static_cast<std::uint8_t>(rng.below(256));
                for (const ButtonChange& change : buttons.take(0, report)) EXPECT_GE(change.button, 1);
            }
    }
    EXPECT_GT(taken, 1000);
    EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace fantascope::drivers
