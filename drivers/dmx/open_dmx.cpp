#include "drivers/dmx/open_dmx.h"

#include "core/log.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::drivers {
namespace {

// ANSI E1.11: 250 kbit/s, 8 data bits and two stop bits, so 44 us a slot. RTS off enables the
// adapter's RS-485 driver.
constexpr SerialSettings kDmxLine{.rate = 250'000, .parity = Parity::None, .stopBits = 2, .requestToSend = false};
constexpr Time kPacket = (1 + kDmxSlots) * std::chrono::microseconds(44);

// How long an adapter's buffer (384 bytes) takes to empty, for adapters that do not report it.
constexpr Time kStore = 384 * std::chrono::microseconds(44);

// A line that has not sent a packet by then is stuck.
constexpr Time kStalled = std::chrono::seconds(1);

// How often to check whether a packet has left, beyond the time that it must take.
constexpr Time kLookAgain = std::chrono::milliseconds(1);

// After this many packets the achieved rate is logged, because nothing else shows it.
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
        fields.check(options, options.error("'serial' or 'port' is needed: an Open DMX cannot be told from other adapters"));
    TRY(fields.finish());
    const auto open = [=](const DriverContext& context) -> Result<std::unique_ptr<DmxPort>> {
        return std::unique_ptr<DmxPort>(new OpenDmxPort(fmt::format("universe {}", universe), wanted, context.clock));
    };
    return Opening<DmxPort>{
        .open = open, .uses = {useOf(wanted.which)}, .claim = [which = wanted.which] { return claimOf(which); }};
}

OpenDmxPort::OpenDmxPort(const std::string& name, const Options& options, Clock& clock)
    : options_(options),
      clock_(clock),
      line_(name + "'s line", widgetFinder(options.which), kDmxLine),
      service_(name, "open_dmx", LossAction::Hold, [this](Service& service) { return runOnce(service); }) {}

Result<void> OpenDmxPort::send(std::span<const std::uint8_t, kDmxSlots> slots) {
    if (!service_.isRunning()) return service_.refusal();
    const std::lock_guard lock(mutex_);
    newest_ = packetOf(slots);
    return {};
}

Outage OpenDmxPort::runOnce(Service& service) {
    if (const auto outage = line_.awaitRunning(service)) return *outage;
    if (service.ending()) return {};
    const auto done = repeat(service);
    return done ? Outage{} : line_.drop(done.error(), DeviceState::Faulted);
}

Result<void> OpenDmxPort::repeat(Service& service) {
    {
        const std::lock_guard lock(mutex_);
        newest_.reset();  // from before this life
    }
    service.setRunning();
    const Time period = fromSeconds(1 / options_.rate);
    int sent = 0;
    Time first{};
    for (Time tick = clock_.now();; service.wait(tick - clock_.now())) {
        const bool last = service.ending();
        std::optional<DmxPacket> packet;
        {
            const std::lock_guard lock(mutex_);
            packet = newest_;
        }
        if (!packet) {
            TRY(line_.unsent());  // reports a lost line
        } else {
            if (sent == 0) first = clock_.now();
            TRY(sendPacket(*packet));
            if (++sent == kMeasured)
                log::info("dmx", fmt::format("{} is sent {:.1f} times a second", service.status().name,
                                             kMeasured / seconds(clock_.now() - first)));
        }
        if (last) return {};
        tick = std::max(tick + period, clock_.now());
    }
}

Result<void> OpenDmxPort::sendPacket(const DmxPacket& packet) {
    TRY(line_.setBreak(true));
    clock_.sleepUntil(clock_.now() + options_.breakTime);
    TRY(line_.setBreak(false));
    clock_.sleepUntil(clock_.now() + options_.markAfterBreak);
    const Time begun = clock_.now();
    for (std::span<const std::uint8_t> rest = packet; !rest.empty();) {
        rest = rest.subspan(TRY(line_.write(rest)));
        if (!rest.empty()) clock_.sleepUntil(clock_.now() + kLookAgain);
        if (clock_.now() >= begun + kStalled) return Error("it accepts no more bytes");
    }
    // A break takes effect at once, ahead of bytes that still wait in the adapter, so it may begin
    // only when all bytes have left.
    clock_.sleepUntil(begun + kPacket);
    for (Time handedOver = clock_.now(); clock_.now() < handedOver + kStore && !TRY(line_.isDrained());) {
        clock_.sleepUntil(clock_.now() + kLookAgain);
        if (TRY(line_.unsent()) > 0) handedOver = clock_.now();
        if (handedOver >= begun + kStalled) return Error("its packets do not leave the adapter");
    }
    return {};
}

}  // namespace fantascope::drivers
