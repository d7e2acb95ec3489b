#include "app/export/motion_scene.h"

#include "theatre/motion/moving_cast.h"
#include "theatre/stage/cast.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

// Flips quaternions, so that linear interpolation from one to the next takes the shorter way.
void keepSides(std::vector<theatre::ActorPose>& poses) {
    for (std::size_t i = 1; i < poses.size(); ++i)
        for (std::size_t j = 0; j < poses[i].turns.size(); ++j)
            if (glm::dot(poses[i].turns[j], poses[i - 1].turns[j]) < 0) poses[i].turns[j] = -poses[i].turns[j];
}

}  // namespace

Result<MotionScene> readMotionScene(const fs::path& file, std::optional<double> framesPerSecond) {
    const theatre::Cast cast = TRY(theatre::readCast(file));
    if (framesPerSecond && cast.framesPerSecond == 0)
        return Error(fmt::format("{}: --fps is for casts that move, and this is a still; leave it out", file.string()));
    const std::size_t frames = cast.actors[0].poses.size();
    const bool loops = framesPerSecond && TRY(theatre::loops(cast));
    MotionScene scene{cast.stage, cast.targets[0].height, framesPerSecond.value_or(cast.framesPerSecond), {}};
    std::map<double, std::shared_ptr<const theatre::BodyMesh>> skins;
    for (const theatre::Cast::Actor& given : cast.actors) {
        MotionScene::Actor actor{theatre::humanBody(given.stature), {}, {}};
        auto& skin = skins[given.stature];
        if (skin == nullptr) skin = std::make_shared<const theatre::BodyMesh>(theatre::humanMesh(actor.body));
        actor.skin = skin;
        if (framesPerSecond) {
            theatre::PoseSpline spline(actor.body, cast.stage, given.poses, loops);
            const double step = cast.framesPerSecond / *framesPerSecond, last = double(frames) - (loops ? 0 : 1);
            constexpr double kRounding = 1e-9;
            for (std::size_t i = 0; double(i) * step < last - kRounding || (!loops && double(i) * step <= last + kRounding); ++i)
                actor.poses.push_back(theatre::poseOf(actor.body, spline.at(double(i) * step)));
        } else {
            for (const theatre::ActorPose& pose : given.poses)
                actor.poses.push_back(theatre::poseOf(actor.body, theatre::dofsOf(actor.body, pose)));
        }
        keepSides(actor.poses);
        scene.actors.push_back(std::move(actor));
    }
    return scene;
}

}  // namespace fantascope::app
