#include "drivers/cue_controller/button_lights.h"

#include <algorithm>

namespace fantascope::drivers {

bool ButtonLights::tell(int button, const ButtonLight& light) {
    const std::lock_guard lock(mutex_);
    ButtonLight& told = told_[button];
    if (told == light) return false;
    told = light;
    if (std::find(due_.begin(), due_.end(), button) == due_.end()) due_.push_back(button);
    return true;
}

void ButtonLights::restart(int lamps) {
    const std::lock_guard lock(mutex_);
    shown_.clear();
    due_.clear();
    for (const auto& [button, light] : told_) due_.push_back(button);
    for (int button = 1; button <= lamps; ++button)
        if (!told_.contains(button)) due_.push_back(button);
}

std::optional<std::pair<int, ButtonLight>> ButtonLights::next() {
    const std::lock_guard lock(mutex_);
    while (!due_.empty()) {
        const int button = due_.front();
        due_.pop_front();
        const auto told = told_.find(button);
        const ButtonLight light = told == told_.end() ? ButtonLight{} : told->second;
        const auto shown = shown_.find(button);
        if (shown != shown_.end() && shown->second == light) continue;  // it has changed its mind
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
