#include "app/journal/night.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace fantascope::app {

namespace {

using show::kHolds;

// Reads the lines of a journal one after the other.
class Reader {
public:
    Night read(const show::Journal& journal) {
        night_.damaged = journal.damaged;
        for (const show::Journal::Entry& entry : journal.entries) std::visit(*this, entry.line);
        endStretches();
        return std::move(night_);
    }

    void operator()(const show::journal::Run& run) {
        if (run.goesOn) reach(run.at);  // the run before was alive until then
        endStretches();
        night_.runs.push_back({run.at, run.at, run.utc, "", run.goesOn});
        night_.show = run.show;
        cue_.clear();
        held_ = {};
        frames_ = late_ = 0;
    }
    void operator()(const show::journal::Clock& clock) {
        reach(clock.at);
        if (!night_.runs.empty()) night_.runs.back().utc = clock.utc - (clock.at - night_.runs.back().from);
    }
    void operator()(const show::Input& input) {
        reach(input.at);
        using Kind = show::Input::Kind;
        const bool isCorrection = input.kind == Kind::Correct || input.kind == Kind::Exchange || input.kind == Kind::Trim;
        if (isCorrection) {
            ++night_.corrections;
            return;
        }
        Night::Press press{input.at, std::string(show::nameOf(input.kind)), std::string(show::nameOf(input.source))};
        if (input.kind == Kind::Jump || input.kind == Kind::Load)
            press.what += input.cue < 0 ? " to the dark" : fmt::format(" {}", input.cue + 1);
        if (input.kind == Kind::Master) press.what += fmt::format(" {:.0f} %", 100 * input.level);
        if (input.late) press.what += ", too late";
        using Source = show::Input::Source;
        if (input.source == Source::Controller || input.source == Source::Contact) press.by += fmt::format(" {}", input.which);
        night_.presses.push_back(std::move(press));
    }
    void operator()(const show::journal::State& state) {
        reach(state.at);
        if (state.cue != cue_) {
            endCue(state.at);
            cue_ = state.cue;
            cueFrom_ = state.at;
        }
        for (std::size_t i = 0; i < std::size(kHolds); ++i) {
            const bool on = state.controls.*kHolds[i].on;
            if (on && !held_[i]) held_[i] = state.at;
            if (!on) endHold(i, state.at);
        }
    }
    void operator()(const show::journal::Told& told) {
        reach(told.at);
        night_.events.push_back(told);
    }
    void operator()(const show::journal::Figures& figures) {
        reach(figures.at);
        night_.lateFrames.emplace_back(figures.at, figures.lateFrames - late_);
        night_.frames += figures.frames - std::exchange(frames_, figures.frames);
        night_.late += figures.lateFrames - std::exchange(late_, figures.lateFrames);
        for (const auto& [output, z] : figures.z)
            if (z >= 0) night_.z[output].emplace_back(figures.at, z);
    }
    void operator()(const show::journal::Gap&) { ++night_.gaps; }
    void operator()(const show::journal::End& end) {
        reach(end.at);
        if (!night_.runs.empty()) night_.runs.back().ended = end.why;
    }

private:
    void reach(Time at) {
        if (night_.runs.empty()) night_.runs.emplace_back();  // the line of its beginning is damaged
        night_.runs.back().to = std::max(night_.runs.back().to, at);
    }
    void endCue(Time at) {
        if (!cue_.empty() && at > cueFrom_) add(night_.cues, {cueFrom_, at, cue_});
    }
    // One that goes on in the next run is one.
    static void add(std::vector<Night::Stretch>& stretches, Night::Stretch stretch) {
        const auto same = [&](const Night::Stretch& before) { return before.what == stretch.what && before.to == stretch.from; };
        const auto before = std::ranges::find_if(stretches, same);
        if (before != stretches.end())
            before->to = stretch.to;
        else
            stretches.push_back(std::move(stretch));
    }
    void endHold(std::size_t hold, Time at) {
        if (const std::optional<Time> since = std::exchange(held_[hold], std::nullopt))
            add(night_.holds, {*since, at, std::string(kHolds[hold].name)});
    }
    void endStretches() {
        if (night_.runs.empty()) return;
        const Time at = night_.runs.back().to;
        endCue(at);
        for (std::size_t i = 0; i < std::size(kHolds); ++i) endHold(i, at);
    }

    Night night_;
    std::string cue_;
    Time cueFrom_{};
    std::array<std::optional<Time>, std::size(kHolds)> held_;
    std::int64_t frames_ = 0, late_ = 0;  // of this run so far
};

}  // namespace

std::size_t Night::deaths() const {
    if (runs.empty()) return 0;
    return static_cast<std::size_t>(
        std::count_if(runs.begin(), runs.end() - 1, [](const Run& run) { return run.ended.empty(); }));
}

WallTime Night::wallTimeOf(Time at) const {
    const Run* run = runs.empty() ? nullptr : &runs.front();
    for (const Run& candidate : runs)
        if (candidate.from <= at) run = &candidate;
    return run == nullptr ? WallTime{} : localTimeOf(run->utc + (at - run->from));
}

Night nightOf(const show::Journal& journal) { return Reader().read(journal); }

}  // namespace fantascope::app
