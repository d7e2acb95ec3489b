#include "drivers/cue_controller/button_lights.h"

#include <algorithm>

namespace fantascope::drivers {

bool ButtonLights::set(int button, const ButtonLight& light) {
    const std::lock_guard lock(mutex_);
    ButtonLight& wanted = wanted_[button];
    if (wanted == light) return false;
    wanted = light;
    if (std::find(due_.begin(), due_.end(), button) == due_.end()) due_.push_back(button);
    return true;
}

void ButtonLights::invalidate(int lamps) {
    const std::lock_guard lock(mutex_);
    shown_.clear();
    due_.clear();
    for (const auto& [button, light] : wanted_) due_.push_back(button);
    for (int button = 1; button <= lamps; ++button)
        if (!wanted_.contains(button)) due_.push_back(button);
}

std::optional<std::pair<int, ButtonLight>> ButtonLights::next() {
    const std::lock_guard lock(mutex_);
    while (!due_.empty()) {
        const int button = due_.front();
        due_.pop_front();
        const auto wanted = wanted_.find(button);
        const ButtonLight light = wanted == wanted_.end() ? ButtonLight{} : wanted->second;
        const auto shown = shown_.find(button);
        if (shown != shown_.end() && shown->second == light) continue;  // changed back meanwhile
        shown_[button] = light;
        return std::pair(button, light);
    }
    return std::nullopt;
}

std::vector<int> ButtonLights::lit() const {
    const std::lock_guard lock(mutex_);
    std::vector<int> buttons;
    for (const auto& [button, light] : shown_)
        if (light != ButtonLight{}) buttons.push_back(button);
    return buttons;
}

}  // namespace fantascope::drivers
