#pragma once

#include "pattern/shape/shape_pattern.h"
#include "show/show_state.h"

#include <array>
#include <memory>
#include <span>
#include <vector>

namespace fantascope::render {

// Where the instances of a source rest in the patterns of an exchange: in its own pattern, in that
// of the exchange before, and in the new one. An instance of the same id moves from one place to
// the other; one that is not in a pattern has no size there. So shapes come by growing and go by
// shrinking. Their light, not their size, changes evenly. Thread: any.
class PatternRests {
public:
    PatternRests(const pattern::ShapePattern& original, const pattern::ShapePattern& previous,
                 const pattern::ShapePattern& newest);

    // All instances of the three patterns, by id: each as in the newest pattern that has it, with
    // the largest of its sizes. Its other properties are those of `newest`.
    const std::shared_ptr<const pattern::ShapePattern>& all() const { return all_; }
    // Moves the poses that all() has at one moment to where they are during the exchange.
    void mix(const show::PatternExchange& shares, std::span<pattern::InstancePose> poses) const;

private:
    std::shared_ptr<const pattern::ShapePattern> all_;
    std::vector<std::array<pattern::InstancePose, 3>> rests_;  // by instance of all_; original, previous, newest
};

}  // namespace fantascope::render
