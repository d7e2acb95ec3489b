#pragma once

#include <cstdint>

namespace fantascope::theatre {

// What a random stream is for: it leads the stream's identity (core/random.h), so that no two
// purposes ever share one. The values are part of what a seed means: never change or reuse one.
struct Stream {
    enum : std::uint64_t {
        Trial = 1,    // + number: the seed of a search's trial
        Moves = 2,    // of a trial
        Mending = 3,  // + frame: of a motion's
    };
};

}  // namespace fantascope::theatre
