#include "contract/widget.h"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <string_view>

namespace fantascope::contract {
namespace {

std::vector<std::uint8_t> named(std::uint8_t low, std::uint8_t high, std::string_view name) {
    std::vector<std::uint8_t> data(2 + name.size());
    data[0] = low;
    data[1] = high;
    std::copy(name.begin(), name.end(), data.begin() + 2);
    return data;
}

}  // namespace

Widget::Widget(int line, std::string number, Parameters parameters)
    : line_(line), number_(std::move(number)), parameters_(parameters), thread_([this] { run(); }) {}

Widget::~Widget() {
    ending_ = true;
    thread_.join();
}

std::optional<Widget::Frame> Widget::out() const {
    const std::lock_guard lock(mutex_);
    return input_ ? std::nullopt : lastOut_;
}

std::optional<Widget::Frame> Widget::lastOut() const {
    const std::lock_guard lock(mutex_);
    return lastOut_;
}

int Widget::framesOut() const {
    const std::lock_guard lock(mutex_);
    return framesOut_;
}

std::string Widget::complaint() const {
    const std::lock_guard lock(mutex_);
    return complaint_;
}

Widget::Parameters Widget::parameters() const {
    const std::lock_guard lock(mutex_);
    return parameters_;
}

int Widget::parametersWritten() const {
    const std::lock_guard lock(mutex_);
    return written_;
}

bool Widget::wasToldToReceive() const {
    const std::lock_guard lock(mutex_);
    return toldToReceive_;
}

void Widget::comesIn(std::span<const std::uint8_t> slots, std::uint8_t startCode, std::uint8_t status) {
    std::vector<std::uint8_t> data{status, startCode};
    data.insert(data.end(), slots.begin(), slots.end());
    const std::lock_guard lock(mutex_);
    if (input_ && everyFrame_) say(5, data);
}

void Widget::hasHeard(std::vector<std::uint8_t> bytes) {
    const std::lock_guard lock(mutex_);
    heard_ = std::move(bytes);
}

void Widget::run() {
    while (!ending_) {
        pollfd waited{line_, POLLIN, 0};
        if (poll(&waited, 1, 10) <= 0 || deaf_) continue;
        std::uint8_t bytes[4096];
        const std::lock_guard lock(mutex_);  // once the line is empty, the bytes have taken effect
        const ssize_t count = read(line_, bytes, sizeof bytes);
        if (count <= 0) continue;
        heard_.insert(heard_.end(), bytes, bytes + count);
        while (take()) {
        }
    }
}

bool Widget::take() {
    const auto start = std::find(heard_.begin(), heard_.end(), 0x7e);
    if (heard_.end() - start < 4) return false;
    const int length = start[2] | start[3] << 8;
    if (length > 600) {  // it skips to the next start
        heard_.erase(heard_.begin(), start + 1);
        return true;
    }
    if (heard_.end() - start < length + 5) return false;
    const std::uint8_t label = start[1];
    const std::vector<std::uint8_t> data(start + 4, start + 4 + length);
    const bool whole = start[4 + length] == 0xe7;
    if (start != heard_.begin() || !whole)
        complaint_ += complaint_.empty() ? fmt::format("bytes that are no message before label {}", label) : "";
    heard_.erase(heard_.begin(), start + 4 + length + 1);
    if (whole) answer(label, data);
    return true;
}

void Widget::answer(std::uint8_t label, const std::vector<std::uint8_t>& data) {
    const auto digits = [&](int from) { return static_cast<std::uint8_t>(std::stoi(number_.substr(from, 2), nullptr, 16)); };
    // Every message except a frame to send, or a request for its parameters, makes it an input.
    if (label != 6 && label != 3) input_ = true;
    if (label == 3 && data.size() == 2) {
        if (!silent_) say(3, {44, 1, parameters_.breakTime, parameters_.markAfterBreak, parameters_.rate});
    } else if (label == 4 && data.size() == 5) {
        const bool good = data[2] >= 9 && data[2] <= 127 && data[3] >= 1 && data[3] <= 127 && data[4] <= 40;
        if (!good && complaint_.empty()) complaint_ = "parameters that no widget has";
        parameters_ = {data[2], data[3], data[4]};
        ++written_;
    } else if (label == 6 && !data.empty() && data.size() <= 513 && data[0] == 0) {
        std::copy(data.begin() + 1, data.end(), lastOut_.emplace(Frame{}).begin());
        input_ = false;
        ++framesOut_;
    } else if (label == 8 && data.size() == 1) {
        everyFrame_ = data[0] == 0;
        toldToReceive_ = true;
    } else if (label == 10 && data.empty()) {
        if (!silent_) say(10, {digits(6), digits(4), digits(2), digits(0)});
    } else if (label == 77 && data.empty()) {
        if (!silent_) say(77, named(0x45, 0x4e, "ENTTEC"));
    } else if (label == 78 && data.empty()) {
        if (!silent_) say(78, named(1, 0, "DMX USB PRO"));
    } else if (complaint_.empty()) {
        complaint_ = fmt::format("label {} with {} bytes", label, data.size());
    }
}

void Widget::say(std::uint8_t label, const std::vector<std::uint8_t>& data) {
    std::vector<std::uint8_t> message{0x7e, label, static_cast<std::uint8_t>(data.size() & 255),
                                      static_cast<std::uint8_t>(data.size() >> 8)};
    message.insert(message.end(), data.begin(), data.end());
    message.push_back(0xe7);
    for (std::span<const std::uint8_t> rest = message; !rest.empty() && !ending_;) {
        const ssize_t count = write(line_, rest.data(), rest.size());
        if (count > 0) {
            rest = rest.subspan(static_cast<std::size_t>(count));
            continue;
        }
        pollfd waited{line_, POLLOUT, 0};
        poll(&waited, 1, 10);
    }
}

}  // namespace fantascope::contract
