// sACN and Art-Net with OLA (the Open Lighting Architecture) as receiver and as sender, and with
// Wireshark's decoder.

#include "peers/dmx_network_rig.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace fantascope::peers {
namespace {

namespace fs = std::filesystem;
using contract::dmxFrame;
using testing::IsEmpty;

constexpr int kSacnUniverses = 12, kArtnetUniverses = 4, kFrames = 400;
constexpr int kSacnToOla = 101, kArtnetToOla = 17, kSacnFromOla = 201,
              kArtnetFromOla = 37;  // OLA's own numbers of the first universes
constexpr int kNibble = 16;         // Art-Net's universe is the last four bits of OLA's number

std::string contentsOf(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

// A frame that shows its number, and differs in every slot from those around it.
Slots numbered(int universe, int number) {
    Slots slots;
    for (int slot = 0; slot < 512; ++slot)
        slots[static_cast<std::size_t>(slot)] =
            static_cast<std::uint8_t>(3 * slot + 31 * universe + 7 * number + number * slot / 64);
    slots[0] = static_cast<std::uint8_t>(number);
    slots[1] = static_cast<std::uint8_t>(number >> 8);
    return slots;
}
int numberOf(const Slots& slots) { return slots[1] << 8 | slots[0]; }

// OLA's daemon at the far end, with some universes of each protocol in both directions.
class Ola {
public:
    Ola() {
        fs::create_directory(folder_ / "settings");
        fs::permissions(folder_.path(), fs::perms::all);
        fs::permissions(folder_ / "settings", fs::perms::all);
        for (const char* plugin : {"dummy",    "espnet",  "ftdidmx",          "gpio",    "karate",   "kinet",  "milinst",
                                   "nanoleaf", "opendmx", "openpixelcontrol", "osc",     "pathport", "renard", "sandnet",
                                   "shownet",  "spi",     "stageprofi",       "uartdmx", "usbdmx",   "usbpro", "usbserial"})
            write(plugin, "enabled = false\n");
        write("e131", fmt::format("enabled = true\nip = 10.77.0.2\ninput_ports = {0}\noutput_ports = {0}\n", kSacnUniverses));
        write("artnet", fmt::format("enabled = true\nip = 10.77.0.2\nnet = 0\nsubnet = 0\noutput_ports = {}\n"
                                    "always_broadcast = true\nuse_limited_broadcast = false\nuse_loopback = false\n",
                                    kArtnetUniverses));
        start();
    }

    void start() {
        there([&] {
            daemon_ = Peer({"olad", "-c", folder_ / "settings", "--no-http", "--no-register-with-dns-sd", "-l", "3"},
                           folder_ / "olad.log", true);
        });
        isReady_ = eventually([&] { return devices().find("E1.31") != std::string::npos; });
        const std::string sacn = deviceNumber("E1.31"), artnet = deviceNumber("ArtNet");
        isReady_ = isReady_ && !sacn.empty() && !artnet.empty();
        for (int port = 0; isReady_ && port < kSacnUniverses; ++port) {
            patch(sacn, port, kSacnToOla + port, true);
            patch(sacn, port, kSacnFromOla + port, false);
        }
        for (int port = 0; isReady_ && port < kArtnetUniverses; ++port) {
            patch(artnet, port, kArtnetToOla + port, true);
            patch(artnet, port, kArtnetFromOla + port, false);
        }
    }
    void stop() { daemon_.stop(SIGTERM); }
    bool isReady() const { return isReady_; }
    std::string log() const { return contentsOf(folder_ / "olad.log") + contentsOf(folder_ / "tools.log"); }

    // Begins to record all incoming universes; the second function ends it and returns each
    // universe's frames.
    void record() {
        std::string universes;
        for (int port = 0; port < kSacnUniverses; ++port) universes += fmt::format("{},", kSacnToOla + port);
        for (int port = 0; port < kArtnetUniverses; ++port) universes += fmt::format("{},", kArtnetToOla + port);
        universes.pop_back();
        fs::remove(folder_ / "recorder.log");
        there([&] { recorder_ = Peer({"ola_recorder", "-r", folder_ / "recorded", "-u", universes}, folder_ / "recorder.log"); });
        EXPECT_TRUE(eventually([&] { return contentsOf(folder_ / "recorder.log").find("Recording") != std::string::npos; }));
    }
    std::map<int, std::vector<Slots>> recorded() {
        recorder_.stop(SIGINT);
        std::map<int, std::vector<Slots>> frames;
        std::ifstream file(folder_ / "recorded");
        std::string line;
        while (std::getline(file, line)) {
            std::istringstream text(line);
            int universe = 0, value = 0;
            char comma = 0;
            if (!(text >> universe >> value)) continue;  // the title, or a pause
            Slots slots{};
            slots[0] = static_cast<std::uint8_t>(value);
            for (std::size_t slot = 1; slot < 512 && text >> comma >> value; ++slot)
                slots[slot] = static_cast<std::uint8_t>(value);
            frames[universe].push_back(slots);
        }
        return frames;
    }

    // Begins to play frames 1 .. count on all outgoing universes.
    void play(int count) {
        std::ofstream show(folder_ / "played");
        show << "OLA Show\n";
        const char* pause = "";
        const auto add = [&](int universe, int number) {
            show << pause << universe << ' ' << fmt::format("{}", fmt::join(numbered(universe, number), ",")) << '\n';
            pause = "0\n";
        };
        for (int number = 1; number <= count; ++number) {
            for (int port = 0; port < kSacnUniverses; ++port) add(kSacnFromOla + port, number);
            for (int port = 0; port < kArtnetUniverses; ++port) add(kArtnetFromOla + port, number);
            pause = "20\n";
        }
        // The player omits the last entry of its file.
        add(kSacnFromOla, count + 1);
        show.close();
        there([&] { player_ = Peer({"ola_recorder", "-p", folder_ / "played"}, folder_ / "tools.log"); });
    }
    bool isPlaying() { return player_.isRunning(); }

private:
    void write(const std::string& plugin, const std::string& text) {
        const fs::path file = folder_.file("settings/ola-" + plugin + ".conf", text);
        fs::permissions(file, fs::perms::all);
    }
    std::string devices() {
        fs::remove(folder_ / "devices");
        there([&] { runPeer({"ola_dev_info"}, folder_ / "devices"); });
        return contentsOf(folder_ / "devices");
    }
    // "1" of "Device 1: E1.31 (DMX over ACN) [10.77.0.2]".
    std::string deviceNumber(const std::string& name) {
        std::istringstream lines(devices());
        for (std::string line; std::getline(lines, line);)
            if (line.starts_with("Device ") && line.find(name) != std::string::npos) return line.substr(7, line.find(':') - 7);
        return "";
    }
    void patch(const std::string& device, int port, int universe, bool input) {
        std::vector<std::string> arguments = {
            "ola_patch", "-d", device, "-p", std::to_string(port), "-u", std::to_string(universe)};
        if (input) arguments.emplace_back("-i");
        there([&] { isReady_ = isReady_ && runPeer(arguments, folder_ / "tools.log") == 0; });
    }

    ScratchFolder folder_;
    Peer daemon_, recorder_, player_;
    bool isReady_ = false;
};

class DmxNetworkOla : public testing::Test {
protected:
    void SetUp() override {
        if (!whyNoNetwork().empty()) GTEST_SKIP() << whyNoNetwork();
        if (!isInstalled("olad")) GTEST_SKIP() << "OLA is not installed (tools/peers)";
    }
};

// Our universes that OLA receives, all sent at the same ticks.
struct Outward {
    Outward() {
        for (int i = 0; i < kSacnUniverses; ++i) {
            ports.push_back(openPort("driver: sacn\ninterface: near\n", kSacnToOla + i));
            universes.push_back(kSacnToOla + i);
        }
        for (int i = 0; i < kArtnetUniverses; ++i) {
            ports.push_back(openPort(fmt::format("driver: artnet\ninterface: near\nuniverse: {}\n", (kArtnetToOla + i) % kNibble),
                                     kArtnetToOla + i));
            universes.push_back(kArtnetToOla + i);
        }
        for (int i = 0; i < kSacnUniverses; ++i) sacn.join(kSacnToOla + i);
    }
    bool areRunning() {
        return eventually([&] { return std::all_of(ports.begin(), ports.end(), [](const auto& port) { return runs(*port); }); });
    }
    // Sends frame `number` of every universe and waits until each has been on the wire.
    bool send(int number) {
        for (std::size_t i = 0; i < ports.size(); ++i)
            if (!ports[i]->send(numbered(universes[i], number))) return false;
        return eventually([&] {
            sacn.listen(1);
            artnet.listen(1);
            return std::all_of(universes.begin(), universes.end(), [&](int universe) {
                const auto& heard = universe >= kSacnToOla ? sacn.heard[universe] : artnet.heard[universe % kNibble];
                return !heard.empty() && heard.back().slots == numbered(universe, number);
            });
        });
    }

    std::vector<std::unique_ptr<DmxPort>> ports;
    std::vector<int> universes;
    Ear sacn{"sacn"}, artnet{"artnet", false};
};

TEST_F(DmxNetworkOla, gets_every_frame_of_sixteen_universes_and_we_get_all_of_its) {
    Ola ola;
    ASSERT_TRUE(ola.isReady()) << ola.log();
    Outward out;
    std::map<int, std::unique_ptr<DmxSource>> sources;
    for (int i = 0; i < kSacnUniverses; ++i)
        sources[kSacnFromOla + i] = openSource("driver: sacn\ninterface: near\n", kSacnFromOla + i);
    for (int i = 0; i < kArtnetUniverses; ++i)
        sources[kArtnetFromOla + i] =
            openSource(fmt::format("driver: artnet\ninterface: near\nuniverse: {}\n", (kArtnetFromOla + i) % kNibble), 1 + i);
    ASSERT_TRUE(out.areRunning());
    ASSERT_TRUE(eventually(
        [&] { return std::all_of(sources.begin(), sources.end(), [](const auto& source) { return runs(*source.second); }); }));

    std::map<int, std::vector<DmxInput>> received;
    const auto take = [&] {
        for (auto& [universe, source] : sources)
            for (auto frame = source->receive(); frame; frame = source->receive()) received[universe].push_back(*frame);
    };
    ola.record();
    ola.play(kFrames);
    // Further frames let OLA catch up before its recorder is stopped.
    constexpr int kMore = 60;
    for (int number = 1; number <= kFrames + kMore; ++number) {
        ASSERT_TRUE(out.send(number)) << number;
        take();
    }
    ASSERT_TRUE(eventually([&] {
        take();
        return !ola.isPlaying();
    }));
    ASSERT_TRUE(eventually([&] {
        take();
        return std::all_of(sources.begin(), sources.end(), [&](const auto& source) {
            const auto& frames = received[source.first];
            return !frames.empty() && numberOf(frames.back().slots) >= kFrames;
        });
    })) <<
        [&] {
            std::string lasts;
            for (const auto& [universe, frames] : received)
                lasts += fmt::format("{}: {} frames up to {}\n", universe, frames.size(), numberOf(frames.back().slots));
            return lasts + ola.log();
        }();

    int toOla = 0, fromOla = 0;
    const auto recorded = ola.recorded();
    for (const int universe : out.universes) {
        SCOPED_TRACE(universe);
        ASSERT_TRUE(recorded.contains(universe)) << ola.log();
        int last = 0;
        for (const Slots& slots : recorded.at(universe)) {
            const int number = numberOf(slots);
            ASSERT_EQ(slots, numbered(universe, number));
            // The recorder starts with one universe after the other while the first frames are
            // being sent.
            constexpr int kUntilItListens = 20;
            ASSERT_TRUE(number == last || number == last + 1 || (last == 0 && number <= kUntilItListens))
                << last << ", " << number;
            toOla += number != last;
            last = number;
        }
        EXPECT_GE(last, kFrames);
        EXPECT_EQ(out.ports[0]->status().losses, 0);
    }
    for (const auto& [universe, frames] : received) {
        SCOPED_TRACE(universe);
        int last = 0;
        for (const DmxInput& frame : frames) {
            const int number = numberOf(frame.slots);
            ASSERT_EQ(frame.slots, numbered(universe, number));
            ASSERT_TRUE(number == last || number == last + 1) << last << ", " << number;
            ASSERT_EQ(frame.priority, 100);
            ASSERT_EQ(frame.source, frames.front().source);
            fromOla += number != last;
            last = number;
        }
        EXPECT_GE(last, kFrames);
    }
    EXPECT_GE(toOla + fromOla, 10'000) << toOla << " to OLA, " << fromOla << " from OLA";
    RecordProperty("frames", toOla + fromOla);
}

// OLA merges by priority like our DmxMerge, so its output shows whether it has read our priority
// and our termination.
TEST_F(DmxNetworkOla, takes_our_priority_and_our_termination_and_after_its_restart_our_levels) {
    Ola ola;
    ASSERT_TRUE(ola.isReady()) << ola.log();
    const auto openAs = [](const std::string& site, int priority) {
        return drivers::openDmxPort(
                   ConfigNode::parse(fmt::format("driver: sacn\ninterface: near\npriority: {}\n", priority), site).value(),
                   kSacnToOla, night())
            .value();
    };
    Ear ear("sacn");
    ear.join(kSacnToOla);
    const auto low = openAs("low/site.yaml", 90);
    auto high = openAs("high/site.yaml", 110);
    ASSERT_TRUE(ear.listenUntil([&] { return runs(*low) && runs(*high); }));
    int sentNumber = 0;
    const auto carried = [&]() -> std::string {
        ola.record();
        // Enough that both have been received again.
        EXPECT_TRUE(low->send(numbered(1, ++sentNumber)));
        EXPECT_TRUE(!high || high->send(numbered(2, sentNumber)));
        ear.forget();
        EXPECT_TRUE(ear.listenUntil([&] { return ear.heard[kSacnToOla].size() >= 8; }));
        const auto frames = ola.recorded()[kSacnToOla];
        if (frames.empty()) return "nothing";
        return frames.back() == numbered(1, sentNumber)   ? "low"
               : frames.back() == numbered(2, sentNumber) ? "high"
                                                          : "something else";
    };
    EXPECT_EQ(carried(), "high");
    high.reset();
    EXPECT_EQ(carried(), "low") << "the other terminated its stream";
    ola.stop();
    ola.start();
    ASSERT_TRUE(ola.isReady()) << ola.log();
    EXPECT_EQ(carried(), "low");
    EXPECT_EQ(low->status().losses, 0) << "a receiver that restarts is none of ours";
}

class DmxNetworkCapture : public testing::Test {
protected:
    void SetUp() override {
        if (!whyNoNetwork().empty()) GTEST_SKIP() << whyNoNetwork();
        if (!isInstalled("tshark")) GTEST_SKIP() << "tshark is not installed (tools/peers)";
    }
};

// Everything that we send, as read by another program's decoder.
TEST_F(DmxNetworkCapture, every_packet_is_decoded_by_wireshark_without_a_complaint) {
    const ScratchFolder folder;
    fs::permissions(folder.path(), fs::perms::all);
    const std::string capture = folder / "capture.pcap", log = folder / "capture.log";
    Peer recorder({"dumpcap", "-q", "-i", "near", "-f", "udp", "-w", capture}, log);
    ASSERT_TRUE(eventually([&] { return contentsOf(log).find("File:") != std::string::npos; })) << contentsOf(log);
    {
        Ear sacn("sacn"), artnet("artnet");
        for (const int universe : {7, 8, 64214}) sacn.join(universe);
        std::vector<std::unique_ptr<DmxPort>> ports;
        ports.push_back(openPort("driver: sacn\ninterface: near\nsync: 50\nname: Place of the Café\n", 7));
        ports.push_back(openPort("driver: sacn\ninterface: near\npreview: true\npriority: 0\n", 8));
        ports.push_back(openPort("driver: artnet\ninterface: near\nsync: true\n", 7));
        ports.push_back(openPort("driver: artnet\ninterface: near\nnode: 10.77.0.2\nnet: 127\nsubnet: 15\nuniverse: 15\n", 8));
        const auto in = openSource("driver: artnet\ninterface: near\n", 12);
        const auto listenUntil = [&](const std::function<bool()>& condition) {
            return eventually([&] {
                sacn.listen();
                artnet.listen();
                return condition();
            });
        };
        ASSERT_TRUE(
            listenUntil([&] { return std::all_of(ports.begin(), ports.end(), [](const auto& port) { return runs(*port); }); }));
        PlainSocket controller = madeThere([] { return PlainSocket("far", "10.77.0.11", 6454); });
        controller.send(plainArtPoll(), "10.77.0.1", 6454);
        for (int frame = 0; frame < 30; ++frame) {
            for (const auto& port : ports) ASSERT_TRUE(port->send(dmxFrame(frame)));
            ASSERT_TRUE(listenUntil([&] {
                const auto has = [&](Ear& ear, int universe) {
                    return !ear.heard[universe].empty() && ear.heard[universe].back().slots == dmxFrame(frame);
                };
                return has(sacn, 7) && has(sacn, 8) && has(artnet, 7) && has(artnet, 0x7fff);
            }));
        }
        ASSERT_TRUE(listenUntil([&] {
            return std::any_of(sacn.packets.begin(), sacn.packets.end(),
                               [](const Datagram& packet) { return packet.size() == 124; });
        })) << "its universes are announced";
        ports.clear();
        ASSERT_TRUE(listenUntil([&] { return !sacn.heard[7].empty() && sacn.heard[7].back().options & 0x40; }));
    }
    // Waits until the capture has the last packet.
    const auto decoded = [&](const std::string& filter) {
        const std::string out = folder / "decoded";
        fs::remove(out);
        runPeer({"tshark", "--enable-heuristic", "acn", "-o", "acn.dmx_enable:TRUE", "-r", capture, "-Y", filter, "-T", "fields",
                 "-e", "frame.number", "-e", "_ws.expert.message"},
                out);
        std::istringstream lines(contentsOf(out));
        std::vector<std::string> packets;
        for (std::string line; std::getline(lines, line);)
            if (!line.empty() && std::isdigit(static_cast<unsigned char>(line[0]))) packets.push_back(line);
        return packets;
    };
    const std::string ours = "ip.src == 10.77.0.1 && ";
    const std::string terminations = ours + "acn.dmx.universe == 7 && acn.dmx.option_s == 1";
    EXPECT_TRUE(eventually([&] { return decoded(terminations).size() >= 3; })) << contentsOf(log);
    recorder.stop(SIGINT);
    EXPECT_GE(decoded(ours + "acn.dmx.universe == 7 && acn.dmx.source_name == \"Place of the Café\"").size(), 30u);
    EXPECT_GE(decoded(ours + "acn.dmx.universe == 8 && acn.dmx.priority == 0 && acn.dmx.option_p == 1").size(), 30u);
    EXPECT_EQ(decoded(terminations).size(), 3u);
    EXPECT_GE(decoded(ours + "artnet.output.universe == 7").size(), 30u);
    EXPECT_GE(decoded(ours + "artnet.output.universe == 0x7fff && ip.dst == 10.77.0.2").size(), 30u);
    EXPECT_GE(decoded(ours + "artnet.header.opcode == 0x5200").size(), 30u) << "ArtSync";
    EXPECT_GE(decoded(ours + "artnet.header.opcode == 0x2000").size(), 1u) << "ArtPoll";
    EXPECT_GE(decoded(ours + "artnet.header.opcode == 0x2100").size(), 3u) << "ArtPollReply";
    // This decoder does not know sACN's sync and discovery packets; it knows all others.
    const std::string known = ours + "(udp.port == 6454 || (udp.port == 5568 && frame.len == 680))";
    EXPECT_THAT(decoded(known + " && !acn && !artnet"), IsEmpty());
    EXPECT_THAT(decoded(ours + "(_ws.malformed || _ws.expert.severity >= 6291456)"), IsEmpty());
}

}  // namespace
}  // namespace fantascope::peers
