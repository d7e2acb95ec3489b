#include "app/reload/source_stock.h"

#include <algorithm>
#include <chrono>
#include <iterator>

namespace fantascope::app {

namespace {

constexpr Time kKept = std::chrono::seconds(5);  // until every renderer has let go of what was left out

}  // namespace

void SourceStock::ask(Sources wanted) {
    {
        const std::lock_guard lock(mutex_);
        outcome_.reset();
    }
    asked_.writable() = std::move(wanted);
    asked_.publish();
}

std::optional<std::string> SourceStock::outcome() const {
    const std::lock_guard lock(mutex_);
    return outcome_;
}

void SourceStock::release() {
    std::vector<std::pair<Sources, Time>> released;  // destroyed without the lock
    const Time now = now_;
    const std::lock_guard lock(mutex_);
    const auto isOld = [&](const auto& left) { return now - left.second > kKept; };
    std::ranges::copy_if(left_, std::back_inserter(released), isOld);
    std::erase_if(left_, isOld);
}

void SourceStock::makeReady(show::SourceId source, int number, const render::PatternSource& pattern) {
    std::erase_if(made_, [&](const Exchange& each) {
        return each.source == source && (each.number < number - 1 || each.number >= number);
    });
    made_.push_back({source, number, pattern});
    exchanges_.writable() = made_;
    exchanges_.publish();
}

void SourceStock::beginFrame(const show::Playback& playback, Time showTime) {
    now_ = showTime;
    isGiven_ = isLacked_ = false;
    if (exchanges_.update()) ++version_;
    const bool isAsked = asked_.update();
    if (isAsked) {
        wanted_ = asked_.value();
        isAnswered_ = false;
    }
    if (all_ == wanted_) return;
    render::PictureSources all = *wanted_;
    for (const auto& [id, source] : *all_)
        if (wanted_->find(id) == nullptr && playback.needs(id, showTime)) all.add(id, source);
    if (!isAsked && all.size() == all_->size()) return;
    const bool hasOld = all.size() > wanted_->size();
    Sources before = std::exchange(all_, hasOld ? std::make_shared<const render::PictureSources>(std::move(all)) : wanted_);
    const std::lock_guard lock(mutex_);
    left_.emplace_back(std::move(before), showTime);
}

Result<void> SourceStock::giveTo(render::OutputRenderer& renderer, Taken& taken) {
    TRY(giveSources(renderer, taken));
    if (taken.exchanges == version_ || std::exchange(isGiven_, true)) return {};
    taken.exchanges = version_;
    for (const Exchange& each : exchanges_.value()) TRY(renderer.exchange(each.source, each.number, each.pattern));
    return {};
}

Result<void> SourceStock::giveSources(render::OutputRenderer& renderer, Taken& taken) {
    if (taken.all == all_) return {};
    for (const auto& [id, source] : *all_) {
        if (renderer.has(id)) continue;
        isLacked_ = true;
        if (std::exchange(isGiven_, true)) return {};
        const auto added = renderer.add(id, source);
        if (!added) answer(added.error().message());
        return added;
    }
    renderer.dropAllBut(*all_);
    taken.all = all_;
    return {};
}

void SourceStock::endFrame() {
    if (!isLacked_) answer("");
}

void SourceStock::answer(const std::string& trouble) {
    if (std::exchange(isAnswered_, true)) return;
    const std::lock_guard lock(mutex_);
    outcome_ = trouble;
}

}  // namespace fantascope::app
