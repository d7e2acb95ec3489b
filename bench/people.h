#pragma once
// People for shadow benchmarks: they stand in a row and sway, with some 5,000 triangles each.

#include "render/source/picture_source.h"
#include "theatre/stage/cast.h"

#include "core/random.h"

#include <memory>
#include <vector>

namespace fantascope::render {

struct People {
    int count;
    double lampSize = 0;  // metres
    int samples = 16;     // points of light per lamp that has a size
};

// On a screen of 16:9, 2.7 m high.
inline ShadowSource swayingPeople(const People& people) {
    constexpr int kFrames = 16;
    theatre::Cast cast;
    cast.stage.beams[0].light = {0, 0.3, 7};
    cast.framesPerSecond = 12;
    Rng rng(1);
    for (int i = 0; i < people.count; ++i) {
        theatre::Cast::Actor actor{1.75, {}};
        const theatre::Body body = theatre::humanBody(actor.stature);
        std::vector<double> pose = body.restPose({-2 + 4.0 * (i + 0.5) / people.count, 0.93, 1.5}, {0, 0, 1, 0});
        for (double& number : pose) number += rng.uniform(-0.3, 0.3);
        for (int frame = 0; frame < kFrames; ++frame) {
            std::vector<double> swayed = pose;
            for (std::size_t k = 3; k < swayed.size(); ++k) swayed[k] += rng.uniform(-0.1, 0.1);
            body.limit(swayed);
            actor.poses.push_back(theatre::poseOf(body, swayed));
        }
        cast.actors.push_back(std::move(actor));
    }
    ShadowSource source;
    source.lamps = {{cast.stage.beams[0].light, people.lampSize, {1, 0.9f, 0.7f}, {}, {}}};
    source.cast = std::make_shared<const theatre::Cast>(std::move(cast));
    source.from = {-2.4, 0};
    source.to = {2.4, 2.7};
    source.samples = people.samples;
    source.play = ShadowSource::Play::Loop;
    return source;
}

}  // namespace fantascope::render
