#include "drivers/dmx/enttec_widget.h"

#include <algorithm>

namespace fantascope::drivers {
namespace {

// A widget answers within a few milliseconds. The rest is for adapters that collect bytes, and for
// loaded machines.
constexpr Time kTimeout = std::chrono::milliseconds(300);
constexpr int kAttempts = 3;

// How soon a full line is tried again.
constexpr Time kLookAgain = std::chrono::milliseconds(1);

}  // namespace

Result<WidgetParameters> EnttecWidget::handshake() {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        // It may still wait for the rest of a message that another program broke off.
        if (attempt > 0) outgoing_.insert(outgoing_.end(), kMaxWidgetMessage, 0);
        const auto data = TRY(answer(WidgetLabel::Parameters, parametersRequest(), kTimeout));
        if (const auto parameters = data ? parametersIn(*data) : std::nullopt) return *parameters;
    }
    return Error("it does not answer as a DMX USB PRO does");
}

Result<std::string> EnttecWidget::number() {
    const auto data = TRY(answer(WidgetLabel::Number, {}, kTimeout));
    const auto number = data ? numberIn(*data) : std::nullopt;
    if (!number) return Error("it does not report its serial number");
    return *number;
}

Result<void> EnttecWidget::setParameters(const WidgetParameters& wanted) {
    for (int attempt = 0;; ++attempt) {
        if (TRY(handshake()) == wanted) return {};
        if (attempt == kAttempts) return Error("it does not accept its parameters");
        queue(WidgetLabel::SetParameters, dataOf(wanted));
    }
}

Result<std::string> EnttecWidget::name() {
    const auto manufacturer = TRY(answer(WidgetLabel::Manufacturer, {}, kTimeout));
    const auto device = TRY(answer(WidgetLabel::Device, {}, manufacturer ? kTimeout : Time::zero()));
    if (!manufacturer || !device) return std::string();
    return nameIn(*manufacturer) + " " + nameIn(*device);
}

void EnttecWidget::queue(WidgetLabel label, std::span<const std::uint8_t> data) {
    if (idle()) progress_ = clock_.now();
    const Data message = encoded(label, data);
    outgoing_.insert(outgoing_.end(), message.begin(), message.end());
}

Result<void> EnttecWidget::work(Time until, const std::function<void(const WidgetMessage&)>& onMessage) {
    for (;;) {
        if (clock_.now() >= asked_ + kAskEvery && answered_) {
            queue(WidgetLabel::Parameters, parametersRequest());
            asked_ = clock_.now();
            answered_ = false;
        }
        TRY(writeSome());
        const Time next = std::min(until, asked_ + (answered_ ? kAskEvery : kAnswerTimeout));
        TRY(readSome(std::max(next - clock_.now(), Time::zero())));
        while (const auto message = parser_.next()) {
            if (message->label == WidgetLabel::Parameters) answered_ = true;
            onMessage(*message);
        }
        if (!answered_ && clock_.now() >= asked_ + kAnswerTimeout) return Error("it has stopped answering");
        if (clock_.now() >= until) return {};
    }
}

Result<std::optional<EnttecWidget::Data>> EnttecWidget::answer(WidgetLabel label, std::span<const std::uint8_t> question,
                                                               Time timeout) {
    queue(label, question);
    const Time deadline = clock_.now() + timeout;
    for (;;) {
        TRY(writeSome());
        TRY(readSome(std::max(deadline - clock_.now(), Time::zero())));
        while (auto message = parser_.next())
            if (message->label == label) return std::optional(std::move(message->data));
        if (clock_.now() >= deadline && idle()) return std::optional<Data>();
    }
}

Result<void> EnttecWidget::writeSome() {
    if (idle()) return {};
    const std::size_t count = TRY(line_.write(outgoing_));
    outgoing_.erase(outgoing_.begin(), outgoing_.begin() + static_cast<std::ptrdiff_t>(count));
    if (count > 0 || idle()) progress_ = clock_.now();
    if (clock_.now() >= progress_ + kStalled) return Error("it accepts no more bytes");
    return {};
}

Result<void> EnttecWidget::readSome(Time timeout) {
    std::uint8_t bytes[1024];
    const std::size_t count = TRY(line_.read(bytes, idle() ? timeout : std::min(timeout, kLookAgain)));
    parser_.put({bytes, count});
    return {};
}

}  // namespace fantascope::drivers
