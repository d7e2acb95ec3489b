#pragma once

#include <cstdint>

namespace fantascope::theatre {

// The purpose of a random stream. It is the first part of the stream's identity (core/random.h), so
// that no two purposes share a stream. The values determine the results of a seed: never change or
// reuse one.
struct Stream {
    enum : std::uint64_t {
        Trial = 1,    // + number: the seed of a search's trial
        Moves = 2,    // of a trial
        Mending = 3,  // + frame: of a motion's
    };
};

}  // namespace fantascope::theatre
