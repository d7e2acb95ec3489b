// sACN and Art-Net beyond the contracts of the ports, with plain sockets at the far end.

#include "drivers/dmx/dmx_nodes.h"

#include "core/random.h"
#include "peers/dmx_network_rig.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <thread>

namespace fantascope::peers {
namespace {

using contract::dmxFrame;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kSacn = "driver: sacn\ninterface: near\n";
constexpr const char* kArtnet = "driver: artnet\ninterface: near\n";

class DmxNetwork : public testing::Test {
protected:
    void SetUp() override {
        if (!whyNoNetwork().empty()) GTEST_SKIP() << whyNoNetwork();
    }
};

// Sends a frame once and listens until it arrives.
bool isHeard(Ear& ear, DmxPort& port, int universe, const Slots& frame) {
    const auto sent = port.send(frame);
    return sent && ear.listenUntil([&] { return !ear.heard[universe].empty() && ear.heard[universe].back().slots == frame; });
}

TEST_F(DmxNetwork, sacn_says_who_sends_what) {
    Ear ear("sacn");
    ear.join(1007);
    const auto port = openPort(std::string(kSacn) + "priority: 142\npreview: true\nname: The Square\n", 1007);
    ASSERT_TRUE(ear.listenUntil([&] { return runs(*port); })) << port->status().detail;
    ASSERT_TRUE(isHeard(ear, *port, 1007, dmxFrame(1)));
    const PlainLevels levels = ear.heard[1007].back();
    EXPECT_EQ(levels.name, "The Square");
    EXPECT_EQ(levels.priority, 142);
    EXPECT_EQ(levels.options, 0x80) << "preview";
    EXPECT_EQ(levels.sync, 0);
}

TEST_F(DmxNetwork, sacn_is_known_again_by_its_cid_after_a_restart) {
    Ear ear("sacn");
    ear.join(7);
    std::vector<std::string> cids;
    for (const char* site : {"site.yaml", "site.yaml", "other/site.yaml"}) {
        const auto port = drivers::openDmxPort(ConfigNode::parse(kSacn, site).value(), 7, night()).value();
        ASSERT_TRUE(ear.listenUntil([&] { return runs(*port); }));
        // A new frame each time, because a port that closes repeats its last one.
        ASSERT_TRUE(isHeard(ear, *port, 7, dmxFrame(static_cast<int>(cids.size()) + 1)));
        cids.push_back(ear.heard[7].back().cid);
        ear.forget();
    }
    EXPECT_EQ(cids[0], cids[1]);
    EXPECT_NE(cids[0], cids[2]) << "another site is another source";
}

TEST_F(DmxNetwork, sacn_sends_its_termination_three_times) {
    Ear ear("sacn");
    ear.join(7);
    auto port = openPort(kSacn, 7);
    ASSERT_TRUE(ear.listenUntil([&] { return runs(*port); }));
    ASSERT_TRUE(isHeard(ear, *port, 7, dmxFrame(1)));
    port.reset();
    const auto ended = [&] {
        return std::count_if(ear.heard[7].begin(), ear.heard[7].end(), [](const auto& heard) { return heard.options == 0x40; });
    };
    ASSERT_TRUE(ear.listenUntil([&] { return ended() == 3; }));
    EXPECT_EQ(ear.heard[7].back().options, 0x40) << "nothing comes after it";
    for (std::size_t i = 1; i < ear.heard[7].size(); ++i)
        EXPECT_EQ(ear.heard[7][i].sequence, (ear.heard[7][i - 1].sequence + 1) & 255);
}

// Receivers keep the levels before a termination, because those of the terminating packet mean
// nothing (ANSI E1.31, section 6.2.6). Example failure: testing a lamp leaves it at full.
TEST_F(DmxNetwork, the_newest_levels_are_out_four_times_before_a_port_closes) {
    for (const std::string protocol : {"sacn", "artnet"}) {
        SCOPED_TRACE(protocol);
        Ear ear(protocol);
        if (protocol == "sacn") ear.join(7);
        auto port = openPort("driver: " + protocol + "\ninterface: near\n", 7);
        ASSERT_TRUE(ear.listenUntil([&] { return runs(*port); }));
        ASSERT_TRUE(isHeard(ear, *port, 7, dmxFrame(1)));
        ear.forget();
        const Slots dark{};
        ASSERT_TRUE(port->send(dark));
        port.reset();
        const auto countOf = [&](int options) {
            return std::ranges::count_if(
                ear.heard[7], [&](const PlainLevels& heard) { return heard.slots == dark && heard.options == options; });
        };
        EXPECT_TRUE(ear.listenUntil([&] { return countOf(0) == 4; })) << countOf(0);
        EXPECT_TRUE(ear.listenUntil([&] { return countOf(0x40) == (protocol == "sacn" ? 3 : 0); }));
        ASSERT_FALSE(ear.heard[7].empty());
        EXPECT_EQ(ear.heard[7].back().slots, dark);
        EXPECT_EQ(ear.heard[7].back().options, protocol == "sacn" ? 0x40 : 0);
    }
}

// The order of packets on the wire: "7", "8", or "sync".
std::vector<std::string> orderOf(const std::vector<Datagram>& packets) {
    std::vector<std::string> order;
    for (const Datagram& packet : packets) {
        if (const auto sacn = readPlainSacn(packet)) order.push_back(std::to_string(sacn->universe));
        if (const auto art = readPlainArtDmx(packet)) order.push_back(std::to_string(art->universe));
        if (isArtSync(packet) || (packet.size() == 49 && packet[21] == 8 && packet[43] == 1)) order.push_back("sync");
    }
    return order;
}

TEST_F(DmxNetwork, a_sync_packet_follows_all_universes_of_a_tick) {
    for (const std::string protocol : {"sacn", "artnet"}) {
        SCOPED_TRACE(protocol);
        Ear ear(protocol);
        if (protocol == "sacn")
            for (const int universe : {7, 8, 9, 50}) ear.join(universe);
        const std::string keys = "driver: " + protocol + "\ninterface: near\n";
        const std::string synchronised = keys + (protocol == "sacn" ? "sync: 50\n" : "sync: true\n");
        const auto first = openPort(synchronised, 7), second = openPort(synchronised, 8);
        ASSERT_TRUE(ear.listenUntil([&] { return runs(*first) && runs(*second); }));
        for (int frame = 0; frame < 50; ++frame) {
            ASSERT_TRUE(first->send(dmxFrame(frame)));
            ASSERT_TRUE(isHeard(ear, *second, 8, dmxFrame(frame)));
        }
        ASSERT_TRUE(ear.listenUntil([&] { return orderOf(ear.packets).back() == "sync"; }));
        const auto order = orderOf(ear.packets);
        EXPECT_GE(std::count(order.begin(), order.end(), "sync"), 50);
        for (std::size_t i = 1; i < order.size(); ++i)
            ASSERT_TRUE(order[i] == "sync" ? order[i - 1] != "sync" : order[i] > order[i - 1] || order[i - 1] == "sync")
                << order[i - 1] << " then " << order[i];
        EXPECT_EQ(ear.heard[7].back().sync, protocol == "sacn" ? 50 : 0);
    }
}

TEST_F(DmxNetwork, sacn_announces_its_universes) {
    Ear ear("sacn");
    ear.join(64214);
    ear.join(8);
    const auto first = openPort(kSacn, 300), second = openPort(kSacn, 8), silent = openPort(kSacn, 9);
    ASSERT_TRUE(ear.listenUntil([&] { return runs(*first) && runs(*second); }));
    ASSERT_TRUE(first->send(dmxFrame(1)));
    ASSERT_TRUE(isHeard(ear, *second, 8, dmxFrame(1)));
    const auto announcement = [&] {
        return std::find_if(ear.packets.begin(), ear.packets.end(),
                            [](const Datagram& packet) { return packet.size() == 124 && packet[21] == 8 && packet[43] == 2; });
    };
    ASSERT_TRUE(ear.listenUntil([&] { return announcement() != ear.packets.end(); }));
    EXPECT_THAT(Datagram(announcement()->begin() + 112, announcement()->end()),
                ElementsAre(0x70, 12, 0, 0, 0, 1, 0, 0, 0, 8, 300 >> 8, 300 & 255));
}

// Example failure (OLA 1850): datagrams to a device that is off fill the one socket, and every lamp
// stutters.
TEST_F(DmxNetwork, devices_that_are_off_take_nothing_from_the_others) {
    constexpr int kFrames = 150;
    for (const std::string protocol : {"sacn", "artnet"}) {
        SCOPED_TRACE(protocol);
        Ear ear(protocol);
        const std::string keys = "driver: " + protocol + "\ninterface: near\n";
        const bool isSacn = protocol == "sacn";
        std::vector<std::unique_ptr<DmxPort>> off;
        for (int dead = 0; dead < 8; ++dead)
            off.push_back(openPort(keys + (isSacn ? fmt::format("unicast: [10.77.0.{}]\n", 200 + dead)
                                                  : fmt::format("poll: false\nnode: 10.77.0.{}\n", 200 + dead)),
                                   20 + dead));
        const auto alive = openPort(keys + (isSacn ? "unicast: [10.77.0.210, 10.77.0.2]\n" : "node: 10.77.0.2\n"), 7);
        ASSERT_TRUE(ear.listenUntil(
            [&] { return runs(*alive) && std::all_of(off.begin(), off.end(), [](const auto& port) { return runs(*port); }); }));
        ear.forget();
        for (int frame = 1; frame <= kFrames; ++frame) {
            for (const auto& port : off) ASSERT_TRUE(port->send(dmxFrame(frame)));
            ASSERT_TRUE(isHeard(ear, *alive, 7, dmxFrame(frame))) << frame;
        }
        const auto& heard = ear.heard[7];
        EXPECT_GE(heard.size(), static_cast<std::size_t>(kFrames));
        for (std::size_t i = 1; i < heard.size(); ++i) {
            const int next = isSacn ? (heard[i - 1].sequence + 1) & 255 : heard[i - 1].sequence % 255 + 1;
            ASSERT_EQ(heard[i].sequence, next) << "nothing is lost on the way";
        }
        EXPECT_EQ(alive->status().losses, 0);
    }
}

TEST_F(DmxNetwork, an_artnet_node_that_stops_answering_is_absent_until_it_answers_again) {
    Ear ear("artnet");
    const auto node = openPort(std::string(kArtnet) + "node: 10.77.0.2\n", 7);
    const auto mute = openPort(std::string(kArtnet) + "node: 10.77.0.2\npoll: false\n", 8), all = openPort(kArtnet, 9);
    ASSERT_TRUE(ear.listenUntil([&] { return runs(*node); }));
    ear.answer(false);
    int frame = 0;
    ASSERT_TRUE(ear.listenUntil([&] {
        EXPECT_TRUE(all->send(dmxFrame(++frame)));
        return !runs(*node);
    }));
    EXPECT_EQ(node->status().state, DeviceState::Absent);
    EXPECT_THAT(node->status().detail, HasSubstr("node 10.77.0.2 does not answer ArtPoll"));
    EXPECT_THAT(node->send(dmxFrame(1)).error().message(), HasSubstr("universe 7 is absent: node 10.77.0.2"));
    EXPECT_TRUE(runs(*mute)) << "it was said that it never answers";
    ASSERT_TRUE(isHeard(ear, *all, 9, dmxFrame(++frame)));
    ear.answer(true);
    ASSERT_TRUE(ear.listenUntil([&] { return runs(*node); }));
    EXPECT_EQ(node->status().losses, 1);
    EXPECT_EQ(all->status().losses + mute->status().losses, 0);
    ASSERT_TRUE(isHeard(ear, *node, 7, dmxFrame(3)));
}

TEST_F(DmxNetwork, artnet_answers_polls_with_its_ports) {
    Ear ear("artnet");
    const auto out = openPort(std::string(kArtnet) + "net: 1\nsubnet: 2\nuniverse: 3\n", 7);
    const auto in = openSource(kArtnet, 0x456);
    ASSERT_TRUE(ear.listenUntil([&] { return runs(*out) && runs(*in); }));
    ear.forget();
    PlainSocket controller = madeThere([] { return PlainSocket("far", "10.77.0.11", 6454); });
    ASSERT_TRUE(controller.send(plainArtPoll(), "10.77.0.1", 6454));
    std::vector<Datagram> replies;
    ASSERT_TRUE(eventually([&] {
        Datagram bytes = controller.receive(2);
        if (isArtPollReply(bytes)) replies.push_back(std::move(bytes));
        return replies.size() == 2;
    }));
    EXPECT_EQ(replies[0].size(), 239u);
    const auto port = [](const Datagram& reply, std::size_t nibble) { return reply[18] << 8 | reply[19] << 4 | reply[nibble]; };
    EXPECT_EQ(replies[0][174], 0x80) << "what comes in to us goes out for others";
    EXPECT_EQ(port(replies[0], 190), 0x456);
    EXPECT_EQ(replies[1][174], 0x40);
    EXPECT_EQ(port(replies[1], 186), 0x123);
    EXPECT_NE(replies[0][211], replies[1][211]) << "each port has an index of its own";
    EXPECT_EQ(replies[0][200], 1) << "a controller";
}

// Desks at the far end, and what our source receives from them.
class DmxNetworkIn : public DmxNetwork {
protected:
    void open(const std::string& protocol) {
        isSacn_ = protocol == "sacn";
        const std::string keys = "driver: " + protocol + "\ninterface: near\n";
        source_ = openSource(keys, 7);
        second_ = openSource(keys, 8);
        marker_ = openSource(keys, 99);
        ASSERT_TRUE(eventually([&] { return runs(*source_) && runs(*second_) && runs(*marker_); }));
        desk_ = madeThere([&] { return PlainSocket("far", "10.77.0.11", isSacn_ ? 5568 : 6454); });
        other_ = madeThere([&] { return PlainSocket("far", "10.77.0.12", isSacn_ ? 5568 : 6454); });
    }
    static PlainLevels levels(int level, int sequence, int universe = 7, const std::string& name = "desk") {
        PlainLevels levels{.universe = universe, .sequence = sequence, .name = name};
        levels.cid = name + std::string(16 - name.size(), '.');
        levels.slots.fill(static_cast<std::uint8_t>(level));
        return levels;
    }
    void send(const PlainLevels& levels) {
        const Datagram bytes = isSacn_ ? plainSacn(levels) : plainArtDmx(levels);
        desk_.send(bytes, isSacn_ ? sacnGroup(levels.universe) : "10.77.0.1", isSacn_ ? 5568 : 6454);
    }
    void sendBytes(const Datagram& bytes) { desk_.send(bytes, isSacn_ ? sacnGroup(7) : "10.77.0.1", isSacn_ ? 5568 : 6454); }
    // The first slots of the frames from a source once everything has arrived; -1 for a
    // termination.
    std::vector<int> got(DmxSource& source) {
        mark_ = mark_ % 250 + 1;
        PlainLevels mark = levels(mark_, mark_, 99, "mark");
        EXPECT_TRUE(eventually([&] {
            if (isSacn_)
                desk_.send(plainSacn(mark), sacnGroup(99), 5568);
            else
                desk_.send(plainArtDmx(mark), "10.77.0.1", 6454);
            for (auto frame = marker_->receive(); frame; frame = marker_->receive())
                if (frame->slots[0] == mark_) return true;
            // After a sync packet the mark may wait for another one.
            if (!isSacn_) desk_.send(plainArtSync(), "10.77.0.1", 6454);
            return false;
        }));
        std::vector<int> slots;
        for (auto frame = source.receive(); frame; frame = source.receive()) slots.push_back(frame->ended ? -1 : frame->slots[0]);
        return slots;
    }

