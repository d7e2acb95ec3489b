// The suites of both ports on both protocols, with a plain socket as the far end.

#include "contract/dmx_source_suite.h"
#include "peers/dmx_network_rig.h"

#include <gmock/gmock.h>

namespace fantascope::peers {
namespace {

using contract::DmxFrame;
using testing::IsEmpty;

class NetworkContract : public testing::TestWithParam<std::string> {
protected:
    void SetUp() override {
        if (!whyNoNetwork().empty()) GTEST_SKIP() << whyNoNetwork();
    }
};

// Sends a universe to the far end. A second universe takes the same way, by which the rig knows how
// far its line has come.
class NetworkDmxPortRig final : public contract::DmxPortRig {
public:
    explicit NetworkDmxPortRig(const std::string& protocol) : protocol_(protocol), ear_(protocol) {
        if (protocol == "sacn") {
            ear_.join(kUniverse);
            ear_.join(kMarker);
        }
        reopen();
        if (!ear_.listenUntil([&] { return runs(*port_) && runs(*marker_) && runs(*neighbour_); })) ADD_FAILURE() << why();
    }
    ~NetworkDmxPortRig() override { setLink("far", true); }

    DmxPort& port() override { return *port_; }
    void reopen() override {
        port_.reset();
        port_ = openPort(keys(), kUniverse);
    }
    void unplug() override {
        setLink("far", false);
        isIn_ = false;
    }
    void plugIn() override {
        setLink("far", true);
        isIn_ = true;
    }
    // Everything that was sent before the first of two marks is out when the second arrives.
    void letTimePass() override {
        if (!ear_.listenUntil([&] { return runs(*port_) == isIn_ && runs(*marker_) == isIn_; })) ADD_FAILURE() << why();
        ear_.forget();
        if (!isIn_) return;
        for (int time = 0; time < 2; ++time) {
            const DmxFrame mark = contract::dmxFrame(++mark_);
            EXPECT_TRUE(marker_->send(mark));
            const auto seen = [&] { return !ear_.heard[kMarker].empty() && ear_.heard[kMarker].back().slots == mark; };
            if (!ear_.listenUntil(seen)) ADD_FAILURE() << "the mark was not heard";
        }
    }
    // The repeated frame; the line is silent if nothing arrived while another universe was kept
    // alive twice.
    std::optional<DmxFrame> line() override {
        ear_.forget();
        if (!isIn_) return std::nullopt;
        constexpr std::size_t kTwice = 3 + 2;
        ear_.listenUntil([&] { return !ear_.heard[kUniverse].empty() || ear_.heard[kMarker].size() >= kTwice; });
        if (ear_.heard[kUniverse].empty()) return std::nullopt;
        return ear_.heard[kUniverse].back().slots;
    }
    // Everything has arrived when a later mark has.
    std::optional<DmxFrame> lastFrame() override {
        const DmxFrame mark = contract::dmxFrame(++mark_);
        EXPECT_TRUE(marker_->send(mark));
        const auto seen = [&] { return !ear_.heard[kMarker].empty() && ear_.heard[kMarker].back().slots == mark; };
        if (!ear_.listenUntil(seen)) ADD_FAILURE() << "the mark was not heard";
        std::optional<DmxFrame> last;
        for (const PlainLevels& levels : ear_.heard[kUniverse])
            if (levels.options != 0x40) last = levels.slots;  // slots of a terminating packet do not count
        return last;
    }
    Clock& clock() override { return testClock(); }
    Device& neighbour() override { return *neighbour_; }

private:
    static constexpr int kUniverse = 7, kMarker = 8;
    std::string keys() const {
        return "driver: " + protocol_ + "\ninterface: near\n" + (protocol_ == "artnet" ? "node: 10.77.0.2\n" : "");
    }
    std::string why() const { return port_->status().detail + " / " + marker_->status().detail; }

