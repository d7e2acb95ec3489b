#include "drivers/dmx/enttec_pro.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::drivers {
namespace {

// Hz; the most that USB and 512 slots allow.
constexpr int kMaxRate = 40;

// How long the last frame may take to leave at the end.
constexpr Time kDrainTimeout = std::chrono::milliseconds(250);

// How often a silent line checks whether the service ends.
constexpr Time kLookAgain = std::chrono::milliseconds(50);

// The longest time without a break on a DMX line, as seen by a receiver (ANSI E1.11).
constexpr Time kSilence = std::chrono::milliseconds(1250);

// Frames that wait to be taken.
constexpr std::size_t kMaxWaiting = 16;

// Converts microseconds to the widget's units, rounded up.
void readTime(ConfigFields& fields, std::string_view key, std::optional<int>& target, int least) {
    constexpr int kMaxUnits = 127;
    fields.optional().read(key, target, [&](const ConfigNode& node) -> Result<std::optional<int>> {
        const double time = TRY(node.number(least, std::floor(kMaxUnits * WidgetParameters::kTimeUnit), "us"));
        return std::optional(static_cast<int>(std::ceil(time / WidgetParameters::kTimeUnit)));
    });
}

void readWhich(ConfigFields& fields, WidgetChoice& which) {
    std::string driver;
    fields.text("driver", driver);
    readWidgetLine(fields, which.line);
    readWidgetNumber(fields, which.number);
}

}  // namespace

EnttecPro::EnttecPro(const std::string& name, Options options, Clock& clock)
    : options_(std::move(options)), clock_(clock), line_(name + "'s line", widgetFinder(options_.which), kWidgetSettings) {}

Outage EnttecPro::runOnce(Service& service, const Work& work) {
    if (const auto outage = line_.awaitRunning(service)) return *outage;
    if (service.ending()) return {};
    EnttecWidget widget(line_, clock_);
    const auto hello = handshake(widget);
    // If the widget is searched among all adapters, a wrong adapter is not a fault.
    const WidgetChoice& which = options_.which;
    const bool searched = !which.number.empty() && which.line.file.empty() && which.line.serial.empty();
    if (!hello) return line_.drop(hello.error(), searched ? DeviceState::Absent : DeviceState::Faulted);
    const auto done = work(widget, hello->parameters, hello->number);
    if (!done) return line_.drop(done.error(), DeviceState::Faulted);
    return {};
}

Result<EnttecPro::Handshake> EnttecPro::handshake(EnttecWidget& widget) {
    Handshake hello;
    hello.parameters = TRY(widget.handshake());
    hello.number = TRY(widget.number());
    const std::string& wanted = options_.which.number;
    if (!wanted.empty() && hello.number != wanted)
        return Error(fmt::format("it is widget {}, not {}", hello.number.empty() ? "without a number" : hello.number, wanted));
    const WidgetParameters found = hello.parameters;
    hello.parameters.breakTime = options_.breakTime.value_or(found.breakTime);
    hello.parameters.markAfterBreak = options_.markAfterBreak.value_or(found.markAfterBreak);
    hello.parameters.rate = options_.rate.value_or(found.rate);
    // The widget stores them in a memory that wears out, so only changes are written.
    if (hello.parameters != found) TRY(widget.setParameters(hello.parameters));
    return hello;
}

Result<Opening<DmxPort>> EnttecProPort::fromConfig(const ConfigNode& options, int universe) {
    EnttecPro::Options wanted;
    ConfigFields fields(options);
    readWhich(fields, wanted.which);
    readTime(fields, "break", wanted.breakTime, 97);                  // ANSI E1.11 requires 92 us, the widget 9 units
    readTime(fields, "mark_after_break", wanted.markAfterBreak, 12);  // of ANSI E1.11
    fields.optional().read("rate", wanted.rate, [](const ConfigNode& node) -> Result<std::optional<int>> {
        return std::optional(static_cast<int>(TRY(node.integer(1, kMaxRate))));
    });
    TRY(fields.finish());
    const auto open = [=](const DriverContext& context) -> Result<std::unique_ptr<DmxPort>> {
        return std::unique_ptr<DmxPort>(new EnttecProPort(fmt::format("universe {}", universe), wanted, context.clock));
    };
    return Opening<DmxPort>{
        .open = open, .uses = {useOf(wanted.which)}, .claim = [which = wanted.which] { return claimOf(which); }};
}

