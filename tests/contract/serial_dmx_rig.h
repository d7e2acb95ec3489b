#pragma once
// The rig of a universe that is sent by a serial adapter.

#include "drivers/registry.h"

#include "contract/dmx_port_suite.h"
#include "contract/eventually.h"
#include "contract/widget_socket.h"
#include "core/config/config.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace fantascope::contract {

inline bool runs(const Device& device) { return device.status().state == DeviceState::Running; }

inline ConfigNode serialOptions(const std::string& driver, const std::filesystem::path& port, const std::string& further = "") {
    return ConfigNode::parse(fmt::format("driver: {}\nport: {}\n{}", driver, port.string(), further), "site.yaml").value();
}

// Remembers whether a frame should be on the line.
class Sending final : public DmxPort {
public:
    Sending(std::unique_ptr<DmxPort> port, bool& sent) : port_(std::move(port)), sent_(sent) {}
    DeviceStatus status() const override { return port_->status(); }
    Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) override {
        TRY(port_->send(slots));
        sent_ = true;
        return {};
    }

private:
    std::unique_ptr<DmxPort> port_;
    bool& sent_;
};

// AnySocket is like Socket. Its far end has out(), the frame that its lamps get, lastOut(), the one
// that they got last, and framesOut(), the number of frames. hasTakenAll(): the far end has taken
// all that was sent before the port ran again.
template <class AnySocket>
class SerialDmxPortRig final : public DmxPortRig {
public:
    SerialDmxPortRig(std::string driver, std::unique_ptr<AnySocket> socket, std::unique_ptr<AnySocket> next)
        : driver_(std::move(driver)), socket_(std::move(socket)), next_(std::move(next)), neighbour_(open(*next_, 2)) {
        reopen();
        letTimePass();
    }

    DmxPort& port() override { return *port_; }
    void reopen() override {
        port_.reset();
        port_ = std::make_unique<Sending>(open(*socket_, 1), sent_);
    }
    void unplug() override {
        sent_ = false;
        socket_->unplug();
    }
    void plugIn() override { socket_->plugIn(); }
    void letTimePass() override {
        eventually("the port is as it was plugged", [&] { return runs(*port_) == socket_->in(); });
        if (!sent_) return;
        const int before = socket_->farEnd().framesOut();
        eventually("the far end is sent further frames", [&] { return socket_->farEnd().framesOut() >= before + 2; });
    }
    Clock& clock() override { return clock_; }
    Device& neighbour() override {
        eventually("the neighbour runs", [&] { return runs(*neighbour_); });
        return *neighbour_;
    }
    std::optional<DmxFrame> line() override { return socket_->in() ? socket_->farEnd().out() : std::nullopt; }
    std::optional<DmxFrame> lastFrame() override {
        eventually("the far end has taken what was sent", [&] { return runs(*port_) && socket_->hasTakenAll(); });
        return socket_->farEnd().lastOut();
    }

private:
    std::unique_ptr<DmxPort> open(const AnySocket& socket, int universe) {
        const auto options = ConfigNode::parse(fmt::format("driver: {}\n{}\n", driver_, socket.key()), "site.yaml");
        return drivers::openDmxPort(options.value(), universe, context_).value();
    }

    const std::string driver_;
    SteadyClock clock_;
    drivers::DriverContext context_{clock_};
    const std::unique_ptr<AnySocket> socket_, next_;
    bool sent_ = false;
    std::unique_ptr<DmxPort> neighbour_, port_;
};

}  // namespace fantascope::contract
