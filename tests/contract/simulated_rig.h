#pragma once
// The common base of all simulated rigs, and the tools to break one.

#include "drivers/registry.h"
#include "drivers/site/world.h"

#include "contract/rig.h"
#include "core/config/config.h"

#include <memory>
#include <string>
#include <utility>

namespace fantascope::contract {

// Stands between the suite and a good port; a subclass breaks a promise.
template <class Port>
class Between : public Port {
public:
    Between(std::unique_ptr<Port> good, const drivers::DriverContext& context) : good_(std::move(good)), context_(context) {}
    DeviceStatus status() const override { return good_->status(); }

protected:
    bool running() const { return good_->status().state == DeviceState::Running; }

    std::unique_ptr<Port> good_;
    const drivers::DriverContext& context_;
};

// Wraps the port; does nothing by default.
template <class Port>
using Wrap = std::function<std::unique_ptr<Port>(std::unique_ptr<Port>, const drivers::DriverContext&)>;

template <class Broken, class Port>
std::unique_ptr<Port> wrappedIn(std::unique_ptr<Port> good, const drivers::DriverContext& context) {
    return std::make_unique<Broken>(std::move(good), context);
}

// A rig of the simulated site. A subclass opens the port with reopen() at the end of its
// constructor, and reaches the far end through world_.
template <class PortRig>
class SimulatedRig : public PortRig {
public:
    using Port = typename PortRig::PortType;

    Port& port() override { return *port_; }
    void reopen() override {
        port_.reset();  // first, so that the old port's last actions do not disturb the new one
        port_ = open();
        if (wrap_) port_ = wrap_(std::move(port_), context_);
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
    drivers::DriverContext context_{clock_, &world_};
    ConfigNode options_ = ConfigNode::parse("driver: simulated\n", "site.yaml").value();
    std::unique_ptr<Port> port_;

private:
    std::string device_;
    Wrap<Port> wrap_;
    std::unique_ptr<DmxPort> neighbour_ = drivers::openDmxPort(options_, 99, context_).value();
};

}  // namespace fantascope::contract