EnttecProPort::EnttecProPort(const std::string& name, EnttecPro::Options options, Clock& clock)
    : clock_(clock),
      widget_(name, std::move(options), clock),
      service_(name, "enttec_pro", LossAction::Hold, [this](Service& service) {
          return widget_.runOnce(service, [&](EnttecWidget& widget, const WidgetParameters& parameters, const std::string&) {
              return repeat(service, widget, parameters.rate == 0 ? kMaxRate : std::min(parameters.rate, kMaxRate));
          });
      }) {}

Result<void> EnttecProPort::send(std::span<const std::uint8_t, kDmxSlots> slots) {
    if (!service_.isRunning()) return service_.refusal();
    const std::lock_guard lock(mutex_);
    newest_ = packetOf(slots);
    return {};
}

Result<void> EnttecProPort::repeat(Service& service, EnttecWidget& widget, double rate) {
    const auto newest = [this] {
        const std::lock_guard lock(mutex_);
        return newest_;
    };
    {
        const std::lock_guard lock(mutex_);
        newest_.reset();  // from before this life
    }
    service.setRunning();
    const Time period = fromSeconds(1 / rate);
    const auto ignore = [](const WidgetMessage&) {};
    const auto drain = [&]() -> Result<void> {
        for (const Time end = clock_.now() + kDrainTimeout; !widget.idle() && clock_.now() < end;)
            TRY(widget.work(clock_.now() + std::chrono::milliseconds(1), ignore));
        return {};
    };
    for (Time tick = clock_.now();;) {
        const bool last = service.ending();
        if (last) TRY(drain());  // then the newest frame can follow, even if an older one was being sent
        if (const auto packet = newest(); packet && widget.idle()) widget.queue(WidgetLabel::Send, *packet);
        if (last) return drain();
        tick = std::max(tick + period, clock_.now());
        TRY(widget.work(tick, ignore));
    }
}

Result<Opening<DmxSource>> EnttecProSource::fromConfig(const ConfigNode& options, int universe) {
    EnttecPro::Options wanted;
    ConfigFields fields(options);
    readWhich(fields, wanted.which);
    TRY(fields.finish());
    const auto open = [=](const DriverContext& context) -> Result<std::unique_ptr<DmxSource>> {
        return std::unique_ptr<DmxSource>(new EnttecProSource(fmt::format("desk {}", universe), wanted, context.clock));
    };
    return Opening<DmxSource>{
        .open = open, .uses = {useOf(wanted.which)}, .claim = [which = wanted.which] { return claimOf(which); }};
}

EnttecProSource::EnttecProSource(const std::string& name, EnttecPro::Options options, Clock& clock)
    : clock_(clock),
      widget_(name, std::move(options), clock),
      service_(name, "enttec_pro", LossAction::Hold, [this](Service& service) {
          return widget_.runOnce(service, [&](EnttecWidget& widget, const WidgetParameters&, const std::string& number) {
              return listen(service, widget, number);
          });
      }) {}

std::optional<DmxInput> EnttecProSource::receive() {
    if (!service_.isRunning()) return std::nullopt;
    const std::lock_guard lock(mutex_);
    if (arrived_.empty()) return std::nullopt;
    const DmxInput oldest = std::move(arrived_.front());
    arrived_.pop_front();
    return oldest;
}

Result<void> EnttecProSource::listen(Service& service, EnttecWidget& widget, const std::string& number) {
    {
        const std::lock_guard lock(mutex_);
        arrived_.clear();  // from before this life
    }
    service.setRunning();
    DmxPacket packet{};
    const auto hear = [&](const WidgetMessage& message) {
        if (!applyTo(message, packet)) return;
        DmxInput input;
        std::copy(packet.begin() + 1, packet.end(), input.slots.begin());
        input.source = number;
        input.arrived = clock_.now();
        input.silence = kSilence;
        const std::lock_guard lock(mutex_);
        if (arrived_.size() == kMaxWaiting) arrived_.pop_front();
        arrived_.push_back(std::move(input));
    };
    const std::uint8_t everyFrame = 0;  // so silence means that nobody sends
    widget.queue(WidgetLabel::ReceiveMode, {&everyFrame, 1});
    while (!service.ending()) TRY(widget.work(clock_.now() + kLookAgain, hear));
    return {};
}

}  // namespace fantascope::drivers
