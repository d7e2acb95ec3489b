#pragma once
// What the rigs of all simulated backends share, and what it takes to break one.

#include "drivers/registry.h"
#include "drivers/site/world.h"

#include "contract/rig.h"
#include "core/config.h"

#include <memory>
#include <string>
#include <utility>

namespace fantascope::contract {

// Stands between the suite and a good port, and breaks a promise where a subclass says so.
template <class Port>
class Between : public Port {
public:
    Between(std::unique_ptr<Port> good, const drivers::Surroundings& around) : good_(std::move(good)), around_(around) {}
    DeviceStatus status() const override { return good_->status(); }

protected:
    bool running() const { return good_->status().state == DeviceState::Running; }

    std::unique_ptr<Port> good_;
    const drivers::Surroundings& around_;
};

// Puts something between the suite and the port; nothing by default.
template <class Port>
using Wrap = std::function<std::unique_ptr<Port>(std::unique_ptr<Port>, const drivers::Surroundings&)>;

template <class Broken, class Port>
std::unique_ptr<Port> wrappedIn(std::unique_ptr<Port> good, const drivers::Surroundings& around) {
    return std::make_unique<Broken>(std::move(good), around);
}

// A rig of the simulated site. A subclass opens the port in its constructor's end by reopen() and
// reaches the far end in world_.
template <class PortRig>
class SimulatedRig : public PortRig {
public:
    using Port = typename PortRig::PortType;

    Port& port() override { return *port_; }
    void reopen() override {
        port_.reset();  // first, so that the old one's farewell does not disturb the new one
        port_ = open();
        if (wrap_) port_ = wrap_(std::move(port_), around_);
    }
    void unplug() override { world_.setPlugged(device_, false); }
    void plugIn() override { world_.setPlugged(device_, true); }
    void letTimePass() override { clock_.advance(std::chrono::seconds(1)); }
    Clock& clock() override { return clock_; }
    Device& neighbour() override { return *neighbour_; }

protected:
    SimulatedRig(std::string device, Wrap<Port> wrap) : device_(std::move(device)), wrap_(std::move(wrap)) {}
    virtual std::unique_ptr<Port> open() = 0;

    ManualClock clock_;
    site::World world_{clock_};
    drivers::Surroundings around_{clock_, &world_};
    ConfigNode options_ = ConfigNode::parse("driver: simulated\n", "site.yaml").value();
    std::unique_ptr<Port> port_;

private:
    std::string device_;
    Wrap<Port> wrap_;
    std::unique_ptr<DmxPort> neighbour_ = drivers::openDmxPort(options_, 99, around_).value();
};

}  // namespace fantascope::contract
