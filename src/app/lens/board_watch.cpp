#include "app/lens/board_watch.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace fantascope::app {
namespace {

using vision::BoardView;
using vision::PictureTrouble;

// Of the picture's width: how far the board's corners move at most from one frame to the next where
// it stands still, and how far at least from each other view in a new one.
constexpr double kStill = 0.002, kElsewhere = 0.05;
// A view is thrown away only where so many tell that it does not fit.
constexpr std::size_t kFewestToJudge = 6;
// A camera that works never gives the same bytes so often, because of its noise.
constexpr int kFrozenFrames = 10;
constexpr const char* kFrozenAdvice = "the camera repeats one picture: unplug it, and plug it in again";

// The mean distance of the corners that both show, in picture widths; infinite: they show too few
// in common.
double distanceBetween(const BoardView& a, const BoardView& b) {
    double sum = 0;
    std::size_t shared = 0;
    for (const BoardView::Corner& corner : a.corners) {
        const auto other = std::ranges::find(b.corners, corner.corner, &BoardView::Corner::corner);
        if (other == b.corners.end()) continue;
        sum += glm::distance(corner.pixel, other->pixel);
        ++shared;
    }
    if (shared < vision::kFewestCorners) return std::numeric_limits<double>::infinity();
    return sum / static_cast<double>(shared) / a.size.x;
}

}  // namespace

void Missed::count(PictureTrouble trouble) {
    ++pictures;
    black += trouble == PictureTrouble::Black;
    saturated += trouble == PictureTrouble::Saturated;
}

std::string Missed::why() const {
    if (2 * black > pictures) return "the pictures are black; light the board, take the cap off the lens, or raise the exposure";
    if (2 * saturated > pictures) return "the pictures are white; lower the exposure or the gain, or take light off the board";
    if (frozen) return "the camera repeats one picture again and again; unplug it, and plug it in again";
    return "no board was found; print one with 'fantascope lens --board', and show it flat, sharp and with its white margin";
}

bool BoardWatch::isFrozen(const RgbaImage& frame) {
    same_ = std::ranges::equal(frame.pixels(), last_.pixels()) ? same_ + 1 : 0;
    last_ = frame;
    return same_ >= kFrozenFrames;
}

bool BoardWatch::look(const RgbaImage& frame) {
    missed_.frozen = isFrozen(frame);
    auto view = vision::findBoard(frame);
    if (!view) {
        const PictureTrouble trouble = vision::troubleOf(frame);
        missed_.count(trouble);
        before_.reset();
        advice_ = trouble == PictureTrouble::Black       ? "the picture is black: light the board, or raise the exposure"
                  : trouble == PictureTrouble::Saturated ? "the picture is white: lower the exposure or the gain"
                  : missed_.frozen                       ? kFrozenAdvice
                                                         : "show the board to the camera";
        return false;
    }
    const bool still = isStill(*view), elsewhere = isNew(*view);
    before_ = *view;
    if (!still || !elsewhere) {
        const std::string step = needs_.sentence();
        advice_ = missed_.frozen ? kFrozenAdvice : !elsewhere && !step.empty() ? step : "hold the board still";
        return false;
    }
    views_.push_back(std::move(*view));
    fit();
    advice_ = needs_.sentence();
    return true;
}

bool BoardWatch::isStill(const BoardView& view) const { return before_ && distanceBetween(view, *before_) < kStill; }

bool BoardWatch::isNew(const BoardView& view) const {
    return std::ranges::all_of(views_, [&](const BoardView& other) { return distanceBetween(view, other) > kElsewhere; });
}

void BoardWatch::fit() {
    fit_.reset();
    if (auto fitted = vision::fitLens(views_)) fit_ = std::move(*fitted);
    if (fit_ && views_.size() >= kFewestToJudge) {
        std::vector<BoardView> kept;
        std::vector<vision::LensFit::View> judged;
        for (std::size_t i = 0; i < views_.size(); ++i) {
            if (!fit_->views[i].used) continue;
            kept.push_back(std::move(views_[i]));
            judged.push_back(fit_->views[i]);
        }
        thrownAway_ += static_cast<int>(views_.size() - kept.size());
        views_ = std::move(kept);
        fit_->views = std::move(judged);
    }
    needs_ = vision::needsOf(views_, fit_ ? &*fit_ : nullptr);
}

double BoardWatch::done() const {
    const double views = 1 - static_cast<double>(needs_.views) / vision::kEnoughViews;
    const double places = 1 - static_cast<double>(needs_.places.size()) / (vision::kParts.x * vision::kParts.y);
    const double tilts = 1 - static_cast<double>(needs_.tilts.size()) / 4;
    return (2 * views + places + tilts + (needs_.isUncertain ? 0 : 1)) / 5;
}

}  // namespace fantascope::app
