#pragma once

#include <cstdint>

namespace fantascope::pattern {

// The purpose of a random stream, the first part of its identity, as in streamSeed(pattern.seed,
// {Stream::InstanceMotion, id, axis}). So no two purposes share a stream. The values are part of
// what a seed means: never change or reuse one.
struct Stream {
    enum : std::uint64_t {
        GroupCentres = 0x4701,     // where fuzzy c-means starts
        GroupMembership = 0x4702,  // + instance id: the draw of its group
        GroupMotion = 0x4703,      // + group, axis
        InstanceMotion = 0x4704,   // + instance id, axis
        InstanceColour = 0x4705,   // + instance id
        SearchStart = 0x4706,      // the random pattern that the paper's method starts with
        SearchCandidate = 0x4707,  // + iteration, slot
        TypicalViews = 0x4708,     // + shape: the rotations over which a shape's area is averaged
        RefinedMoves = 0x4709,     // the moves of the refined method
    };
};

}  // namespace fantascope::pattern
