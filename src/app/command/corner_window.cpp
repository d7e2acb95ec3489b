#include "app/command/corner_window.h"

#include "app/calibrate/corner_choice.h"
#include "drivers/display/picture_window.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

using Corners = std::array<glm::dvec2, 4>;

constexpr const char* kWindowTitle = "Fantascope: corners";
constexpr Time kPollEvery = std::chrono::milliseconds(15);
// A window that was covered or resized needs its picture again, and says nothing of it.
constexpr Time kShowAgain = std::chrono::milliseconds(250);
constexpr const char* kInstead =
    "Without a window, a file can say where the canvas is to stand: calibrate with --picture wall.png, which saves the camera's "
    "picture of the lit wall; read the corners off it, and give them with --wanted FILE (docs/calibrating.md)";

Error unchanged(const std::string& why) { return Error(why + "; nothing is changed"); }

std::string titleOf(const std::vector<OpenPlace>& places, std::size_t index) {
    const OpenPlace& place = places[index];
    std::string title = fmt::format("Where should the canvas '{}' stand?", place.canvas);
    if (place.outputs != std::vector{place.canvas}) title += fmt::format("   Its outputs: {}.", fmt::join(place.outputs, ", "));
    if (places.size() > 1) title += fmt::format("   Canvas {} of {}", index + 1, places.size());
    return title;
}

// Tells the repetitions of a held Enter, which takes one place and not the next one, too.
class HeldEnter {
public:
    bool repeats(const ScreenEvent& event) {
        if (event.key.name != Key::Name::Enter) return false;
        const bool isDown = event.kind == ScreenEvent::Kind::KeyDown;
        return std::exchange(held_, isDown) && isDown;
    }

private:
    bool held_ = false;
};

Result<Corners> choosePlace(CornerChoice& choice, drivers::PictureWindow& window, HeldEnter& enter, Clock& clock,
                            const std::function<bool()>& goesOn) {
    std::optional<Time> shown;
    RgbaImage picture;
    for (bool changed = true; choice.state() == CornerChoice::State::Open;) {
        if (!goesOn()) return unchanged("ended before a place was chosen");
        if (changed) picture = choice.picture();
        if (changed || clock.now() - *shown >= kShowAgain) {
            window.show(picture);
            shown = clock.now();
        }
        clock.sleepUntil(clock.now() + kPollEvery);
        changed = false;
        while (const auto event = window.pollEvent()) {
            if (!enter.repeats(*event)) choice.take(*event);
            changed = true;
        }
        if (!window.absence().empty())
            return Error(fmt::format("{} before a place was chosen; nothing is changed. {}", window.absence(), kInstead));
    }
    if (choice.state() == CornerChoice::State::GivenUp) return unchanged("given up by Escape in the window");
    Corners corners;
    std::ranges::copy(choice.corners(), corners.begin());
    return corners;
}

}  // namespace

Result<void> checkCornerWindow() {
    if (const auto can = drivers::PictureWindow::check(); !can)
        return Error(fmt::format("--wanted window: no window can be opened: {}. {}", can.error().message(), kInstead));
    return {};
}

Result<std::vector<Corners>> choosePlaces(const std::vector<OpenPlace>& places, Clock& clock,
                                          const std::function<bool()>& goesOn) {
    const auto window = TRY(drivers::PictureWindow::open(kWindowTitle, CornerPicture::kSize));
    HeldEnter enter;
    std::vector<Corners> chosen;
    for (std::size_t i = 0; i < places.size(); ++i) {
        CornerChoice choice(places[i], titleOf(places, i));
        chosen.push_back(TRY(choosePlace(choice, *window, enter, clock, goesOn)));
    }
    return chosen;
}

}  // namespace fantascope::app
