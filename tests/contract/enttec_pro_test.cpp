#include "contract/dmx_source_suite.h"
#include "contract/serial_dmx_rig.h"

#include <gmock/gmock.h>

#include <deque>

namespace fantascope::contract {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

ConfigNode optionsFor(const WidgetSocket& socket, const std::string& further = "") {
    return serialOptions("enttec_pro", socket.file(), further);
}

TEST(DmxPortContract, is_kept_by_a_widget) {
    const auto socket = [] { return std::make_unique<WidgetSocket>(); };
    EXPECT_THAT(violations(dmxPortSuite(),
                           [&] { return std::make_unique<SerialDmxPortRig<WidgetSocket>>("enttec_pro", socket(), socket()); }),
                IsEmpty());
}

// Gives the port's frames, except the marks by which the rig sees how far the port has come.
class Marked final : public DmxSource {
public:
    static constexpr std::uint8_t kMark = 255;
    explicit Marked(std::unique_ptr<DmxSource> source) : source_(std::move(source)) {}
    DeviceStatus status() const override { return source_->status(); }
    std::optional<DmxInput> receive() override {
        if (taken_.empty()) return source_->receive();
        const DmxInput oldest = taken_.front();
        taken_.pop_front();
        return oldest;
    }
    // Whether the mark has come.
    bool advance() {
        while (auto frame = source_->receive()) {
            if (frame->slots[0] == kMark) return true;
            taken_.push_back(*frame);
        }
        return false;
    }

private:
    std::unique_ptr<DmxSource> source_;
    std::deque<DmxInput> taken_;
};

class EnttecSourceRig final : public DmxSourceRig {
public:
    EnttecSourceRig() {
        reopen();
        letTimePass();
    }

    DmxSource& port() override { return *port_; }
    void reopen() override {
        port_.reset();
        port_ = std::make_unique<Marked>(drivers::openDmxSource(optionsFor(socket_), 1, context_).value());
    }
    void unplug() override { socket_.unplug(); }
    void plugIn() override { socket_.plugIn(); }
    void letTimePass() override {
        eventually("the port is as it was plugged", [&] { return runs(*port_) == socket_.in(); });
        if (!socket_.in()) return;
        eventually("the widget is told to receive", [&] { return socket_.widget().wasToldToReceive(); });
        deskSends("a", Marked::kMark, 100);
        eventually("what came in arrives", [&] { return port_->advance(); });
    }
    Clock& clock() override { return clock_; }
    Device& neighbour() override {
        eventually("the neighbour runs", [&] { return runs(*neighbour_); });
        return *neighbour_;
    }

    void deskSends(const std::string&, int level, int) override {
        if (socket_.in()) socket_.widget().comesIn(std::vector<std::uint8_t>(kDmxSlots, static_cast<std::uint8_t>(level)));
    }
    bool deskTerminates(const std::string&) override { return false; }
    bool hasPriority() const override { return false; }
    bool hasSenders() const override { return false; }
    std::string deskOf(const std::string& source) override { return source == "01234567" ? "a" : "somebody else"; }

private:
    SteadyClock clock_;
    drivers::DriverContext context_{clock_};
    WidgetSocket socket_, next_;
    std::unique_ptr<DmxSource> neighbour_ = drivers::openDmxSource(optionsFor(next_), 2, context_).value();
    std::unique_ptr<Marked> port_;
};

TEST(DmxSourceContract, is_kept_by_a_widget) {
    EXPECT_THAT(violations(dmxSourceSuite(), [] { return std::make_unique<EnttecSourceRig>(); }), IsEmpty());
}

class EnttecProTest : public testing::Test {
protected:
    std::unique_ptr<DmxPort> open(const WidgetSocket& socket, const std::string& further = "") {
        return drivers::openDmxPort(optionsFor(socket, further), 1, context_).value();
    }
    static void awaitState(const Device& device, DeviceState state) {
        eventually(nameOf(state), [&] { return device.status().state == state; });
    }
    static void awaitFrames(const Widget& widget, int more) {
        const int before = widget.framesOut();
        eventually("frames", [&] { return widget.framesOut() >= before + more; });
    }

