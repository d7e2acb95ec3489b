#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string>
#include <utility>

namespace fantascope::app {

// Remembers the newest presses and their answers, so that one that is sent twice counts once. Value
// type; thread: one at a time.
class PressBook {
public:
    // The answer to a press that has come before; null: it is new, or long ago.
    const std::string* answerTo(const std::string& press) const {
        const auto found = std::ranges::find(presses_, press, &Press::first);
        return press.empty() || found == presses_.end() ? nullptr : &found->second;
    }
    void note(const std::string& press, const std::string& answer) {
        if (press.empty()) return;
        presses_.emplace_back(press, answer);
        if (presses_.size() > kKept) presses_.pop_front();
    }

private:
    static constexpr std::size_t kKept = 256;
    using Press = std::pair<std::string, std::string>;
    std::deque<Press> presses_;
};

}  // namespace fantascope::app
