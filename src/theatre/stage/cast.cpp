#include "theatre/stage/cast.h"

#include "theatre/stage/stage_file.h"

#include "core/config/config.h"
#include "core/file.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

namespace fantascope::theatre {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kVersion = 1;
constexpr std::size_t kMostActors = 50, kMostFrames = 100'000;
constexpr double kFarthest = 100, kLeastStature = 0.5, kMostStature = 2.5, kLeastHeight = 0.1, kMostHeight = 20;  // metres
constexpr double kRounding = 1e-6, kLimitRounding = 1.7453e-5;  // of a quaternion's length; radians

Result<glm::dquat> readTurn(const ConfigNode& node) {
    const auto parts = TRY(node.items(4, 4));
    double values[4];
    for (std::size_t i = 0; i < 4; ++i) values[i] = TRY(parts[i].number(-1, 1));
    const glm::dquat turn(values[0], values[1], values[2], values[3]);
    if (std::abs(glm::length(turn) - 1) > kRounding)
        return node.error(
            fmt::format("a turn is a quaternion [w, x, y, z] of length 1; the length of this one is {:.4f}", glm::length(turn)));
    return turn;
}

// One rotation for each joint, by its name.
Result<ActorPose> readPose(const ConfigNode& node, const Body& body) {
    ActorPose pose;
    pose.turns.resize(body.joints.size());
    ConfigFields fields(node);
    fields.vector3("root", pose.root, -kFarthest, kFarthest, "m");
    for (std::size_t i = 0; i < body.joints.size(); ++i)
        fields.read(body.joints[i].name, pose.turns[i], [&](const ConfigNode& at) -> Result<glm::dquat> {
            const glm::dquat turn = TRY(readTurn(at));
            if (i == 0) return turn;
            for (const JointLimit& limit : body.joints[i].motion.limits())
                if (const double measure = limit.measure(turn);
                    measure < limit.low - kLimitRounding || measure > limit.high + kLimitRounding)
                    return at.error(
                        fmt::format("the {} cannot turn like this: {:.1f} degrees, and {:.1f} .. {:.1f} are its limits",
                                    body.joints[i].name, measure * 180 / std::numbers::pi, limit.low * 180 / std::numbers::pi,
                                    limit.high * 180 / std::numbers::pi));
            return turn;
        });
    TRY(fields.finish());
    return pose;
}

Result<Cast::Actor> readActor(const ConfigNode& node) {
    Cast::Actor actor;
    ConfigNode poses;
    ConfigFields fields(node);
    fields.number("stature", actor.stature, kLeastStature, kMostStature, "m");
    fields.read("poses", poses, [](const ConfigNode& at) -> Result<ConfigNode> { return at; });
    TRY(fields.finish());
    const Body body = humanBody(actor.stature);
    for (const ConfigNode& pose : TRY(poses.items(1, kMostFrames))) actor.poses.push_back(TRY(readPose(pose, body)));
    return actor;
}

Result<Cast::Target> readTarget(const ConfigNode& node) {
    Cast::Target target;
    double middle = 0;
    ConfigFields fields(node);
    fields.path("target", target.file);
    fields.number("height", target.height, kLeastHeight, kMostHeight, "m");
    fields.number("middle", middle, -kFarthest, kFarthest, "m");
    TRY(fields.finish());
    target.middle = middle;
    return target;
}

Result<Cast> castOf(const ConfigNode& root) {
    Cast cast;
    ConfigFields fields(root);
    fields.header("cast", kVersion);
    fields.path("target", cast.targets[0].file);
    fields.number("height", cast.targets[0].height, kLeastHeight, kMostHeight, "m");
    bool hasLight = false;
    fields.optional().read("light", cast.stage.beams[0].light, [&](const ConfigNode& node) {
        hasLight = true;
        return node.vector3(-kFarthest, kFarthest, "m");
    });
    fields.optional().read("stage", cast.stageFile, [&](const ConfigNode& node) -> Result<std::optional<fs::path>> {
        if (hasLight) return node.error("there is a 'light' too, and the stage has its own; take either away");
        const fs::path file = TRY(node.path());
        auto stage = readStage(file);
        if (!stage) return node.error(stage.error());
        cast.stage = std::move(*stage);
        return std::optional(file);
    });
    fields.optional().number("frames_per_second", cast.framesPerSecond, 0, 1000);
    fields.optional().read("sequence", cast.sequence, [](const ConfigNode& node) -> Result<std::optional<Cast::Sequence>> {
        Cast::Sequence sequence;
        std::int64_t representative = 0, first = 0;
        ConfigFields parts(node);
        parts.path("file", sequence.file);
        parts.integer("representative", representative, 1, kMostFrames);
        parts.integer("first", first, 1, kMostFrames);
        TRY(parts.finish());
        sequence.representative = static_cast<std::size_t>(representative - 1);
        sequence.first = static_cast<std::size_t>(first - 1);
        return std::optional(sequence);
    });
    std::vector<Cast::Target> further;
    fields.optional().list("further_targets", further, readTarget);
    fields.integer("seed", cast.seed, 0, std::numeric_limits<std::int64_t>::max());
    ConfigNode actors;
    fields.read("actors", actors, [](const ConfigNode& at) -> Result<ConfigNode> { return at; });
    TRY(fields.finish());
    if (!hasLight && !cast.stageFile)
        return root.error("no light; say 'light: [x, y, z]' for a lamp, or 'stage:' with the name of a stage file");
    cast.targets.insert(cast.targets.end(), further.begin(), further.end());
    if (cast.targets.size() != cast.stage.beams.size())
        return root.error(fmt::format("{} further_targets, and the stage has {} further_beams; each beam has a target",
                                      further.size(), cast.stage.beams.size() - 1));
    for (const ConfigNode& node : TRY(actors.items(1, kMostActors))) {
        cast.actors.push_back(TRY(readActor(node)));
        if (cast.actors.back().poses.size() != cast.actors.front().poses.size())
            return node.error(fmt::format("{} poses, and the first actor has {}; each has one for each frame",
                                          cast.actors.back().poses.size(), cast.actors.front().poses.size()));
    }
    if (const std::size_t frames = cast.actors.front().poses.size(); frames > 1 && cast.framesPerSecond <= 0)
        return root.error(
            fmt::format("{} frames, and no 'frames_per_second', which says how fast they follow each other", frames));
    if (auto held = cast.stage.checkHolders(cast.actors.size()); !held) return root.error(held.error().message());
    return cast;
}

}  // namespace

