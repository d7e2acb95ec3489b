#pragma once
// A cast written by hand, for what reads casts.

#include "theatre/body/joint.h"
#include "theatre/body/posed_body.h"
#include "theatre/stage/cast.h"

#include "pictures.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <numbers>
#include <string>
#include <vector>

namespace fantascope {

// Two people side by side who raise their arms and walk aside, frame by frame; one frame is a
// still. `stage`: a stage's file in the folder.
inline theatre::Cast writeACast(const ScratchFolder& folder, const std::string& name, std::size_t frames,
                                const std::string& stage = "") {
    EXPECT_TRUE(writePng(folder / "target.png", pictureOf(120, 100, [](int x, int y) { return isIn(x, y, 5, 10, 110, 90); })));
    theatre::Cast cast;
    cast.targets[0].file = folder / "target.png";
    cast.targets[0].height = 2.4;
    cast.stage.beams[0].light = {0.1, 0.05, 7};
    if (!stage.empty()) cast.stageFile = folder / stage;
    cast.framesPerSecond = frames > 1 ? 12.5 : 0;
    for (const double x : {-0.6, 0.5}) {
        theatre::Cast::Actor actor;
        actor.stature = x < 0 ? 1.7 : 1.6;
        const theatre::Body body = theatre::humanBody(actor.stature);
        for (std::size_t frame = 0; frame < frames; ++frame) {
            const double t = 0.3 * static_cast<double>(frame);
            std::vector<double> pose =
                body.restPose({x + 0.1 * t, body.joints[0].offset.y, 2 + x}, theatre::rotationOf({0, std::numbers::pi + t, 0}));
            for (std::size_t i = 6; i < pose.size(); ++i) pose[i] += 0.3 * std::sin(double(i) + t);
            body.limit(pose);
            actor.poses.push_back(theatre::poseOf(body, pose));
        }
        cast.actors.push_back(std::move(actor));
    }
    const auto written = theatre::writeCast(folder / name, cast);
    EXPECT_TRUE(written) << written.error().message();
    return theatre::readCast(folder / name).value();
}

// What somebody holds, what stands, and what is stood upon.
inline void writeAStage(const ScratchFolder& folder, const std::string& name) {
    folder.file("box.obj",
                "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
                "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 1 5 8 4\nf 2 3 7 6\n");
    folder.file(name,
                "fantascope: stage\nversion: 1\nlight: [0.1, 0.05, 7]\n"
                "platforms:\n  - {name: step, centre: [1.4, 0.1, 2], size: [0.5, 0.2, 0.5], turned: 20}\n"
                "props:\n  - {name: rock, mesh: box.obj, scale: 0.1, at: [-1.5, 0.1, 2], turned: [0, 30, 0]}\n"
                "  - {name: parcel, mesh: box.obj, scale: 0.08, at: [0.05, 0, 0], turned: [10, 20, 30], held_by: {actor: 2, "
                "part: left hand}}\n");
}

}  // namespace fantascope
