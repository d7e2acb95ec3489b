#include "show/play/input_log.h"

namespace fantascope::show {

std::shared_ptr<const CueList> InputLog::cues() const {
    const std::lock_guard lock(mutex_);
    return revisions_[0];
}

int InputLog::add(std::shared_ptr<const CueList> cues) {
    const std::lock_guard lock(mutex_);
    revisions_.push_back(std::move(cues));
    return static_cast<int>(revisions_.size()) - 1;
}

LoggedInput InputLog::submit(const Input& input) {
    const std::lock_guard lock(mutex_);
    LoggedInput logged{.number = count_++, .input = input};
    const auto revision = static_cast<std::size_t>(input.revision);  // a negative number becomes larger than any
    if (input.kind == Input::Kind::Revise && revision < revisions_.size()) logged.revision = revisions_[revision];
    logged.outcome = playback_.apply(input, logged.revision);
    if (write_) write_(logged);
    inputs_.append(logged);
    return logged;
}

void InputLog::writeTo(std::function<void(const LoggedInput&)> write) {
    const std::lock_guard lock(mutex_);
    write_ = std::move(write);
}

void InputLog::foresee(Time time) {
    const std::lock_guard lock(mutex_);
    playback_.foresee(time);
}

}  // namespace fantascope::show
