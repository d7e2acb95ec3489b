#include "render/source/pattern_rests.h"

#include "core/check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

namespace fantascope::render {
namespace {

using Rests = std::array<pattern::InstancePose, 3>;

constexpr std::size_t kNewest = 2;

// The same turn, by less than half a turn from another one.
double nearestTurn(double angle, double other) { return other + std::remainder(angle - other, 2 * std::numbers::pi); }

}  // namespace

PatternRests::PatternRests(const pattern::ShapePattern& original, const pattern::ShapePattern& previous,
                           const pattern::ShapePattern& newest) {
    struct Entry {
        pattern::ShapeInstance instance;  // of the newest pattern that has it
        Rests rests{};
    };
    std::map<std::uint32_t, Entry> entries;
    const std::array<const pattern::ShapePattern*, 3> patterns{&original, &previous, &newest};
    for (const pattern::ShapePattern* pattern : patterns)
        for (const pattern::ShapeInstance& instance : pattern->instances) entries[instance.id].instance = instance;
    for (std::size_t i = 0; i < patterns.size(); ++i)
        for (const pattern::ShapeInstance& instance : patterns[i]->instances)
            entries[instance.id].rests[i] = {instance.centre, instance.size, instance.rotation};
    pattern::ShapePattern all = newest;
    all.instances.clear();
    for (auto& [id, entry] : entries) {
        for (pattern::InstancePose& rest : entry.rests) {
            if (rest.size > 0) {
                rest.rotation.z = nearestTurn(rest.rotation.z, entry.instance.rotation.z);
                continue;
            }
            rest = {entry.instance.centre, 0, entry.instance.rotation};
        }
        for (const pattern::InstancePose& rest : entry.rests) entry.instance.size = std::max(entry.instance.size, rest.size);
        all.instances.push_back(entry.instance);
        rests_.push_back(entry.rests);
    }
    all_ = std::make_shared<const pattern::ShapePattern>(std::move(all));
}

void PatternRests::mix(const show::PatternExchange& shares, std::span<pattern::InstancePose> poses) const {
    FANTASCOPE_CHECK(poses.size() == rests_.size(), "there is one pose per instance");
    const std::array<double, 3> weights{shares.original, shares.previous, shares.newest()};
    for (std::size_t i = 0; i < poses.size(); ++i) {
        glm::dvec2 centre(0);
        glm::dvec3 rotation(0);
        double area = 0;
        for (std::size_t k = 0; k <= kNewest; ++k) {
            const pattern::InstancePose& rest = rests_[i][k];
            centre += weights[k] * rest.centre;
            rotation += weights[k] * rest.rotation;
            area += weights[k] * rest.size * rest.size;
        }
        const pattern::ShapeInstance& base = all_->instances[i];
        poses[i].centre += centre - base.centre;
        poses[i].rotation += rotation - base.rotation;
        poses[i].size = std::sqrt(area);
    }
}

}  // namespace fantascope::render
