#include "app/base/attendance.h"

namespace fantascope::app {
namespace {

constexpr Time kLook = std::chrono::milliseconds(50);  // how often paused work polls for a key
constexpr char kPause = ' ', kEscape = '\x1b', kQuit = 'q';

}  // namespace

std::optional<char> Attendance::nextKey() {
    if (const auto key = terminal_.poll()) return key;
    return listen_ ? listen_() : std::nullopt;
}

bool Attendance::goesOn(const std::function<void()>& whilePaused) {
    const Time start = clock_.now();
    bool paused = false, stood = false;
    while (true) {
        while (const auto key = nextKey()) {
            if (*key == kEscape || *key == kQuit) return false;
            if (*key == kPause) paused = !paused;
        }
        if (interrupt_.requested()) return false;
        if (!paused) break;
        stood = true;
        if (whilePaused) whilePaused();
        clock_.sleepUntil(clock_.now() + kLook);
    }
    if (stood) paused_ += clock_.now() - start;
    return true;
}

}  // namespace fantascope::app
