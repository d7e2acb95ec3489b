// The packets of sACN and Art-Net, compared with bytes written by hand from the standards.

#include "drivers/dmx/artnet_packet.h"
#include "drivers/dmx/sacn_packet.h"

#include "core/random.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <initializer_list>

namespace fantascope::drivers {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::IsEmpty;

using Bytes = std::vector<std::uint8_t>;

Bytes operator+(Bytes first, const Bytes& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}
Bytes text(const std::string& letters, std::size_t size) {
    Bytes bytes(letters.begin(), letters.end());
    bytes.resize(size);
    return bytes;
}
template <class Container>
Bytes bytesIn(const Container& bytes) {
    return {bytes.begin(), bytes.end()};
}

const Bytes kPreamble = {0x00, 0x10, 0x00, 0x00, 0x41, 0x53, 0x43, 0x2d, 0x45, 0x31, 0x2e, 0x31, 0x37, 0x00, 0x00, 0x00};
const Bytes kCid = {0xfb, 0x3c, 0x10, 0x65, 0xa1, 0x7f, 0x4d, 0xe2, 0x99, 0x19, 0x31, 0x7a, 0x07, 0xc1, 0x00, 0x52};

sacn::Cid cid() {
    sacn::Cid cid;
    std::copy(kCid.begin(), kCid.end(), cid.begin());
    return cid;
}

sacn::Data levels() {
    sacn::Data data;
    data.cid = cid();
    data.name = "Source_A";
    data.universe = 0x1234;
    data.priority = 123;
    data.sync = 0x1f02;
    data.sequence = 154;
    for (std::size_t slot = 0; slot < kDmxSlots; ++slot) data.slots[slot] = static_cast<std::uint8_t>(slot * 7);
    return data;
}

// ANSI E1.31-2018, table 4-1 and appendix B.
Bytes handMadeLevels(std::uint8_t options = 0) {
    Bytes bytes = kPreamble + Bytes{0x72, 0x6e, 0, 0, 0, 0x04} + kCid + Bytes{0x72, 0x58, 0, 0, 0, 0x02} + text("Source_A", 64) +
                  Bytes{123, 0x1f, 0x02, 154, options, 0x12, 0x34} +
                  Bytes{0x72, 0x0b, 0x02, 0xa1, 0x00, 0x00, 0x00, 0x01, 0x02, 0x01, 0x00};
    for (int slot = 0; slot < 512; ++slot) bytes.push_back(static_cast<std::uint8_t>(slot * 7));
    return bytes;
}

TEST(SacnPacket, levels_are_the_bytes_of_the_standard) {
    EXPECT_EQ(handMadeLevels().size(), 638u);
    EXPECT_THAT(bytesOf(levels()), ElementsAreArray(handMadeLevels()));
    sacn::Data data = levels();
    data.preview = true;
    EXPECT_THAT(bytesOf(data), ElementsAreArray(handMadeLevels(0x80)));
    data.preview = false;
    data.terminated = true;
    EXPECT_THAT(bytesOf(data), ElementsAreArray(handMadeLevels(0x40)));
    data.terminated = false;
    data.force = true;
    EXPECT_THAT(bytesOf(data), ElementsAreArray(handMadeLevels(0x20)));
}

TEST(SacnPacket, levels_are_read_from_the_bytes_of_the_standard) {
    const auto packet = sacn::read(handMadeLevels(0xc0));
    ASSERT_TRUE(packet && std::holds_alternative<sacn::Data>(*packet));
    const auto& data = std::get<sacn::Data>(*packet);
    EXPECT_EQ(data.cid, cid());
    EXPECT_EQ(sacn::textOf(data.cid), "fb3c1065-a17f-4de2-9919-317a07c10052");
    EXPECT_EQ(data.name, "Source_A");
    EXPECT_EQ(data.universe, 0x1234);
    EXPECT_EQ(data.priority, 123);
    EXPECT_EQ(data.sync, 0x1f02);
    EXPECT_EQ(data.sequence, 154);
    EXPECT_TRUE(data.preview && data.terminated && !data.force);
    EXPECT_EQ(data.slots, levels().slots);
}

TEST(SacnPacket, fewer_slots_leave_the_rest_at_zero) {
    Bytes bytes = handMadeLevels();
    bytes.resize(126 + 3);
    const auto set = [&](std::size_t at, std::size_t value) {
        bytes[at] = static_cast<std::uint8_t>(value >> 8);
        bytes[at + 1] = static_cast<std::uint8_t>(value);
    };
    set(16, 0x7000 | (bytes.size() - 16));
    set(38, 0x7000 | (bytes.size() - 38));
    set(115, 0x7000 | (bytes.size() - 115));
    set(123, 4);
    const auto packet = sacn::read(bytes);
    ASSERT_TRUE(packet);
    std::array<std::uint8_t, kDmxSlots> wanted{};
    wanted[1] = 7;
    wanted[2] = 14;
    EXPECT_EQ(std::get<sacn::Data>(*packet).slots, wanted);
}

TEST(SacnPacket, sync_is_the_bytes_of_the_standard) {
    const Bytes wanted =
        kPreamble + Bytes{0x70, 0x21, 0, 0, 0, 0x08} + kCid + Bytes{0x70, 0x0b, 0, 0, 0, 0x01, 0x05, 0x1f, 0x02, 0x00, 0x00};
    EXPECT_THAT(bytesOf(sacn::Sync{cid(), 5, 0x1f02}), ElementsAreArray(wanted));
    const auto packet = sacn::read(wanted);
    ASSERT_TRUE(packet && std::holds_alternative<sacn::Sync>(*packet));
    EXPECT_EQ(std::get<sacn::Sync>(*packet).universe, 0x1f02);
    EXPECT_EQ(std::get<sacn::Sync>(*packet).sequence, 5);
}

TEST(SacnPacket, discovery_is_the_bytes_of_the_standard) {
    const Bytes wanted = kPreamble + Bytes{0x70, 0x6e, 0, 0, 0, 0x08} + kCid + Bytes{0x70, 0x58, 0, 0, 0, 0x02} +
                         text("Source_A", 64) + Bytes{0, 0, 0, 0} +
                         Bytes{0x70, 0x0e, 0, 0, 0, 0x01, 0, 1, 0x00, 0x01, 0x12, 0x34, 0xf9, 0xff};
    EXPECT_THAT(bytesOf(sacn::Discovery{cid(), "Source_A", 0, 1, {1, 0x1234, 63999}}), ElementsAreArray(wanted));
    const auto packet = sacn::read(wanted);
    ASSERT_TRUE(packet && std::holds_alternative<sacn::Discovery>(*packet));
    const auto& discovery = std::get<sacn::Discovery>(*packet);
    EXPECT_THAT(discovery.universes, ElementsAre(1, 0x1234, 63999));
    EXPECT_EQ(discovery.name, "Source_A");
    EXPECT_EQ(discovery.page, 0);
    EXPECT_EQ(discovery.lastPage, 1);
}

TEST(SacnPacket, a_long_name_is_cut_and_still_ends) {
    sacn::Data data = levels();
    data.name.assign(200, 'x');
    const auto packet = sacn::read(bytesOf(data));
    EXPECT_EQ(std::get<sacn::Data>(*packet).name, std::string(63, 'x'));
}

TEST(SacnPacket, groups_are_those_of_the_standard) {
    EXPECT_EQ(textOf(Ipv4{sacn::groupOf(1)}), "239.255.0.1");
    EXPECT_EQ(textOf(Ipv4{sacn::groupOf(63999)}), "239.255.249.255");
    EXPECT_EQ(textOf(Ipv4{sacn::groupOf(sacn::kDiscoveryUniverse)}), "239.255.250.214");
}

TEST(SacnPacket, a_cid_is_a_uuid_and_stands_for_its_name) {
    EXPECT_EQ(sacn::textOf(sacn::cidFor("here")), sacn::textOf(sacn::cidFor("here")));
    EXPECT_NE(sacn::cidFor("here"), sacn::cidFor("there"));
    EXPECT_EQ(sacn::cidFor("here")[6] >> 4, 8) << "its version";
    EXPECT_EQ(sacn::cidFor("here")[8] >> 6, 2) << "its variant";
}

// Section 6.7.2: differences in (-20, 0] are dropped.
TEST(SacnPacket, late_is_what_the_standard_says) {
    std::vector<int> late;
    for (int difference = -128; difference < 128; ++difference)
        for (const int last : {0, 5, 128, 250, 255})
            if (sacn::isLate(static_cast<std::uint8_t>(last + difference), static_cast<std::uint8_t>(last)) && last == 250)
                late.push_back(difference);
            else
                EXPECT_EQ(sacn::isLate(static_cast<std::uint8_t>(last + difference), static_cast<std::uint8_t>(last)),
                          difference > -20 && difference <= 0);
    EXPECT_EQ(late.size(), 20u);
    EXPECT_EQ(late.front(), -19);
    EXPECT_EQ(late.back(), 0);
}

artnet::Dmx artLevels() {
    artnet::Dmx dmx{9, 0x7ab3, {}};
    dmx.slots = levels().slots;
    return dmx;
}

Bytes handMadeArtDmx() {
    Bytes bytes = text("Art-Net", 8) + Bytes{0x00, 0x50, 0, 14, 9, 0, 0xb3, 0x7a, 0x02, 0x00};
    for (int slot = 0; slot < 512; ++slot) bytes.push_back(static_cast<std::uint8_t>(slot * 7));
    return bytes;
}

TEST(ArtnetPacket, levels_are_the_bytes_of_the_specification) {
    EXPECT_THAT(bytesOf(artLevels()), ElementsAreArray(handMadeArtDmx()));
    const auto packet = artnet::read(handMadeArtDmx());
    ASSERT_TRUE(packet && std::holds_alternative<artnet::Dmx>(*packet));
    const auto& dmx = std::get<artnet::Dmx>(*packet);
    EXPECT_EQ(dmx.sequence, 9);
    EXPECT_EQ(dmx.portAddress, 0x7ab3);
    EXPECT_EQ(dmx.slots, artLevels().slots);
}

TEST(ArtnetPacket, poll_and_sync_are_the_bytes_of_the_specification) {
    const Bytes poll = text("Art-Net", 8) + Bytes{0x00, 0x20, 0, 14, 0x02, 0x00};
    EXPECT_THAT(bytesOf(artnet::Poll{}), ElementsAreArray(poll));
    EXPECT_TRUE(std::holds_alternative<artnet::Poll>(*artnet::read(poll)));
    const Bytes sync = text("Art-Net", 8) + Bytes{0x00, 0x52, 0, 14, 0x00, 0x00};
    EXPECT_THAT(bytesOf(artnet::Sync{}), ElementsAreArray(sync));
    EXPECT_TRUE(std::holds_alternative<artnet::Sync>(*artnet::read(sync)));
}

TEST(ArtnetPacket, a_reply_is_the_bytes_of_the_specification) {
    artnet::PollReply reply;
    reply.address = {0x0a000005};
    reply.hardware = {2, 3, 4, 5, 6, 7};
    reply.shortName = "Fantascope";
    reply.longName = "A controller";
    reply.controller = true;
    reply.bindIndex = 3;
    reply.outputs = {0x7ab3, 0x7ab5};
    const Bytes wanted = text("Art-Net", 8) + Bytes{0x00, 0x21, 10, 0, 0, 5, 0x36, 0x19, 0, 0, 0x7a, 0x0b, 0x00, 0xff} +
                         Bytes{0, 0, 0xf0, 0x7f} + text("Fantascope", 18) + text("A controller", 64) +
                         text("#0001 [0000] ok", 64) + Bytes{0, 2, 0x80, 0x80, 0, 0} + Bytes{0, 0, 0, 0} +
                         Bytes{0x80, 0x80, 0, 0} + Bytes{0, 0, 0, 0} + Bytes{3, 5, 0, 0} + Bytes{0, 0, 0, 0, 0, 0} +
                         Bytes{1, 2, 3, 4, 5, 6, 7, 10, 0, 0, 5, 3, 0x08} + Bytes(26);
    ASSERT_EQ(wanted.size(), 239u);
    EXPECT_THAT(bytesOf(reply), ElementsAreArray(wanted));
    const auto packet = artnet::read(wanted);
    ASSERT_TRUE(packet && std::holds_alternative<artnet::PollReply>(*packet));
    const auto& read = std::get<artnet::PollReply>(*packet);
    EXPECT_EQ(textOf(read.address), "10.0.0.5");
    EXPECT_EQ(read.hardware, reply.hardware);
    EXPECT_EQ(read.shortName, "Fantascope");
    EXPECT_EQ(read.longName, "A controller");
    EXPECT_TRUE(read.controller);
    EXPECT_EQ(read.bindIndex, 3);
    EXPECT_THAT(read.outputs, ElementsAre(0x7ab3, 0x7ab5));
    EXPECT_THAT(read.inputs, IsEmpty());
}

TEST(ArtnetPacket, a_sequence_goes_from_255_to_1_and_0_does_not_count) {
    EXPECT_FALSE(artnet::isLate(1, 255));
    EXPECT_TRUE(artnet::isLate(255, 1));
    EXPECT_TRUE(artnet::isLate(7, 7));
    EXPECT_TRUE(artnet::isLate(237, 1)) << "19 before 1 is 237, as there is no 0";
    EXPECT_FALSE(artnet::isLate(236, 1)) << "20 before: the sender has begun anew";
    EXPECT_FALSE(artnet::isLate(0, 7));
    EXPECT_FALSE(artnet::isLate(7, 0));
}

// Each field must have its required value.
TEST(Packets, with_a_wrong_field_are_not_read) {
    struct Case {
        std::size_t at;
        std::uint8_t value;
        const char* what;
    };
    for (const auto& [at, value, what] : std::initializer_list<Case>{{0, 1, "preamble"},
                                                                     {4, 'B', "identifier"},
                                                                     {16, 0x62, "flags of the root layer"},
                                                                     {17, 0x6f, "length of the root layer"},
                                                                     {21, 5, "root vector"},
                                                                     {39, 0x59, "length of the framing layer"},
                                                                     {43, 3, "framing vector"},
                                                                     {108, 201, "priority"},
                                                                     {109, 0xff, "synchronization address"},
                                                                     {113, 0xff, "universe"},
                                                                     {116, 0x0c, "length of the DMP layer"},
                                                                     {117, 3, "DMP vector"},
                                                                     {118, 0xa2, "address type"},
                                                                     {120, 1, "first address"},
                                                                     {122, 2, "increment"},
                                                                     {124, 0x02, "one slot too many"},
                                                                     {123, 0xff, "far too many slots"}}) {
        Bytes bytes = handMadeLevels();
        bytes[at] = value;
        EXPECT_FALSE(sacn::read(bytes)) << what;
    }
    for (const auto& [at, value, what] : std::initializer_list<Case>{{0, 'B', "identifier"},
                                                                     {9, 0x51, "opcode"},
                                                                     {11, 13, "an old protocol"},
                                                                     {15, 0x80, "net"},
                                                                     {16, 0x03, "length"},
                                                                     {17, 0x01, "length beyond the packet"}}) {
        Bytes bytes = handMadeArtDmx();
        bytes[at] = value;
        EXPECT_FALSE(artnet::read(bytes)) << what;
    }
    Bytes none = handMadeArtDmx();
    none[16] = none[17] = 0;
    EXPECT_FALSE(artnet::read(none)) << "no slot at all";
}

std::vector<Bytes> goodPackets() {
    artnet::PollReply reply;
    reply.shortName = "node";
    reply.outputs = {1, 2, 3, 4};
    return {handMadeLevels(),
            bytesIn(bytesOf(sacn::Sync{cid(), 5, 7})),
            bytesOf(sacn::Discovery{cid(), "Source_A", 0, 0, {1, 2, 3}}),
            handMadeArtDmx(),
            bytesIn(bytesOf(artnet::Sync{})),
            bytesIn(bytesOf(artnet::Poll{})),
            bytesIn(bytesOf(reply))};
}

TEST(Packets, that_end_too_early_are_not_read) {
    for (const Bytes& whole : goodPackets()) {
        ASSERT_TRUE(sacn::read(whole) || artnet::read(whole));
        const bool isSacn = whole[0] == 0;
        // Polls have had further bytes only since Art-Net 4, and old nodes send shorter replies.
        const std::size_t least = isSacn ? whole.size() : whole.size() == 239 ? 207 : whole.size() == 14 ? 12 : whole.size();
        for (std::size_t size = 0; size < least; ++size) {
            // In a buffer of exactly its size, so that the address sanitizer detects reading beyond
            // it.
            const Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
            EXPECT_FALSE(sacn::read(part) || artnet::read(part)) << size << " of " << whole.size();
        }
    }
}

// Example failure: a length from the packet is trusted, and a broken gateway ends the show. All
// values read must be in range.
TEST(Packets, that_are_damaged_at_random_never_harm) {
    Rng rng(1);
    const std::vector<Bytes> good = goodPackets();
    int read = 0;
    for (int round = 0; round < 200'000; ++round) {
        Bytes bytes = good[rng.below(static_cast<std::uint32_t>(good.size()))];
        for (std::uint32_t damage = rng.below(6); damage > 0; --damage) {
            const auto early = rng.below(2) == 0 ? static_cast<std::uint32_t>(std::min<std::size_t>(bytes.size(), 130)) : 0;
            bytes[rng.below(early > 0 ? early : static_cast<std::uint32_t>(bytes.size()))] =
                static_cast<std::uint8_t>(rng.bits());
        }
        if (rng.below(4) == 0) bytes.resize(rng.below(static_cast<std::uint32_t>(bytes.size()) + 20));
        bytes.shrink_to_fit();
        if (const auto packet = sacn::read(bytes)) {
            ++read;
            if (const auto* data = std::get_if<sacn::Data>(&*packet)) {
                ASSERT_LE(data->priority, 200);
                ASSERT_GE(data->universe, 1);
                ASSERT_LE(data->universe, sacn::kLastUniverse);
            }
        }
        if (const auto packet = artnet::read(bytes)) {
            ++read;
            if (const auto* dmx = std::get_if<artnet::Dmx>(&*packet)) {
                ASSERT_LE(dmx->portAddress, artnet::kLastPortAddress);
            }
            if (const auto* reply = std::get_if<artnet::PollReply>(&*packet)) {
                ASSERT_LE(reply->outputs.size(), 4u);
            }
        }
    }
    EXPECT_GT(read, 10'000) << "the damage must not be so great that nothing gets as far as the fields";
}

}  // namespace
}  // namespace fantascope::drivers
