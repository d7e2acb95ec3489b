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

// A cast as other programs take it: who moves how, on which stage. Metres, the stage's frame.
struct MotionScene {
    struct Actor {
        theatre::Body body;
        std::shared_ptr<const theatre::BodyMesh> skin;
        std::vector<theatre::ActorPose> poses;  // one a frame, each turn on the side of the double cover of the one before
    };
    theatre::Stage stage;
    double screenHeight = 0;     // of the silhouette on it
    double framesPerSecond = 0;  // 0: a still, with one frame
    std::vector<Actor> actors;

    std::size_t frames() const { return actors[0].poses.size(); }
};

// At the cast's own frame rate, or at another one with poses in between. Error: as readCast();
// another rate for a still.
Result<MotionScene> readMotionScene(const std::filesystem::path& cast, std::optional<double> framesPerSecond);

// glTF 2.0: a skeleton, a skin with its weights and a material for each actor, their animation,
// props (those that are held hang on the joint), platforms, the light (KHR_lights_punctual) and the
// screen. `binary`: a .glb, else a .gltf that holds its buffer itself.
std::string gltfOf(const MotionScene& scene, bool binary);

// An actor's skeleton and motion in Biovision's BVH: metres, degrees; each joint's turn is about z,
// then x, then y, of axes that turn along.
std::string bvhOf(const MotionScene& scene, std::size_t actor);

}  // namespace fantascope::app
