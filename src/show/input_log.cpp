#include "show/input_log.h"

namespace fantascope::show {

LoggedInput InputLog::submit(const Input& input) {
    const std::lock_guard lock(mutex_);
    const LoggedInput logged{count_++, input, playback_.apply(input)};
    inputs_.append(logged);
    return logged;
}

}  // namespace fantascope::show
