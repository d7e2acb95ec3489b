#include "drivers/cue_controller/button_events.h"

#include <algorithm>

namespace fantascope::drivers {

void ButtonEvents::setInitial(const std::vector<ButtonChange>& changes) {
    for (const ButtonChange& change : changes) {
        if (change.what == ButtonChange::What::Down) downBefore_.insert(change.button);
        if (change.what == ButtonChange::What::Up) downBefore_.erase(change.button);
    }
}

void ButtonEvents::feed(const std::vector<ButtonChange>& changes, Time now) {
    flush(now);
    for (const auto& [button, what] : changes) {
        if (what == ButtonChange::What::Detent) {
            push(button, true, now);
            push(button, false, now);
            continue;
        }
        const bool down = what == ButtonChange::What::Down;
        Contact& contact = contacts_[button];
        if (!down && downBefore_.erase(button) != 0) {
            contact.settledAt = now + debounce_;  // a release bounces, too
            continue;
        }
        const auto pending = std::find(pending_.begin(), pending_.end(), button);
        if (down == contact.isDown) {
            if (pending != pending_.end()) pending_.erase(pending);
        } else if (now >= contact.settledAt &&
                   (down || pending_.empty())) {  // a release waits for earlier ones, a press never does
            emit(button, contact, down, now);
        } else if (pending == pending_.end()) {
            pending_.push_back(button);
        }
    }
}

void ButtonEvents::flush(Time now) {
    while (!pending_.empty()) {
        Contact& contact = contacts_[pending_.front()];
        if (now < contact.settledAt) return;
        emit(pending_.front(), contact, !contact.isDown, now);
        pending_.pop_front();
    }
}

std::optional<Time> ButtonEvents::nextFlush() const {
    if (pending_.empty()) return std::nullopt;
    return contacts_.at(pending_.front()).settledAt;
}

void ButtonEvents::emit(int button, Contact& contact, bool down, Time now) {
    contact = {down, now + debounce_};
    push(button, down, now);
}

void ButtonEvents::push(int button, bool down, Time now) {
    const std::lock_guard lock(mutex_);
    if (down && events_.size() >= kMaxWaiting) return;
    if (down ? pressed_.insert(button).second : pressed_.erase(button) != 0) events_.push_back({button, down, now});
}

void ButtonEvents::deviceLost(Time now) {
    contacts_.clear();
    pending_.clear();
    downBefore_.clear();
    const std::lock_guard lock(mutex_);
    events_.clear();
    pressed_.clear();
    for (const int button : polled_) events_.push_back({button, false, now});
}

std::optional<ButtonEvent> ButtonEvents::poll() {
    const std::lock_guard lock(mutex_);
    if (events_.empty()) return std::nullopt;
    const ButtonEvent event = events_.front();
    events_.pop_front();
    if (event.pressed)
        polled_.insert(event.button);
    else
        polled_.erase(event.button);
    return event;
}

}  // namespace fantascope::drivers
