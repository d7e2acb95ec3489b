#pragma once

#include "theatre/body/actor_pose.h"
#include "theatre/stage/stage.h"

#include "core/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::theatre {

// What a search for poses leaves behind: who stands how, on which stage, for which target.
struct Cast {
    struct Actor {
        double stature = 0;            // metres, of humanBody()
        std::vector<ActorPose> poses;  // one a frame, as many as the others have
    };
    // A silhouette on the screen of a beam.
    struct Target {
        std::filesystem::path file;      // its picture; as the program that reads the file can open it
        double height = 0;               // on the screen, metres
        std::optional<double> middle{};  // TargetPlace::middle, metres; none for the first beam's alone
    };
    std::vector<Target> targets{Target{}};  // of each beam of the stage
    Stage stage;
    std::optional<std::filesystem::path>
        stageFile;               // of the stage, in the file's folder or below it; none: there is a lamp and nothing else
    double framesPerSecond = 0;  // 0: a still, with one frame
    std::uint64_t seed = 0;
    std::vector<Actor> actors;
    // What a motion follows: the silhouette that moves, the frame of it that the target is, and the
    // one that the first poses are of; from 0.
    struct Sequence {
        std::filesystem::path file;  // sequence.yaml, in the cast's folder or below it
        std::size_t representative = 0, first = 0;
    };
    std::optional<Sequence> sequence{};
};

// *.cast.yaml, docs/cast-format.md; a stage's file is read with it, and must be there when a cast
// that names it is written. A quaternion that is not of length 1, or outside a joint's limits by
// more than a thousandth of a degree, is refused with its place. Written aside and renamed; the
// targets must lie in the file's folder or below it.
Result<Cast> readCast(const std::filesystem::path& file);
Result<void> writeCast(const std::filesystem::path& file, const Cast& cast);

}  // namespace fantascope::theatre
