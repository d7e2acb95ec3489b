#include "app/watch/pattern_correction.h"

#include "pattern/search/refit.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <thread>
#include <utility>

namespace fantascope::app {
namespace {

// Walls differ if their light does by this share, on the mean.
constexpr double kUnlike = 0.03;

bool isLike(const GreyImage& a, const GreyImage& b) {
    double sum = 0, difference = 0;
    for (std::size_t i = 0; i < a.pixels().size(); ++i) {
        sum += b.pixels()[i];
        difference += std::abs(double(a.pixels()[i]) - b.pixels()[i]);
    }
    return difference < kUnlike * sum;
}

show::event::PatternFitted newsOf(const std::string& source, const pattern::PatternRefit& refit, bool isApplied) {
    return {source, refit.toneBefore, refit.toneAfter, refit.kept, refit.made, refit.removed, refit.changed, isApplied};
}

}  // namespace

struct PatternCorrection::Fitted {
    PatternOnWall wall;
    int number = 0;  // of its newest exchange
    std::shared_ptr<const pattern::ShapePattern> shown = wall.pattern;
    std::optional<GreyImage> searchedOn{};  // the wall's light at the last search
    int notBefore = kEnough;                // pictures: the next search
};

// One search. Its thread writes the results, which are read once it has ended.
struct PatternCorrection::Job {
    Fitted& fitted;
    int due;  // pictures: its result does not count before
    GreyImage light;
    pattern::PatternRefit refit{};
    render::PatternSource exchanged{};  // only if the pattern is to be exchanged
    std::atomic<bool> isDone = false;
    bool isReady = false;   // to be drawn
    std::jthread thread{};  // last, so that it ends before the other members are destroyed

