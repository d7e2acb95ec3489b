#pragma once

#include "show/revision.h"

#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <utility>

namespace fantascope::show {

// The revisions of the show that have played in a run, for whoever tells of its cues: what is seen
// at a moment is of the revision with the number ShowState::revision. None is forgotten, so
// references stay valid.
// Thread: any.
class PlayedShow {
public:
    explicit PlayedShow(std::shared_ptr<const Revision> first) { revisions_.push_back(std::move(first)); }

    // `number`: 0 is the revision that the run began with, then 1, 2, 3 ... as they were taken.
    const Revision& at(std::size_t number) const {
        const std::lock_guard lock(mutex_);
        return *revisions_.at(number);
    }
    const Revision& newest() const {
        const std::lock_guard lock(mutex_);
        return *revisions_.back();
    }
    // Lets `take()` submit the input that continues with `revision`, and keeps the revision if that
    // returns true. Nobody who holds still() submits an input meanwhile.
    bool revise(std::shared_ptr<const Revision> revision, auto take) {
        const std::lock_guard changing(changing_);
        {
            const std::lock_guard lock(mutex_);
            revisions_.push_back(std::move(revision));
        }
        if (take()) return true;
        const std::lock_guard lock(mutex_);
        revisions_.pop_back();
        return false;
    }
    // As long as the result lives, the show is not revised: for inputs that name a cue by its
    // index.
    std::unique_lock<std::mutex> still() const { return std::unique_lock(changing_); }

private:
    mutable std::mutex changing_, mutex_;
    std::deque<std::shared_ptr<const Revision>> revisions_;  // under mutex_
};

}  // namespace fantascope::show
