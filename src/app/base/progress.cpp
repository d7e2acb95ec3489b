#include "app/base/progress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

constexpr int kBarWidth = 24;  // characters
constexpr Time kTerminalInterval = 100ms, kPlainInterval = 2s;
constexpr double kMinShareToEstimate = 0.01;  // with less, the time left would be a guess

}  // namespace

Progress::Progress(std::string label, const Clock& clock, std::ostream& out, bool terminal, std::function<int()> columns)
    : label_(std::move(label)), clock_(clock), out_(out), start_(clock.now()) {
    if (terminal) terminal_.emplace(out, std::move(columns));
}

void Progress::update(std::optional<double> done, std::string_view value) {
    const Time now = clock_.now();
    if (drawn_ && now - *drawn_ < (terminal_ ? kTerminalInterval : kPlainInterval)) return;
    drawn_ = now;
    if (terminal_)
        terminal_->draw(line(done, value));
    else
        out_ << line(done, value) << std::endl;
}

std::string Progress::line(std::optional<double> done, std::string_view value) const {
    const Time elapsed = clock_.now() - start_;
    if (!done) return fmt::format("{}  {}  {}", label_, value, shortDuration(elapsed));
    const double share = std::clamp(*done, 0.0, 1.0);
    const std::string left = share < kMinShareToEstimate
                                 ? ""
                                 : fmt::format("  {} left", shortDuration(fromSeconds(seconds(elapsed) * (1 - share) / share)));
    const std::string percent = fmt::format("{:3.0f} %", 100 * share);
    const std::string plain = fmt::format("{}  {}  {}{}", label_, percent, value, left);
    if (!terminal_) return plain;
    const int filled = static_cast<int>(std::lround(share * kBarWidth));
    const std::string withBar =
        fmt::format("{}  [{:#<{}}{:.<{}}] {}  {}{}", label_, "", filled, "", kBarWidth - filled, percent, value, left);
    return columnsOf(withBar) <= terminal_->columns() ? withBar : plain;
}

}  // namespace fantascope::app