    std::string protocol_;
    Ear ear_;
    bool isIn_ = true;
    int mark_ = 0;
    std::unique_ptr<DmxPort> marker_ = openPort(keys(), kMarker);
    std::unique_ptr<DmxPort> neighbour_ = openPort("driver: " + protocol_ + "\ninterface: aside\n", 99);
    std::unique_ptr<DmxPort> port_;
};

TEST_P(NetworkContract, of_a_port_is_kept) {
    EXPECT_THAT(contract::violations(contract::dmxPortSuite(), [] { return std::make_unique<NetworkDmxPortRig>(GetParam()); }),
                IsEmpty());
}

// Desks at the far end, and a second universe by which the rig knows that everything before has
// arrived.
class NetworkDmxSourceRig final : public contract::DmxSourceRig {
public:
    explicit NetworkDmxSourceRig(const std::string& protocol) : protocol_(protocol) {
        reopen();
        if (!eventually([&] { return runs(*port_) && runs(*marker_) && runs(*neighbour_); })) ADD_FAILURE() << "it does not run";
    }
    ~NetworkDmxSourceRig() override { setLink("far", true); }

    DmxSource& port() override { return *port_; }
    void reopen() override {
        port_.reset();
        port_ = openSource(keys(), kUniverse);
    }
    void unplug() override {
        setLink("far", false);
        isIn_ = false;
    }
    void plugIn() override {
        setLink("far", true);
        isIn_ = true;
    }
    void letTimePass() override {
        if (!eventually([&] { return runs(*port_) == isIn_ && runs(*marker_) == isIn_; })) ADD_FAILURE() << "its state is late";
        if (!isIn_) return;
        mark_ = mark_ % 255 + 1;
        const auto marked = [&] {
            send("mark", kMarker, mark_, 100, 0);
            while (const auto frame = marker_->receive())
                if (frame->slots[0] == mark_) return true;
            return false;
        };
        if (!eventually(marked)) ADD_FAILURE() << "the mark did not come";
    }
    void deskSends(const std::string& source, int level, int priority) override { send(source, kUniverse, level, priority, 0); }
    bool deskTerminates(const std::string& source) override {
        if (!isSacn()) return false;
        for (int time = 0; time < 3; ++time) send(source, kUniverse, 0, 100, 0x40);
        return true;
    }
    bool hasPriority() const override { return isSacn(); }
    std::string deskOf(const std::string& source) override {
        for (const auto& [name, desk] : desks_)
            if (source == (isSacn() ? name + " 00000000-0000-0000-0000-0000000000" + fmt::format("{:02x}", desk.number)
                                    : "10.77.0." + std::to_string(desk.number)))
                return name;
        return "unknown: " + source;
    }
    Clock& clock() override { return testClock(); }
    Device& neighbour() override { return *neighbour_; }

private:
    static constexpr int kUniverse = 7, kMarker = 8;
    struct Desk {
        int number = 0;
        PlainSocket socket;
        std::map<int, int> sequence = {};  // per universe
    };
    bool isSacn() const { return protocol_ == "sacn"; }
    std::string keys() const { return "driver: " + protocol_ + "\ninterface: near\n"; }

    void send(const std::string& name, int universe, int level, int priority, int options) {
        Desk& desk = desks_[name];
        if (desk.number == 0) {
            desk.number = 10 + static_cast<int>(desks_.size());
            desk.socket = madeThere([&] {
                return PlainSocket("far", isSacn() ? "" : "10.77.0." + std::to_string(desk.number), isSacn() ? 0 : 6454);
            });
        }
        PlainLevels levels{.universe = universe, .priority = priority, .options = options};
        levels.sequence = desk.sequence[universe] = desk.sequence[universe] % 255 + 1;
        levels.cid.assign(15, '\0');
        levels.cid += static_cast<char>(desk.number);
        levels.name = name;
        levels.slots.fill(static_cast<std::uint8_t>(level));
        if (isSacn())
            desk.socket.send(plainSacn(levels), sacnGroup(universe), 5568);
        else
            desk.socket.send(plainArtDmx(levels), "10.77.0.1", 6454);
    }

    std::string protocol_;
    bool isIn_ = true;
    int mark_ = 0;
    std::map<std::string, Desk> desks_;
    std::unique_ptr<DmxSource> marker_ = openSource(keys(), kMarker);
    std::unique_ptr<DmxSource> neighbour_ = openSource("driver: " + protocol_ + "\ninterface: aside\n", 99);
    std::unique_ptr<DmxSource> port_;
};

TEST_P(NetworkContract, of_a_source_is_kept) {
    EXPECT_THAT(
        contract::violations(contract::dmxSourceSuite(), [] { return std::make_unique<NetworkDmxSourceRig>(GetParam()); }),
        IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Dmx, NetworkContract, testing::Values("sacn", "artnet"),
                         [](const auto& protocol) { return protocol.param; });

}  // namespace
}  // namespace fantascope::peers
