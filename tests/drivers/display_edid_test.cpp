#include "drivers/display/edid.h"

#include "edid_block.h"

#include <gmock/gmock.h>

#include <span>

namespace fantascope::drivers {
namespace {

using testing::Eq;
using testing::Optional;

TEST(Edid, tells_make_model_and_serial) {
    EXPECT_THAT(identityFromEdid(edidBlock({})), Optional(Eq(MonitorIdentity{"EPS", "EPSON PJ", "X4XX"})));
    EXPECT_THAT(identityFromEdid(edidBlock({.make = "ACZ", .name = "thirteen text", .serial = "0012345678901"})),
                Optional(Eq(MonitorIdentity{"ACZ", "thirteen text", "0012345678901"})))
        << "a text that fills its descriptor has no line's end";
}

TEST(Edid, falls_back_to_the_numbers_where_there_is_no_text) {
    EXPECT_THAT(identityFromEdid(edidBlock({.name = "", .serial = "", .product = 0x0A1B, .number = 4'000'000'007})),
                Optional(Eq(MonitorIdentity{"EPS", "0x0A1B", "4000000007"})));
    EXPECT_THAT(identityFromEdid(edidBlock({.serial = ""})), Optional(Eq(MonitorIdentity{"EPS", "EPSON PJ", ""})))
        << "number 0 says that there is none";
    EXPECT_THAT(identityFromEdid(edidBlock({.name = "   ", .serial = "   ", .product = 1, .number = 7})),
                Optional(Eq(MonitorIdentity{"EPS", "0x0001", "7"})))
        << "spaces are no text";
}

// Makers pad with arbitrary bytes. A status with such bytes could not be copied into a file.
TEST(Edid, leaves_out_what_is_not_text) {
    EXPECT_THAT(identityFromEdid(edidBlock({.name = " BenQ PJ  ", .serial = "A\x01\xFF\x42"})),
                Optional(Eq(MonitorIdentity{"EPS", "BenQ PJ", "AB"})));
    auto block = edidBlock({});
    block[8] = block[9] = 0;  // letters start at 1
    setEdidChecksum(block);
    EXPECT_EQ(identityFromEdid(block)->make, "");
}

// A timing descriptor may have the same byte where a text descriptor has its kind.
TEST(Edid, takes_no_timing_for_a_text) {
    auto block = edidBlock({.name = ""});
    block[54 + 3] = 0xFC;
    setEdidChecksum(block);
    EXPECT_EQ(identityFromEdid(block)->model, "0xA123");
}

TEST(Edid, has_no_identity_when_it_is_broken) {
    const auto good = edidBlock({});
    for (std::size_t size = 0; size < good.size(); ++size)
        EXPECT_EQ(identityFromEdid(std::span(good).first(size)), std::nullopt) << size;
    for (std::size_t at = 0; at < good.size(); ++at) {
        auto block = good;
        block[at] ^= 0x20;
        EXPECT_EQ(identityFromEdid(block), std::nullopt) << "byte " << at;
    }
    auto header = good;
    std::swap(header[0], header[1]);
    EXPECT_EQ(identityFromEdid(header), std::nullopt) << "the checksum is right, the header is not";
}

TEST(Edid, may_have_extensions) {
    auto block = edidBlock({});
    block[126] = 1;
    setEdidChecksum(block);
    block.resize(256, 0x55);
    EXPECT_THAT(identityFromEdid(block), Optional(Eq(MonitorIdentity{"EPS", "EPSON PJ", "X4XX"})));
}

}  // namespace
}  // namespace fantascope::drivers
