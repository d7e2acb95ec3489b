#pragma once

#include "show/playback.h"
#include "show/site/site.h"

#include "core/clock.h"

#include <optional>
#include <utility>
#include <vector>

namespace fantascope::show {

// Turns the hand controller's presses into inputs. One press is one input, however long it lasts: a
// button that was not let go of asks for nothing more. Thread: bound to one thread at a time.
class CueButtons {
public:
    // `buttons`: as in Site::buttons.
    explicit CueButtons(const std::vector<std::pair<int, Button>>& buttons);

    // `button` went down or up at show time `at`. Gives the input that this asks for; none for a
    // release, and for a button that steps no cues.
    std::optional<Input> inputFor(int button, bool pressed, Time at);

private:
    struct Key {
        int number = 0;
        Input::Kind kind = Input::Kind::Go;
        bool down = false;
    };
    std::vector<Key> keys_;
};

}  // namespace fantascope::show
