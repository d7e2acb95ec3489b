#include "app/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

constexpr int kBarWidth = 24;  // characters
constexpr Time kTerminalInterval = 100ms, kPlainInterval = 2s;
constexpr double kLeastShareToForetell = 0.01;  // before this, the time left would be a guess

std::string duration(double seconds) {
    const auto whole = static_cast<long>(std::ceil(seconds));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{}:{:02} min", whole / 60, whole % 60);
    return fmt::format("{}:{:02} h", whole / 3600, whole / 60 % 60);
}

}  // namespace

Progress::Progress(std::string label, const Clock& clock, std::ostream& out, bool terminal)
    : label_(std::move(label)), clock_(clock), out_(out), terminal_(terminal), start_(clock.now()) {}

Progress::~Progress() {
    if (terminal_ && drawn_) out_ << std::endl;
}

void Progress::update(std::optional<double> done, std::string_view value) {
    const Time now = clock_.now();
    if (drawn_ && now - *drawn_ < (terminal_ ? kTerminalInterval : kPlainInterval)) return;
    drawn_ = now;
    if (terminal_)
        out_ << "\r\x1b[K" << line(done, value) << std::flush;  // to the line's start, and clear it
    else
        out_ << line(done, value) << std::endl;
}

std::string Progress::line(std::optional<double> done, std::string_view value) const {
    const double elapsed = seconds(clock_.now() - start_);
    if (!done) return fmt::format("{}  {}  {}", label_, value, duration(elapsed));
    const double share = std::clamp(*done, 0.0, 1.0);
    const std::string left =
        share < kLeastShareToForetell ? "" : fmt::format("  {} left", duration(elapsed * (1 - share) / share));
    const std::string percent = fmt::format("{:3.0f} %", 100 * share);
    if (!terminal_) return fmt::format("{}  {}  {}{}", label_, percent, value, left);
    const int filled = static_cast<int>(std::lround(share * kBarWidth));
    return fmt::format("{}  [{:#<{}}{:.<{}}] {}  {}{}", label_, "", filled, "", kBarWidth - filled, percent, value, left);
}

bool standardErrorIsTerminal() { return ::isatty(STDERR_FILENO) != 0; }

}  // namespace fantascope::app
