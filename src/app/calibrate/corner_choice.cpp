#include "app/calibrate/corner_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace fantascope::app {
namespace {

using Name = Key::Name;

constexpr double kGrab = 16;    // pixels of the picture: a click so near a corner chooses it and does not move it
constexpr double kStill = 3;    // pixels of the picture: a hand that presses a button moves so far
constexpr double kTenths = 10;  // in a camera pixel

std::optional<glm::dvec2> directionOf(Name name) {
    switch (name) {
        case Name::Left:
            return glm::dvec2(-1, 0);
        case Name::Right:
            return glm::dvec2(1, 0);
        case Name::Up:
            return glm::dvec2(0, -1);
        case Name::Down:
            return glm::dvec2(0, 1);
        default:
            return std::nullopt;
    }
}

// Whether the corners run anticlockwise, as a picture from behind does.
bool isMirrored(const std::vector<glm::dvec2>& corners) {
    const glm::dvec2 across = corners[1] - corners[0], down = corners[3] - corners[0];
    return across.x * down.y - across.y * down.x < 0;
}

}  // namespace

CornerChoice::CornerChoice(OpenPlace place, std::string title)
    : place_(std::move(place)),
      title_(std::move(title)),
      picture_(place_),
      corners_(place_.corners.begin(), place_.corners.end()) {}

std::string CornerChoice::obstacle() const {
    if (corners_.size() < 4) return fmt::format("Click where the {} corner is to be.", CornerPicture::kCorners[corners_.size()]);
    std::array<glm::dvec2, 4> corners;
    std::ranges::copy(corners_, corners.begin());
    const auto canvas = vision::PlacedCanvas::of(place_.camera, corners);
    if (!canvas)
        return "The corners are crossed, folded inwards or in a line. Go round clockwise: top left, top right, bottom right, "
               "bottom left.";
    std::vector<std::string> dark;
    for (const std::size_t part : place_.reach.uncovered(*canvas)) dark.push_back(place_.outputs[part]);
    if (dark.empty()) return "";
    return fmt::format(
        "The light of {} does not reach all of the edge: see the bright hatching. Move the corners into the light.",
        fmt::join(dark, " and of "));
}

RgbaImage CornerChoice::picture() const {
    const std::string obstacle = this->obstacle();
    std::string message = refused_ ? "Not possible yet. " + obstacle : obstacle;
    if (obstacle.empty())
        message = isMirrored(corners_) ? "Mirrored: the corners run anticlockwise. If that is right, Enter takes this place."
                                       : "The edge lies in the light. Enter takes this place.";
    return picture_.drawn({title_, corners_, chosen_, message, refused_});
}

void CornerChoice::take(const ScreenEvent& event) {
    if (state_ != State::Open) return;
    switch (event.kind) {
        case ScreenEvent::Kind::KeyDown:
            return press(event.key);
        case ScreenEvent::Kind::KeyUp:
            arrow_.reset();
            return;
        case ScreenEvent::Kind::ButtonDown:
            return grab(event.at);
        case ScreenEvent::Kind::PointerMoved:
            return drag(event.at);
        case ScreenEvent::Kind::ButtonUp:
            drag_.reset();
            return;
    }
}

void CornerChoice::press(const Key& key) {
    if (const auto direction = directionOf(key.name)) {
        // A held key repeats, and is taken back as a whole.
        if (std::exchange(arrow_, key.name) != key.name) arrowRemembered_ = false;
        if (!corners_.empty())
            move(corners_[chosen_] + *direction * (key.shift ? 10 : key.control ? 1 / kTenths : 1), arrowRemembered_);
        return;
    }
    arrow_.reset();
    if (key.name == Name::Escape) state_ = State::GivenUp;
    if (key.name == Name::Enter) enter();
    if (key.name == Name::Backspace) undo();
    if (key.name == Name::Tab && !corners_.empty()) chosen_ = (chosen_ + (key.shift ? corners_.size() - 1 : 1)) % corners_.size();
    if (key == Key{.letter = 'n'} && !corners_.empty()) {
        remember();
        corners_.clear();
        chosen_ = 0;
    }
}

void CornerChoice::grab(glm::dvec2 at) {
    arrow_.reset();
    if (!place_.camera.inPicture(picture_.cameraFromPicture(at))) return;
    const auto away = [&](glm::dvec2 corner) { return glm::distance(picture_.pictureFromCamera(corner), at); };
    drag_ = Drag{at, glm::dvec2(0), true, false};
    if (corners_.size() < 4) {
        remember();
        drag_->remembered = true;
        chosen_ = corners_.size();
        corners_.emplace_back(-1);
    } else {
        chosen_ = static_cast<std::size_t>(std::ranges::min_element(corners_, {}, away) - corners_.begin());
        if (away(corners_[chosen_]) <= kGrab) {
            drag_->offset = picture_.pictureFromCamera(corners_[chosen_]) - at;
            drag_->moves = false;
        }
    }
    drag(at);
}

void CornerChoice::drag(glm::dvec2 at) {
    if (!drag_) return;
    drag_->moves = drag_->moves || glm::distance(at, drag_->from) > kStill;
    if (drag_->moves) move(picture_.cameraFromPicture(at + drag_->offset), drag_->remembered);
}

// Moves the chosen corner. `remembered`: whether the move can be taken back already.
void CornerChoice::move(glm::dvec2 to, bool& remembered) {
    const glm::dvec2 now = corners_[chosen_];
    // A coordinate that does not move keeps its fractions.
    to = glm::mix(glm::round(to * kTenths) / kTenths, now, glm::equal(to, now));
    to = glm::clamp(to, glm::dvec2(0), glm::dvec2(place_.camera.size));
    if (to == now) return;
    if (!std::exchange(remembered, true)) remember();
    refused_ = false;
    corners_[chosen_] = to;
}

void CornerChoice::remember() {
    refused_ = false;
    steps_.push_back({corners_, chosen_});
}

void CornerChoice::undo() {
    drag_.reset();
    if (steps_.empty()) return;
    refused_ = false;
    corners_ = steps_.back().corners;
    chosen_ = steps_.back().chosen;
    steps_.pop_back();
}

void CornerChoice::enter() {
    drag_.reset();
    refused_ = !obstacle().empty();
    if (!refused_) state_ = State::Taken;
}

}  // namespace fantascope::app