    bool isWorth(const show::Corrections::Pattern& bounds) const {
        return refit.gain() >= bounds.gain && refit.toneBefore - refit.toneAfter >= kSeen;
    }
    void run(const std::stop_token& stop, const show::Corrections::Pattern& bounds) {
        using pattern::PatternSearch;
        const auto askStop = [&](const PatternSearch::Progress&) {
            return stop.stop_requested() ? std::optional(PatternSearch::StopReason::Interrupted) : std::nullopt;
        };
        refit = pattern::PatternRefit::of(*fitted.shown, fitted.wall.guide, light, {.more = bounds.more, .least = bounds.least},
                                          askStop);
        if (bounds.mode == show::Corrections::Mode::Automatic && isWorth(bounds) && !stop.stop_requested()) {
            auto rests = std::make_shared<const render::PatternRests>(*fitted.wall.pattern, *fitted.shown, refit.pattern);
            auto motion = std::make_shared<const pattern::PatternMotion>(*rests->all(), 1);
            exchanged = {rests->all(), std::move(motion), std::move(rests)};
        }
        isDone = true;
    }
};

PatternCorrection::PatternCorrection(const show::Corrections::Pattern& bounds, std::vector<PatternOnWall> patterns, bool waits,
                                     MakeReady makeReady, show::InputLog& inputs, show::EventLog& events)
    : bounds_(bounds), waits_(waits), makeReady_(std::move(makeReady)), inputs_(inputs), events_(events) {
    for (PatternOnWall& wall : patterns) {
        for (const vision::CanvasSurface::Part& part : wall.surface.parts) told_.resize(std::max(told_.size(), part.output + 1));
        patterns_.push_back(std::make_unique<Fitted>(Fitted{std::move(wall)}));
    }
}

PatternCorrection::~PatternCorrection() = default;

void PatternCorrection::end() {
    isOver_ = true;
    job_.reset();
}

void PatternCorrection::see(vision::WallWatch& wall, const std::vector<bool>& isTrusted, const show::ShowState& shown,
                            Time showTime) {
    if (isOver_ || patterns_.empty()) return;
    comeAgain(shown, showTime);
    if (measured_ && showTime - *measured_ < kStep) return;
    measured_ = showTime;
    ++pictures_;
    measure(wall, isTrusted);
    if (!job_)
        begin(wall);
    else if (job_->isReady)
        exchange(showTime);
    else
        finish(showTime);
}

void PatternCorrection::measure(vision::WallWatch& wall, const std::vector<bool>& isTrusted) {
    std::vector<bool> isDone(told_.size());
    for (const auto& fitted : patterns_)
        for (const vision::CanvasSurface::Part& part : fitted->wall.surface.parts) {
            if (isDone[part.output] || !isTrusted[part.output]) continue;
            isDone[part.output] = true;
            told_[part.output] += wall.measureSurface(part.output) ? 1 : 0;
        }
}

// What was taken back comes again once corrections are allowed again.
void PatternCorrection::comeAgain(const show::ShowState& shown, Time showTime) {
    if (!std::exchange(corrects_, shown.corrects) && shown.corrects)
        for (const auto& fitted : patterns_)
            if (fitted->number > 0)
                inputs_.submit({.at = showTime,
                                .kind = show::Input::Kind::Exchange,
                                .source = show::Input::Source::Camera,
                                .which = static_cast<int>(fitted->wall.source.value),
                                .revision = fitted->number});
}

// Begins a search for the next pattern whose wall is known and is not as it was at its last search.
void PatternCorrection::begin(const vision::WallWatch& wall) {
    if (!corrects_) return;
    Fitted& fitted = *patterns_[next_++ % patterns_.size()];
    if (pictures_ < fitted.notBefore) return;
    std::map<std::size_t, vision::WallChange> changes;
    for (const vision::CanvasSurface::Part& part : fitted.wall.surface.parts) {
        if (told_[part.output] < kEnough) return;
        changes.emplace(part.output, wall.surfaceChange(part.output));
    }
    GreyImage light = fitted.wall.surface.light(changes);
    fitted.notBefore = pictures_ + kEnough;
    if (fitted.searchedOn && isLike(light, *fitted.searchedOn)) return;
    fitted.searchedOn = light;
    job_.reset(new Job{fitted, pictures_ + kSearch, std::move(light)});
    job_->thread = std::jthread([job = job_.get(), bounds = bounds_](const std::stop_token& stop) { job->run(stop, bounds); });
}

void PatternCorrection::finish(Time showTime) {
    if (pictures_ < job_->due) return;
    if (waits_) job_->thread.join();
    if (!job_->isDone) return;
    Fitted& fitted = job_->fitted;
    const bool isAutomatic = bounds_.mode == show::Corrections::Mode::Automatic;
    fitted.notBefore = pictures_ + kEnough;
    if (isAutomatic && corrects_ && job_->isWorth(bounds_)) {
        makeReady_(fitted.wall.source, fitted.number + 1, job_->exchanged);
        job_->isReady = true;
        return;
    }
    if (!isAutomatic && job_->isWorth(bounds_)) events_.append({showTime, newsOf(fitted.wall.name, job_->refit, false)});
    if (!corrects_) fitted.searchedOn.reset();  // it may come yet
    job_.reset();
}

void PatternCorrection::exchange(Time showTime) {
    Fitted& fitted = job_->fitted;
    const auto logged = inputs_.submit({.at = showTime,
                                        .kind = show::Input::Kind::Exchange,
                                        .source = show::Input::Source::Camera,
                                        .which = static_cast<int>(fitted.wall.source.value),
                                        .revision = fitted.number + 1});
    if (logged.outcome == show::Outcome::Taken) {
        ++fitted.number;
        fitted.shown = std::make_shared<const pattern::ShapePattern>(std::move(job_->refit.pattern));
        events_.append({showTime, newsOf(fitted.wall.name, job_->refit, true)});
    } else {
        fitted.searchedOn.reset();
    }
    job_.reset();
}

}  // namespace fantascope::app
