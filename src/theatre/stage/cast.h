#pragma once

#include "theatre/body/actor_pose.h"
#include "theatre/stage/stage.h"

#include "core/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::theatre {

// The result of a search for poses: the actors and their poses, on which stage, for which targets.
struct Cast {
    struct Actor {
        double stature = 0;            // metres, of humanBody()
        std::vector<ActorPose> poses;  // one for each frame; every actor has as many
    };
    // A silhouette on the screen of a beam.
    struct Target {
        std::filesystem::path file;      // its picture, as a path that this process can open
        double height = 0;               // on the screen, metres
        std::optional<double> middle{};  // TargetPlace::middle, metres; none only for the first beam's
    };
    std::vector<Target> targets{Target{}};  // of each beam of the stage
    Stage stage;
    std::optional<std::filesystem::path>
        stageFile;               // in the cast's folder or below it; none: the stage is a lamp and nothing else
    double framesPerSecond = 0;  // 0: a still, with one frame
    std::uint64_t seed = 0;
    std::vector<Actor> actors;
    // The sequence that a motion follows, the frame of it that is the target (the representative
    // one), and the frame of the first poses. Frames count from 0.
    struct Sequence {
        std::filesystem::path file;  // sequence.yaml, in the cast's folder or below it
        std::size_t representative = 0, first = 0;
    };
    std::optional<Sequence> sequence{};
};

// Reads or writes *.cast.yaml, docs/cast-format.md. The stage's file is read with it, and must
// exist when a cast that names it is written. Error: names file, line and what to do; for instance
// a quaternion that is not of length 1, or that is outside a joint's limits by more than a
// thousandth of a degree. Writing goes to a temporary file that is then renamed. The targets must
// lie in the cast's folder or below it.
Result<Cast> readCast(const std::filesystem::path& file);
Result<void> writeCast(const std::filesystem::path& file, const Cast& cast);

}  // namespace fantascope::theatre
