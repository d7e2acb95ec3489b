#pragma once

#include "show/play/playback.h"
#include "show/site/site.h"

#include "core/clock.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::show {

// Turns the hand controller's presses into inputs. One press is one input, however long it lasts: a
// held button gives no further input. Thread: bound to one thread at a time.
class CueButtons {
public:
    // `buttons`: as in Site::buttons. `sides`: the names of the show's side lists.
    explicit CueButtons(const std::vector<SiteButton>& buttons, const std::vector<std::string>& sides = {});

    // Call this when `button` went down or up at show time `at`. Returns the input that this asks
    // for. A release gives none, nor does a button for setting up.
    std::optional<Input> inputFor(int button, bool pressed, Time at);

private:
    struct Key {
        int number = 0;
        Input::Kind kind = Input::Kind::Go;
        int list = 0;
        bool down = false;
    };
    std::vector<Key> keys_;
};

}  // namespace fantascope::show
