#include "drivers/dmx/enttec_pro.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::drivers {
namespace {

// The most that USB and a universe of 512 slots have room for.
constexpr int kMostRate = 40;

// How long a frame that was just handed over may take to leave at the end.
constexpr Time kFarewell = std::chrono::milliseconds(250);

// How often the end is looked for while nothing comes in.
constexpr Time kLookAgain = std::chrono::milliseconds(50);

// The longest that a DMX line may be without a break, as a receiver has to see it (ANSI E1.11).
constexpr Time kSilence = std::chrono::milliseconds(1250);

// Frames that wait while nobody takes them.
constexpr std::size_t kWaiting = 16;

// A time in microseconds becomes the widget's units, none shorter than asked for.
void readTime(ConfigFields& fields, std::string_view key, std::optional<int>& target, int least) {
    constexpr int kMostUnits = 127;
    fields.optional().read(key, target, [&](const ConfigNode& node) -> Result<std::optional<int>> {
        const double time = TRY(node.number(least, std::floor(kMostUnits * WidgetParameters::kTimeUnit), "us"));
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

Outage EnttecPro::attend(Service& service, const Work& work) {
    if (const auto outage = line_.await(service)) return *outage;
    if (service.ending()) return {};
    EnttecWidget widget(line_, clock_);
    const auto met = meet(widget);
    // Among several adapters one that is not ours is no fault of ours.
    const WidgetChoice& which = options_.which;
    const bool searched = !which.number.empty() && which.line.file.empty() && which.line.serial.empty();
    if (!met) return line_.end(met.error(), searched ? DeviceState::Absent : DeviceState::Faulted);
    const auto done = work(widget, met->parameters, met->number);
    if (!done) return line_.end(done.error(), DeviceState::Faulted);
    return {};
}

Result<EnttecPro::Met> EnttecPro::meet(EnttecWidget& widget) {
    Met met;
    met.parameters = TRY(widget.meet());
    met.number = TRY(widget.number());
    const std::string& wanted = options_.which.number;
    if (!wanted.empty() && met.number != wanted)
        return Error(fmt::format("it is the widget {}, not {}", met.number.empty() ? "without a number" : met.number, wanted));
    const WidgetParameters found = met.parameters;
    met.parameters.breakTime = options_.breakTime.value_or(found.breakTime);
    met.parameters.markAfterBreak = options_.markAfterBreak.value_or(found.markAfterBreak);
    met.parameters.rate = options_.rate.value_or(found.rate);
    // It writes them into a memory that wears out: only what differs.
    if (met.parameters != found) TRY(widget.arrange(met.parameters));
    return met;
}

Result<Opening<DmxPort>> EnttecProPort::fromConfig(const ConfigNode& options, int universe) {
    EnttecPro::Options wanted;
    ConfigFields fields(options);
    readWhich(fields, wanted.which);
    readTime(fields, "break", wanted.breakTime, 97);  // 92 us is the least of ANSI E1.11, 9 units that of the widget
    readTime(fields, "mark_after_break", wanted.markAfterBreak, 12);  // of ANSI E1.11
    fields.optional().read("rate", wanted.rate, [](const ConfigNode& node) -> Result<std::optional<int>> {
        return std::optional(static_cast<int>(TRY(node.integer(1, kMostRate))));
    });
    TRY(fields.finish());
    const auto open = [=](const Surroundings& around) -> Result<std::unique_ptr<DmxPort>> {
        return std::unique_ptr<DmxPort>(new EnttecProPort(fmt::format("universe {}", universe), wanted, around.clock));
    };
    return Opening<DmxPort>{
        .open = open, .uses = {useOf(wanted.which)}, .claim = [which = wanted.which] { return claimOf(which); }};
}

EnttecProPort::EnttecProPort(const std::string& name, EnttecPro::Options options, Clock& clock)
    : clock_(clock),
      widget_(name, std::move(options), clock),
      service_(name, "enttec_pro", LossAction::Hold, [this](Service& service) {
          return widget_.attend(service, [&](EnttecWidget& widget, const WidgetParameters& parameters, const std::string&) {
              return repeat(service, widget, parameters.rate == 0 ? kMostRate : std::min(parameters.rate, kMostRate));
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
        newest_.reset();  // it was sent to another life
    }
    service.running();
    const Time period = fromSeconds(1 / rate);
    const auto hearNothing = [](const WidgetMessage&) {};
    const auto finishSaying = [&]() -> Result<void> {
        for (const Time end = clock_.now() + kFarewell; !widget.idle() && clock_.now() < end;)
            TRY(widget.work(clock_.now() + std::chrono::milliseconds(1), hearNothing));
        return {};
    };
    for (Time tick = clock_.now();;) {
        const bool last = service.ending();
        if (last) TRY(finishSaying());  // the newest frame goes out, even where an older one is on its way
        if (const auto packet = newest(); packet && widget.idle()) widget.say(WidgetLabel::Send, *packet);
        if (last) return finishSaying();
        tick = std::max(tick + period, clock_.now());
        TRY(widget.work(tick, hearNothing));
    }
}

Result<Opening<DmxSource>> EnttecProSource::fromConfig(const ConfigNode& options, int universe) {
    EnttecPro::Options wanted;
    ConfigFields fields(options);
    readWhich(fields, wanted.which);
    TRY(fields.finish());
    const auto open = [=](const Surroundings& around) -> Result<std::unique_ptr<DmxSource>> {
        return std::unique_ptr<DmxSource>(new EnttecProSource(fmt::format("desk {}", universe), wanted, around.clock));
    };
    return Opening<DmxSource>{
        .open = open, .uses = {useOf(wanted.which)}, .claim = [which = wanted.which] { return claimOf(which); }};
}

EnttecProSource::EnttecProSource(const std::string& name, EnttecPro::Options options, Clock& clock)
    : clock_(clock),
      widget_(name, std::move(options), clock),
      service_(name, "enttec_pro", LossAction::Hold, [this](Service& service) {
          return widget_.attend(service, [&](EnttecWidget& widget, const WidgetParameters&, const std::string& number) {
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
        arrived_.clear();  // of another life
    }
    service.running();
    DmxPacket packet{};
    const auto hear = [&](const WidgetMessage& message) {
        if (!takeOver(message, packet)) return;
        DmxInput input;
        std::copy(packet.begin() + 1, packet.end(), input.slots.begin());
        input.source = number;
        input.arrived = clock_.now();
        input.silence = kSilence;
        const std::lock_guard lock(mutex_);
        if (arrived_.size() == kWaiting) arrived_.pop_front();
        arrived_.push_back(std::move(input));
    };
    const std::uint8_t everyFrame = 0;  // its silence then means that nobody sends
    widget.say(WidgetLabel::ReceiveMode, {&everyFrame, 1});
    while (!service.ending()) TRY(widget.work(clock_.now() + kLookAgain, hear));
    return {};
}

}  // namespace fantascope::drivers
