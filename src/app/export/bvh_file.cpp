#include "app/export/motion_scene.h"

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace fantascope::app {
namespace {

// A still lasts one frame at this rate.
constexpr double kStillRate = 30;

// The Euler angles of R = Rz Rx Ry, as (z, x, y), degrees.
glm::dvec3 zxy(const glm::dquat& turn) {
    const glm::dmat3 r = glm::mat3_cast(turn);  // columns
    const double sine = std::clamp(r[1][2], -1.0, 1.0);
    constexpr double kUpright = 1 - 1e-12;  // gimbal lock: z and y rotate about the same axis
    const double z = std::abs(sine) < kUpright ? std::atan2(-r[1][0], r[1][1]) : std::atan2(r[0][1], r[0][0]),
                 y = std::abs(sine) < kUpright ? std::atan2(-r[0][2], r[2][2]) : 0;
    return glm::dvec3(z, std::asin(sine), y) * (180 / std::numbers::pi);
}

class Writer {
public:
    explicit Writer(const theatre::Body& body) : body_(body) {}

    // The joints in the order of their channels.
    std::vector<std::size_t> order{};
    std::string text = "HIERARCHY\n";

    void joint(std::size_t index, std::size_t depth) {
        const theatre::Body::Joint& joint = body_.joints[index];
        const std::string indent(2 * depth, ' ');
        std::string name = joint.name;
        std::replace(name.begin(), name.end(), ' ', '_');
        order.push_back(index);
        add("{}{} {}\n{}{{\n", indent, index == 0 ? "ROOT" : "JOINT", name, indent);
        offset(index == 0 ? glm::dvec3(0) : joint.offset, indent);
        add("{}  CHANNELS {}Zrotation Xrotation Yrotation\n", indent, index == 0 ? "6 Xposition Yposition Zposition " : "3 ");
        bool isLeaf = true;
        for (std::size_t child = index + 1; child < body_.joints.size(); ++child)
            if (body_.joints[child].parent == index) this->joint(child, depth + 1), isLeaf = false;
        if (isLeaf) {
            const auto tip =
                std::find_if(body_.parts.rbegin(), body_.parts.rend(), [&](const auto& part) { return part.joint == index; });
            add("{}  End Site\n{}  {{\n", indent, indent);
            offset(tip == body_.parts.rend() ? joint.massCentre : tip->local, indent + "  ");
            add("{}  }}\n", indent);
        }
        add("{}}}\n", indent);
    }

    template <class... Values>
    void add(fmt::format_string<Values...> format, Values&&... values) {
        fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
    }

private:
    void offset(const glm::dvec3& at, const std::string& indent) {
        add("{}  OFFSET {:.7f} {:.7f} {:.7f}\n", indent, at.x, at.y, at.z);
    }

    const theatre::Body& body_;
};

}  // namespace

std::string bvhOf(const MotionScene& scene, std::size_t actor) {
    const MotionScene::Actor& who = scene.actors[actor];
    Writer writer(who.body);
    writer.joint(0, 0);
    writer.add("MOTION\nFrames: {}\nFrame Time: {:.9f}\n", who.poses.size(),
               1 / (scene.framesPerSecond > 0 ? scene.framesPerSecond : kStillRate));
    for (const theatre::ActorPose& pose : who.poses) {
        writer.add("{:.7f} {:.7f} {:.7f}", pose.root.x, pose.root.y, pose.root.z);
        for (const std::size_t joint : writer.order) {
            const glm::dvec3 degrees = zxy(pose.turns[joint]);
            writer.add(" {:.6f} {:.6f} {:.6f}", degrees.x, degrees.y, degrees.z);
        }
        writer.text += '\n';
    }
    return writer.text;
}

}  // namespace fantascope::app