    SteadyClock clock_;
    drivers::DriverContext context_{clock_};
};

TEST_F(EnttecProTest, the_widget_hears_nothing_but_whole_messages) {
    WidgetSocket socket;
    const auto port = open(socket);
    awaitState(*port, DeviceState::Running);
    ASSERT_TRUE(port->send(dmxFrame(1)));
    awaitFrames(socket.widget(), 50);  // long enough for the check whether it is still there
    EXPECT_EQ(socket.widget().complaint(), "");
}

TEST_F(EnttecProTest, the_last_frame_goes_out_when_the_port_closes) {
    WidgetSocket socket;
    auto port = open(socket);
    awaitState(*port, DeviceState::Running);
    ASSERT_TRUE(port->send(dmxFrame(1)));
    awaitFrames(socket.widget(), 1);
    ASSERT_TRUE(port->send(dmxFrame(2)));
    port.reset();
    eventually("the last frame", [&] { return socket.widget().out() == dmxFrame(2); });
    EXPECT_EQ(socket.widget().complaint(), "");
}

TEST_F(EnttecProTest, parameters_are_written_only_where_they_differ) {
    WidgetSocket socket;
    auto port = open(socket, "break: 176\nmark_after_break: 16\nrate: 30\n");
    awaitState(*port, DeviceState::Running);
    EXPECT_EQ(socket.widget().parameters().breakTime, 17) << "181.4 us, the first unit that is no shorter than asked for";
    EXPECT_EQ(socket.widget().parameters().markAfterBreak, 2);
    EXPECT_EQ(socket.widget().parameters().rate, 30);
    EXPECT_EQ(socket.widget().parametersWritten(), 1);
    port.reset();
    port = open(socket, "rate: 30\n");
    awaitState(*port, DeviceState::Running);
    EXPECT_EQ(socket.widget().parametersWritten(), 1) << "its memory wears out";
    EXPECT_EQ(socket.widget().complaint(), "");
}

TEST_F(EnttecProTest, another_widget_in_its_place_is_faulted_with_both_numbers) {
    WidgetSocket socket("76543210");
    const auto port = open(socket, "number: '01234567'\n");
    awaitState(*port, DeviceState::Faulted);
    EXPECT_EQ(port->status().detail, socket.file().string() + ": it is widget 76543210, not 01234567");
    EXPECT_EQ(port->status().losses, 0);
    EXPECT_FALSE(port->send(dmxFrame(1)));
}

TEST_F(EnttecProTest, a_widget_that_takes_no_more_bytes_is_faulted_and_the_port_never_waits) {
    WidgetSocket socket;
    auto port = open(socket);
    awaitState(*port, DeviceState::Running);
    ASSERT_TRUE(port->send(dmxFrame(1)));
    socket.widget().stopReading();
    eventually("fault", [&] { return !port->send(dmxFrame(2)); });
    EXPECT_EQ(port->status().state, DeviceState::Faulted);
    port.reset();  // returns, although the bytes can go nowhere
}

TEST_F(EnttecProTest, a_message_that_another_program_broke_off_is_ended) {
    WidgetSocket socket;
    socket.widget().hasHeard({0x7e, 6, 1, 2, 0, 1, 2, 3});
    const auto port = open(socket);
    awaitState(*port, DeviceState::Running);
}

TEST_F(EnttecProTest, a_pull_in_the_middle_of_a_write_is_one_loss) {
    WidgetSocket socket;
    const auto port = open(socket);
    for (int time = 0; time < 3; ++time) {
        awaitState(*port, DeviceState::Running);
        EXPECT_EQ(port->status().losses, time);
        ASSERT_TRUE(port->send(dmxFrame(time)));
        awaitFrames(socket.widget(), 1);
        socket.unplug();
        awaitState(*port, DeviceState::Absent);
        socket.plugIn();
    }
}

TEST_F(EnttecProTest, a_widget_is_an_output_or_an_input_and_the_second_says_so) {
    WidgetSocket socket;
    const auto port = open(socket);
    awaitState(*port, DeviceState::Running);
    const auto source = drivers::openDmxSource(optionsFor(socket), 2, context_).value();
    awaitState(*source, DeviceState::Faulted);
    EXPECT_THAT(source->status().detail, HasSubstr("in use, by another device of this site or by another program"));
}

TEST_F(EnttecProTest, what_is_no_widget_is_faulted) {
    WidgetSocket socket;
    socket.widget().fallSilent();
    const auto port = open(socket);
    awaitState(*port, DeviceState::Faulted);
    EXPECT_EQ(port->status().detail, socket.file().string() + ": it does not answer as a DMX USB PRO does");
}

TEST_F(EnttecProTest, only_frames_of_levels_that_came_in_well_are_given) {
    WidgetSocket socket;
    const auto source = drivers::openDmxSource(optionsFor(socket), 1, context_).value();
    eventually("receiving", [&] { return socket.widget().wasToldToReceive(); });
    const std::vector<std::uint8_t> slots(kDmxSlots, 9), few(24, 7);
    socket.widget().comesIn(slots, 0xcc);  // a query to a configurable lamp
    socket.widget().comesIn(slots, 0, 1);  // the widget could not keep up
    socket.widget().comesIn(few);
    std::optional<DmxInput> frame;
    eventually("a frame", [&] { return (frame = source->receive()).has_value(); });
    EXPECT_EQ(frame->slots[23], 7);
    EXPECT_EQ(frame->slots[24], 0) << "a desk need not send all slots";
}

TEST_F(EnttecProTest, keys_are_strict) {
    const auto refusal = [&](const std::string& keys) {
        const auto node = ConfigNode::parse("driver: enttec_pro\n" + keys, "site.yaml").value();
        const auto port = drivers::openDmxPort(node, 1, context_);
        return port ? "accepted" : port.error().message();
    };
    EXPECT_THAT(refusal("port: ttyUSB0\n"), HasSubstr("a device file is needed"));
    EXPECT_THAT(refusal("port: /dev/ttyUSB0\nserial: EN1\n"), HasSubstr("'port' already chooses"));
    EXPECT_THAT(refusal("number: 1234\n"), HasSubstr("eight digits"));
    EXPECT_THAT(refusal("break: 40\n"), HasSubstr("us"));
    EXPECT_THAT(refusal("rate: 44\n"), HasSubstr("40"));
    EXPECT_THAT(refusal("speed: 3\n"), HasSubstr("unknown key"));
    EXPECT_EQ(refusal("serial: EN1\nnumber: '01234567'\n"), "accepted") << "a device that is not there is no error";
}

}  // namespace
}  // namespace fantascope::contract
