#include "drivers/cue_controller/button_events.h"

#include <algorithm>

namespace fantascope::drivers {

void ButtonEvents::settle(const std::vector<ButtonChange>& changes) {
    for (const ButtonChange& change : changes) {
        if (change.what == ButtonChange::What::Down) downBefore_.insert(change.button);
        if (change.what == ButtonChange::What::Up) downBefore_.erase(change.button);
    }
}

void ButtonEvents::take(const std::vector<ButtonChange>& changes, Time now) {
    pass(now);
    for (const auto& [button, what] : changes) {
        if (what == ButtonChange::What::Detent) {
            push(button, true, now);
            push(button, false, now);
            continue;
        }
        const bool down = what == ButtonChange::What::Down;
        Contact& contact = contacts_[button];
        if (!down && downBefore_.erase(button) != 0) {
            contact.quietFrom = now + debounce_;  // letting go bounces too
            continue;
        }
        const auto held = std::find(held_.begin(), held_.end(), button);
        if (down == contact.isDown) {
            if (held != held_.end()) held_.erase(held);
        } else if (now >= contact.quietFrom && (down || held_.empty())) {  // a release may wait for older ones, a press never
            letOut(button, contact, down, now);
        } else if (held == held_.end()) {
            held_.push_back(button);
        }
    }
}

void ButtonEvents::pass(Time now) {
    while (!held_.empty()) {
        Contact& contact = contacts_[held_.front()];
        if (now < contact.quietFrom) return;
        letOut(held_.front(), contact, !contact.isDown, now);
        held_.pop_front();
    }
}

std::optional<Time> ButtonEvents::due() const {
    if (held_.empty()) return std::nullopt;
    return contacts_.at(held_.front()).quietFrom;
}

void ButtonEvents::letOut(int button, Contact& contact, bool down, Time now) {
    contact = {down, now + debounce_};
    push(button, down, now);
}

void ButtonEvents::push(int button, bool down, Time now) {
    const std::lock_guard lock(mutex_);
    if (down && events_.size() >= kMost) return;
    if (down ? pressed_.insert(button).second : pressed_.erase(button) != 0) events_.push_back({button, down, now});
}

void ButtonEvents::lose(Time now) {
    contacts_.clear();
    held_.clear();
    downBefore_.clear();
    const std::lock_guard lock(mutex_);
    events_.clear();
    pressed_.clear();
    for (const int button : given_) events_.push_back({button, false, now});
}

std::optional<ButtonEvent> ButtonEvents::poll() {
    const std::lock_guard lock(mutex_);
    if (events_.empty()) return std::nullopt;
    const ButtonEvent event = events_.front();
    events_.pop_front();
    if (event.pressed)
        given_.insert(event.button);
    else
        given_.erase(event.button);
    return event;
}

}  // namespace fantascope::drivers