Result<Cast> readCast(const fs::path& file) { return castOf(TRY(ConfigNode::load(file))); }

Result<void> writeCast(const fs::path& file, const Cast& cast) {
    std::string text = fmt::format("fantascope: cast\nversion: {}\ntarget: {}\nheight: {}\n", kVersion,
                                   fantascope::quoted(TRY(relativeTo(file, cast.targets[0].file))), cast.targets[0].height);
    const auto add = [&]<class... Values>(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
    };
    if (cast.stageFile)
        add("stage: {}\n", fantascope::quoted(TRY(relativeTo(file, *cast.stageFile))));
    else
        add("light: [{}, {}, {}]\n", cast.stage.beams[0].light.x, cast.stage.beams[0].light.y, cast.stage.beams[0].light.z);
    if (cast.framesPerSecond > 0) add("frames_per_second: {}\n", cast.framesPerSecond);
    if (cast.sequence)
        add("sequence: {{file: {}, representative: {}, first: {}}}\n",
            fantascope::quoted(TRY(relativeTo(file, cast.sequence->file))), cast.sequence->representative + 1,
            cast.sequence->first + 1);
    if (cast.targets.size() > 1) add("further_targets:\n");
    for (const Cast::Target& target : std::span(cast.targets).subspan(1))
        add("  - {{target: {}, height: {}, middle: {}}}\n", fantascope::quoted(TRY(relativeTo(file, target.file))), target.height,
            target.middle.value_or(0));
    add("seed: {}\nactors:\n", cast.seed);
    for (const Cast::Actor& actor : cast.actors) {
        const Body body = humanBody(actor.stature);
        add("  - stature: {}\n    poses:\n", actor.stature);
        for (const ActorPose& pose : actor.poses) {
            add("      - root: [{}, {}, {}]\n", pose.root.x, pose.root.y, pose.root.z);
            for (std::size_t i = 0; i < pose.turns.size(); ++i) {
                const glm::dquat& turn = pose.turns[i];
                add("        {}: [{}, {}, {}, {}]\n", body.joints[i].name, turn.w, turn.x, turn.y, turn.z);
            }
        }
    }
    // The text is read back first, so that an unreadable one never replaces a good file.
    if (const auto readable = castOf(TRY(ConfigNode::parse(text, file))); !readable)
        return readable.error().in("not written, as it could not be read again");
    return writeFile(file, text);
}

}  // namespace fantascope::theatre