    bool isSacn_ = true;
    int mark_ = 0;
    PlainSocket desk_, other_;
    std::unique_ptr<DmxSource> source_, second_, marker_;
};

TEST_F(DmxNetworkIn, late_frames_are_dropped_and_a_new_beginning_is_not) {
    for (const std::string protocol : {"sacn", "artnet"}) {
        SCOPED_TRACE(protocol);
        open(protocol);
        send(levels(1, 50));
        send(levels(2, 49));  // out of order
        send(levels(3, 50));  // doubled
        send(levels(4, 31));  // 19 back
        send(levels(5, 51));
        send(levels(6, 31));  // 20 back: it has begun anew
        send(levels(7, 32));
        send(levels(8, 200));
        EXPECT_THAT(got(*source_), ElementsAre(1, 5, 6, 7, 8));
        EXPECT_THAT(got(*second_), IsEmpty());
    }
}

TEST_F(DmxNetworkIn, what_is_no_levels_for_us_is_ignored) {
    for (const std::string protocol : {"sacn", "artnet"}) {
        SCOPED_TRACE(protocol);
        open(protocol);
        send(levels(1, 1));
        Rng rng(1);
        for (int i = 0; i < 2000; ++i) {
            Datagram bytes = isSacn_ ? plainSacn(levels(2, 2)) : plainArtDmx(levels(2, 2));
            const std::uint32_t kind = rng.below(3);
            if (kind == 0) bytes.resize(rng.below(static_cast<std::uint32_t>(bytes.size())));
            // Bytes of the header that may have no other value.
            const std::vector<std::size_t> fixed =
                isSacn_ ? std::vector<std::size_t>{0, 1, 4, 12, 16, 18, 21, 38, 40, 43, 115, 117, 118, 119, 121, 123}
                        : std::vector<std::size_t>{0, 3, 7, 8, 9};
            if (kind == 1) bytes[fixed[rng.below(static_cast<std::uint32_t>(fixed.size()))]] ^= 0x10;
            if (kind == 2)
                for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(rng.bits());
            sendBytes(bytes);
        }
        if (isSacn_) {
            PlainLevels preview = levels(3, 2);
            preview.options = 0x80;
            send(preview);
            Datagram other = plainSacn(levels(4, 3));
            other[125] = 0xdd;  // per-slot priorities, not levels
            sendBytes(other);
        }
        send(levels(5, 9));
        EXPECT_THAT(got(*source_), ElementsAre(1, 5));
        EXPECT_THAT(got(*second_), IsEmpty());
    }
}

TEST_F(DmxNetworkIn, synchronised_sacn_waits_for_its_sync_packet) {
    open("sacn");
    const auto synchronised = [&](int level, int sequence, int universe) {
        PlainLevels held = levels(level, sequence, universe);
        held.sync = 50;
        send(held);
    };
    const auto sync = [&](int universe, int sequence) {
        desk_.send(plainSacnSync(levels(0, 0).cid, universe, sequence), sacnGroup(universe), 5568);
    };
    synchronised(1, 1, 7);
    EXPECT_THAT(got(*source_), ElementsAre(1)) << "no sync packet ever came";
    sync(50, 1);
    synchronised(2, 2, 7);
    synchronised(3, 1, 8);
    send(levels(9, 1, 8, "free"));
    EXPECT_THAT(got(*source_), IsEmpty());
    EXPECT_THAT(got(*second_), ElementsAre(9)) << "another desk does not wait";
    synchronised(4, 3, 7);
    sync(51, 2);
    EXPECT_THAT(got(*source_), IsEmpty()) << "the packet of another sync universe";
    sync(50, 2);
    EXPECT_THAT(got(*source_), ElementsAre(4)) << "the newest alone";
    EXPECT_THAT(got(*second_), ElementsAre(3));
    PlainLevels termination = levels(0, 4);
    termination.options = 0x40;
    synchronised(5, 4, 7);
    termination.sequence = 5;
    send(termination);
    EXPECT_THAT(got(*source_), ElementsAre(-1)) << "what waits does not outlive its sender";
}

TEST_F(DmxNetworkIn, artnet_waits_for_its_senders_sync_packet) {
    open("artnet");
    send(levels(1, 1));
    EXPECT_THAT(got(*source_), ElementsAre(1)) << "no sync packet ever came";
    other_.send(plainArtSync(), "10.77.0.1", 6454);
    send(levels(2, 2));
    EXPECT_THAT(got(*source_), ElementsAre(2)) << "somebody else's";
    desk_.send(plainArtSync(), "10.77.0.1", 6454);
    send(levels(3, 3));
    send(levels(4, 1, 8));
    other_.send(plainArtDmx(levels(9, 1)), "10.77.0.1", 6454);
    ASSERT_TRUE(eventually([&] {
        const auto frame = source_->receive();
        return frame && frame->slots[0] == 9;
    })) << "the other desk does not wait, and nothing comes before";
    desk_.send(plainArtSync(), "10.77.0.1", 6454);
    EXPECT_THAT(got(*source_), ElementsAre(3));
    EXPECT_THAT(got(*second_), ElementsAre(4));
}

TEST_F(DmxNetworkIn, we_do_not_hear_ourselves) {
    for (const std::string protocol : {"sacn", "artnet"}) {
        SCOPED_TRACE(protocol);
        open(protocol);
        Ear ear(protocol);
        if (isSacn_) ear.join(7);
        const auto port = openPort("driver: " + protocol + "\ninterface: near\n", 7);
        ASSERT_TRUE(ear.listenUntil([&] { return runs(*port); }));
        ASSERT_TRUE(isHeard(ear, *port, 7, dmxFrame(1)));
        EXPECT_THAT(got(*source_), IsEmpty());
    }
}

TEST_F(DmxNetwork, an_interface_that_is_switched_off_is_absent_and_comes_back) {
    for (const std::string protocol : {"sacn", "artnet"}) {
        SCOPED_TRACE(protocol);
        Ear ear(protocol);
        if (protocol == "sacn") ear.join(7);
        const auto port = openPort("driver: " + protocol + "\ninterface: 10.77.0.1\n", 7);
        const auto aside = openPort("driver: " + protocol + "\ninterface: aside\n", 8);
        ASSERT_TRUE(ear.listenUntil([&] { return runs(*port) && runs(*aside); }));
        ASSERT_TRUE(isHeard(ear, *port, 7, dmxFrame(1)));
        setLink("near", false);
        const bool noticed = eventually([&] { return port->status().state == DeviceState::Absent; });
        const std::string detail = port->status().detail;
        setLink("near", true);
        EXPECT_TRUE(noticed);
        EXPECT_THAT(detail, HasSubstr("near has no link"));
        ASSERT_TRUE(ear.listenUntil([&] { return runs(*port); })) << port->status().detail;
        EXPECT_TRUE(isHeard(ear, *port, 7, dmxFrame(2)));
        EXPECT_EQ(port->status().losses, 1);
        EXPECT_EQ(aside->status().losses, 0);
    }
}

TEST_F(DmxNetwork, a_machine_on_two_networks_is_told_to_choose) {
    const auto port = openPort("driver: sacn\n", 7), unknown = openPort("driver: sacn\ninterface: eth77\n", 7);
    ASSERT_TRUE(eventually([&] { return port->status().state == DeviceState::Faulted; }));
    EXPECT_THAT(port->status().detail, HasSubstr("several networks (near, aside): choose one with 'interface'"));
    ASSERT_TRUE(eventually([&] { return unknown->status().state == DeviceState::Absent; }));
    EXPECT_THAT(unknown->status().detail, HasSubstr("there is no interface eth77"));
}

TEST_F(DmxNetwork, nodes_and_sources_are_found_whether_or_not_we_play) {
    for (const bool playing : {false, true}) {
        SCOPED_TRACE(playing);
        Ear ear("artnet");
        std::unique_ptr<DmxPort> port;
        if (playing) {
            port = openPort(kArtnet, 7);
            ASSERT_TRUE(ear.listenUntil([&] { return runs(*port); }));
        }
        Datagram discovery = plainSacnSync(std::string(16, 'c'), 0, 0);
        discovery.resize(120);
        discovery[17] = 106;
        discovery[39] = 84;
        discovery[43] = 2;
        std::fill(discovery.begin() + 44, discovery.end(), std::uint8_t{0});
        std::copy_n("Grand Desk", 10, discovery.begin() + 44);
        for (const int byte : {0x00, 0x05, 0x01, 0x00}) discovery.push_back(static_cast<std::uint8_t>(byte));
        discovery[17] = static_cast<std::uint8_t>(discovery.size() - 16);
        discovery[39] = static_cast<std::uint8_t>(discovery.size() - 38);
        discovery[112] = 0x70;
        discovery[113] = static_cast<std::uint8_t>(discovery.size() - 112);
        discovery[117] = 1;

        PlainSocket desk = madeThere([] { return PlainSocket("far", "", 0); });
        std::vector<drivers::FoundDevice> found;
        {
            std::jthread search([&] { found = drivers::findDmxNodes(std::chrono::seconds(1)); });
            // They answer and announce again and again until the search has found both.
            std::jthread farEnd([&](const std::stop_token& over) {
                while (!over.stop_requested()) {
                    ear.listen(20);
                    desk.send(discovery, sacnGroup(64214), 5568);
                }
            });
            search.join();
        }
        const auto has = [&](const std::string& where, const std::string& what, const std::string& options) {
            return std::any_of(found.begin(), found.end(), [&](const drivers::FoundDevice& device) {
                return device.family == "dmx" && device.where == where && device.what == what && device.options == options &&
                       !device.identity.empty() && device.why.empty();
            });
        };
        EXPECT_TRUE(has("10.77.0.2", "Art-Net node Dimmer of the test, output of port-address 291",
                        "{driver: artnet, node: 10.77.0.2, net: 1, subnet: 2, universe: 3}"));
        EXPECT_TRUE(has("10.77.0.2", "sACN source Grand Desk, sends universes 5, 256", "{driver: sacn}"));
    }
}

// What a site file may say, and the errors.
TEST_F(DmxNetwork, keys_are_read_strictly) {
    const auto refused = [](const std::string& text, int universe = 1) {
        const auto opened = drivers::openDmxPort(options(text), universe, night());
        return opened ? std::string("accepted") : opened.error().message();
    };
    EXPECT_THAT(refused("driver: sacn\npriority: 201\n"), HasSubstr("site.yaml:2:11: priority: "));
    EXPECT_THAT(refused("driver: sacn\nunicast: [lamp]\n"), HasSubstr("an address such as 10.0.0.5 is needed, here is 'lamp'"));
    EXPECT_THAT(refused("driver: sacn\nunicast: [239.255.0.1]\n"), HasSubstr("the address of a single device is needed"));
    EXPECT_THAT(refused("driver: sacn\nsync: 64000\n"), HasSubstr("site.yaml:2:7: sync: "));
    EXPECT_THAT(refused("driver: sacn\nname: " + std::string(64, 'x') + "\n"),
                HasSubstr("'name' is 64 bytes long, 63 are the most"));
    EXPECT_THAT(refused("driver: sacn\nnode: 10.0.0.5\n"), HasSubstr("node: unknown key"));
    EXPECT_THAT(refused("driver: artnet\nnode: 10.0.0.256\n"), HasSubstr("site.yaml:2:7: node: "));
    EXPECT_THAT(refused("driver: artnet\nsubnet: 2\n"), HasSubstr("'universe' is missing beside 'net' and 'subnet'"));
    EXPECT_THAT(refused("driver: artnet\nuniverse: 16\n"), HasSubstr("site.yaml:2:11: universe: "));
    EXPECT_THAT(refused("driver: artnet\n", 40000), HasSubstr("Art-Net has no port-address 40000"));
    EXPECT_EQ(refused("driver: artnet\nuniverse: 1\n", 40000), "accepted");
}

}  // namespace
}  // namespace fantascope::peers
