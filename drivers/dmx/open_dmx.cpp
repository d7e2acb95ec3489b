#include "drivers/dmx/open_dmx.h"

#include "core/log.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::drivers {
namespace {

// ANSI E1.11: 250 kbit/s, 8 bits and two stop bits, so 44 us a slot. The adapter's driver of the
// RS-485 line listens to RTS.
constexpr SerialSettings kDmxLine{.rate = 250'000, .parity = Parity::None, .stopBits = 2, .requestToSend = false};
constexpr Time kPacket = (1 + kDmxSlots) * std::chrono::microseconds(44);

// As long as the store of an adapter (384 bytes) takes to run empty, for one that does not say when
// it has.
constexpr Time kStore = 384 * std::chrono::microseconds(44);

// A line that has not sent a packet by then is stuck.
constexpr Time kStalled = std::chrono::seconds(1);

// How often is looked whether a packet is out, beyond the time that it must take.
constexpr Time kLookAgain = std::chrono::milliseconds(1);

// After so many packets the rate that was reached is written to the log: nobody else can tell it.
constexpr int kMeasured = 1000;

}  // namespace

Result<Opening<DmxPort>> OpenDmxPort::fromConfig(const ConfigNode& options, int universe) {
    using std::chrono::microseconds;
    Options wanted{.which = {}, .breakTime = microseconds(176), .markAfterBreak = microseconds(16), .rate = 30};
    const auto readTime = [](double least, double most) {
        return [=](const ConfigNode& node) -> Result<Time> { return fromSeconds(TRY(node.number(least, most, "us")) * 1e-6); };
    };
    std::string driver;
    ConfigFields fields(options);
    fields.text("driver", driver);
    readWidgetLine(fields, wanted.which.line);
    fields.optional().read("break", wanted.breakTime, readTime(92, 1000));  // of ANSI E1.11
    fields.optional().read("mark_after_break", wanted.markAfterBreak, readTime(12, 1000));
    fields.optional().number("rate", wanted.rate, 1, 44, "Hz");
    if (fields.right() && wanted.which.line.file.empty() && wanted.which.line.serial.empty())
        fields.check(options, options.error("'serial' or 'port' is wanted: nothing tells an Open DMX from another adapter"));
    TRY(fields.finish());
    const auto open = [=](const Surroundings& around) -> Result<std::unique_ptr<DmxPort>> {
        return std::unique_ptr<DmxPort>(new OpenDmxPort(fmt::format("universe {}", universe), wanted, around.clock));
    };
    return Opening<DmxPort>{
        .open = open, .uses = {useOf(wanted.which)}, .claim = [which = wanted.which] { return claimOf(which); }};
}

OpenDmxPort::OpenDmxPort(const std::string& name, const Options& options, Clock& clock)
    : options_(options),
      clock_(clock),
      line_(name + "'s line", widgetFinder(options.which), kDmxLine),
      service_(name, "open_dmx", LossAction::Hold, [this](Service& service) { return attend(service); }) {}

Result<void> OpenDmxPort::send(std::span<const std::uint8_t, kDmxSlots> slots) {
    if (!service_.isRunning()) return service_.refusal();
    const std::lock_guard lock(mutex_);
    newest_ = packetOf(slots);
    return {};
}

Outage OpenDmxPort::attend(Service& service) {
    if (const auto outage = line_.await(service)) return *outage;
    if (service.ending()) return {};
    const auto done = repeat(service);
    return done ? Outage{} : line_.end(done.error(), DeviceState::Faulted);
}

Result<void> OpenDmxPort::repeat(Service& service) {
    {
        const std::lock_guard lock(mutex_);
        newest_.reset();  // it was sent to another life
    }
    service.running();
    const Time period = fromSeconds(1 / options_.rate);
    int said = 0;
    Time first{};
    for (Time tick = clock_.now();; service.wait(tick - clock_.now())) {
        const bool last = service.ending();
        std::optional<DmxPacket> packet;
        {
            const std::lock_guard lock(mutex_);
            packet = newest_;
        }
        if (!packet) {
            TRY(line_.waiting());  // nothing, but it says so when the line is lost
        } else {
            if (said == 0) first = clock_.now();
            TRY(say(*packet));
            if (++said == kMeasured)
                log::info("dmx", fmt::format("{} goes out {:.1f} times a second", service.status().name,
                                             kMeasured / seconds(clock_.now() - first)));
        }
        if (last) return {};
        tick = std::max(tick + period, clock_.now());
    }
}

Result<void> OpenDmxPort::say(const DmxPacket& packet) {
    TRY(line_.setBreak(true));
    clock_.sleepUntil(clock_.now() + options_.breakTime);
    TRY(line_.setBreak(false));
    clock_.sleepUntil(clock_.now() + options_.markAfterBreak);
    const Time begun = clock_.now();
    for (std::span<const std::uint8_t> rest = packet; !rest.empty();) {
        rest = rest.subspan(TRY(line_.write(rest)));
        if (!rest.empty()) clock_.sleepUntil(clock_.now() + kLookAgain);
        if (clock_.now() >= begun + kStalled) return Error("it takes no more bytes");
    }
    // A break reaches the line at once, ahead of bytes that still wait in the adapter: it may begin
    // only when all are out.
    clock_.sleepUntil(begun + kPacket);
    for (Time handedOver = clock_.now(); clock_.now() < handedOver + kStore && !TRY(line_.isDrained());) {
        clock_.sleepUntil(clock_.now() + kLookAgain);
        if (TRY(line_.waiting()) > 0) handedOver = clock_.now();
        if (handedOver >= begun + kStalled) return Error("its packets do not get out");
    }
    return {};
}

}  // namespace fantascope::drivers
