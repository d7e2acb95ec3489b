#pragma once

#include "theatre/body/actor_pose.h"
#include "theatre/body/body_mesh.h"
#include "theatre/stage/stage.h"

#include "core/result.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::app {

// A cast for export to other programs: the actors' motion and the stage. Metres, the stage's frame.
struct MotionScene {
    struct Actor {
        theatre::Body body;
        std::shared_ptr<const theatre::BodyMesh> skin;
        std::vector<theatre::ActorPose> poses;  // one per frame; consecutive quaternions have a positive dot product
    };
    theatre::Stage stage;
    double screenHeight = 0;     // height of the silhouette on the screen
    double framesPerSecond = 0;  // 0: a still, with one frame
    std::vector<Actor> actors;

    std::size_t frames() const { return actors[0].poses.size(); }
};

// `framesPerSecond`: default: the cast's own; at another rate, poses are interpolated. Error: as
// readCast(); a rate for a still.
Result<MotionScene> readMotionScene(const std::filesystem::path& cast, std::optional<double> framesPerSecond);

// A glTF 2.0 file with a skeleton, a weighted skin and a material for each actor, their animation,
// props (held ones are children of the joint), platforms, lights (KHR_lights_punctual) and screens.
// `binary`: a .glb, else a .gltf with an embedded buffer.
std::string gltfOf(const MotionScene& scene, bool binary);

// An actor's skeleton and motion in Biovision's BVH: metres, degrees. Joint rotations are intrinsic
// Euler angles about z, then x, then y.
std::string bvhOf(const MotionScene& scene, std::size_t actor);

}  // namespace fantascope::app
