#include "app/base/report.h"
#include "app/export/motion_scene.h"

#include "theatre/stage/stage_set.h"

#include "plot/palette.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace fantascope::app {
namespace {

using Json = nlohmann::ordered_json;

// Constants of the glTF specification.
constexpr int kUnsignedByte = 5121, kUnsignedInt = 5125, kFloat = 5126, kVertices = 34962, kIndices = 34963;
constexpr std::uint32_t kCurvedColumns = 32;                               // of a curved screen
constexpr double kLightPower = 1000;                                       // candela: a bright stage lamp
constexpr double kScreenMargin = 4 / 3.0, kScreenWide = 2;                 // height / the silhouette's height; width / height
constexpr glm::dvec3 kThings{0.46, 0.33, 0.23}, kCloth{0.97, 0.95, 0.90};  // sRGB

std::string base64(const std::string& bytes) {
    constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k)
            three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kLetters[three >> (18 - 6 * k) & 63];
    }
    return text;
}

Json listOf(const glm::dvec3& v) { return {v.x, v.y, v.z}; }
Json listOf(const glm::dquat& q) { return {q.x, q.y, q.z, q.w}; }

class Writer {
public:
    explicit Writer(const MotionScene& scene) : scene_(scene) {
        for (const char* const list : {"nodes", "meshes", "materials", "accessors", "bufferViews"}) file_[list] = Json::array();
    }

    std::string write(bool binary) {
        Json roots = Json::array();
        for (std::size_t i = 0; i < scene_.actors.size(); ++i) addActor(i, roots);
        addStageSet(roots);
        Json file{{"asset", {{"version", "2.0"}, {"generator", "fantascope"}}},
                  {"extensionsUsed", {"KHR_lights_punctual"}},
                  {"scene", 0},
                  {"scenes", {{{"nodes", std::move(roots)}}}}};
        for (auto& [key, list] : file_.items()) file[key] = std::move(list);
        if (!channels_.empty()) file["animations"] = {{{"name", "motion"}, {"channels", channels_}, {"samplers", samplers_}}};
        Json buffer{{"byteLength", bytes_.size()}};
        if (!binary) buffer["uri"] = "data:application/octet-stream;base64," + base64(bytes_);
        file["buffers"] = {std::move(buffer)};
        std::string json = jsonText(file);
        if (!binary) return json + "\n";
        json.resize((json.size() + 3) / 4 * 4, ' ');
        std::string all = "glTF";
        append(all, std::uint32_t{2}), append(all, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + bytes_.size()));
        append(all, static_cast<std::uint32_t>(json.size())), all += "JSON" + json;
        append(all, static_cast<std::uint32_t>(bytes_.size())), all += std::string("BIN\0", 4) + bytes_;
        return all;
    }

private:
    template <class Value>
    static void append(std::string& bytes, const Value& value) {
        static_assert(std::endian::native == std::endian::little, "glTF is little-endian");
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    static Json& add(Json& list, Json item) {
        list.push_back(std::move(item));
        return list.back();
    }
    std::size_t count(const char* list) const { return file_[list].size(); }

    // Appends values to the buffer. `target`: the bufferView's target, for vertices and indices.
    template <class Value>
    std::size_t accessor(const std::vector<Value>& values, const char* type, int component, std::optional<int> target = {}) {
        Json view{{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", values.size() * sizeof(Value)}};
        if (target) view["target"] = *target;
        for (const Value& value : values) append(bytes_, value);
        bytes_.resize((bytes_.size() + 3) / 4 * 4, '\0');
        add(file_["accessors"],
            {{"bufferView", count("bufferViews")}, {"componentType", component}, {"count", values.size()}, {"type", type}});
        add(file_["bufferViews"], std::move(view));
        return count("accessors") - 1;
    }

    std::size_t material(const std::string& name, const glm::dvec3& colour) {
        const auto linear = [](double c) { return double{linearFromSrgb(static_cast<float>(c))}; };
        add(file_["materials"], {{"name", name},
                                 {"pbrMetallicRoughness",
                                  {{"baseColorFactor", {linear(colour.r), linear(colour.g), linear(colour.b), 1}},
                                   {"metallicFactor", 0},
                                   {"roughnessFactor", 0.9}}},
                                 {"doubleSided", true}});
        return count("materials") - 1;
    }

    // A primitive with smooth normals: per vertex the mean of its triangles' normals, weighted by
    // area.
    Json primitive(const TriangleMesh& mesh, std::size_t material) {
        std::vector<glm::vec3> normals(mesh.vertices.size(), glm::vec3(0));
        std::vector<std::uint32_t> indices;
        for (const glm::uvec3& t : mesh.triangles) {
            const glm::vec3 area = glm::cross(mesh.vertices[t.y] - mesh.vertices[t.x], mesh.vertices[t.z] - mesh.vertices[t.x]);
            for (int i = 0; i < 3; ++i) normals[t[i]] += area, indices.push_back(t[i]);
        }
        for (glm::vec3& normal : normals) normal = glm::length(normal) > 0 ? glm::normalize(normal) : glm::vec3(0, 1, 0);
        glm::vec3 least(std::numeric_limits<float>::max()), most(-least);
        for (const glm::vec3& v : mesh.vertices) least = glm::min(least, v), most = glm::max(most, v);
        const std::size_t positions = accessor(mesh.vertices, "VEC3", kFloat, kVertices);
        file_["accessors"][positions]["min"] = {least.x, least.y, least.z};
        file_["accessors"][positions]["max"] = {most.x, most.y, most.z};
        const std::size_t directions = accessor(normals, "VEC3", kFloat, kVertices);
        return {{"attributes", {{"POSITION", positions}, {"NORMAL", directions}}},
                {"indices", accessor(indices, "SCALAR", kUnsignedInt, kIndices)},
                {"material", material}};
    }
    std::size_t mesh(const std::string& name, Json primitive) {
        add(file_["meshes"], {{"name", name}, {"primitives", {std::move(primitive)}}});
        return count("meshes") - 1;
    }
    std::size_t node(Json item) {
        add(file_["nodes"], std::move(item));
        return count("nodes") - 1;
    }

    void addActor(std::size_t index, Json& roots) {
        const MotionScene::Actor& actor = scene_.actors[index];
        const std::string name = fmt::format("actor {}", index + 1);
        // The skeleton in its first pose. A joint's node precedes its children's.
        const std::size_t first = count("nodes"), joints = actor.body.joints.size();
        Json numbers = Json::array();
        std::vector<glm::mat4> jointFromRest;
        std::vector<glm::dvec3> rests;
        for (std::size_t j = 0; j < joints; ++j) {
            const theatre::Body::Joint& joint = actor.body.joints[j];
            node({{"name", fmt::format("{} {}", name, joint.name)},
                  {"translation", listOf(j == 0 ? actor.poses[0].root : joint.offset)},
                  {"rotation", listOf(actor.poses[0].turns[j])}});
            numbers.push_back(first + j);
            if (j > 0) file_["nodes"][first + joint.parent]["children"].push_back(first + j);
            rests.push_back(joint.offset + (j == 0 ? glm::dvec3(0) : rests[joint.parent]));
            glm::mat4& matrix = jointFromRest.emplace_back(1.0f);
            matrix[3] = glm::vec4(glm::vec3(-rests[j]), 1);
        }
        Json skin = primitive(actor.skin->atRest, material(name, plot::actorColour(index)));
        std::vector<std::array<std::uint8_t, 4>> influences;
        for (const auto& of : actor.skin->joints) {
            auto& bytes = influences.emplace_back();
            for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(of[i]);
        }
        skin["attributes"]["JOINTS_0"] = accessor(influences, "VEC4", kUnsignedByte, kVertices);
        skin["attributes"]["WEIGHTS_0"] = accessor(actor.skin->shares, "VEC4", kFloat, kVertices);
        add(file_["skins"], {{"name", name},
                             {"skeleton", first},
                             {"joints", std::move(numbers)},
                             {"inverseBindMatrices", accessor(jointFromRest, "MAT4", kFloat)}});
        roots.push_back(first);
        roots.push_back(node({{"name", name}, {"mesh", mesh(name, std::move(skin))}, {"skin", index}}));
        if (scene_.framesPerSecond > 0) addMotion(actor, first);
        for (const theatre::Prop& prop : scene_.stage.props)
            if (prop.holder && prop.holder->actor == index) {
                const theatre::Body::Point& part = actor.body.parts[static_cast<std::size_t>(prop.holder->part)];
                file_["nodes"][first + part.joint]["children"].push_back(addProp(prop, part.local + prop.place));
            }
    }

    void addMotion(const MotionScene::Actor& actor, std::size_t first) {
        if (!times_) {
            std::vector<float> times;
            for (std::size_t i = 0; i < scene_.frames(); ++i)
                times.push_back(static_cast<float>(double(i) / scene_.framesPerSecond));
            times_ = accessor(times, "SCALAR", kFloat);
            file_["accessors"][*times_]["min"] = {times.front()};
            file_["accessors"][*times_]["max"] = {times.back()};
        }
        const auto channel = [&](std::size_t joint, const char* path, std::size_t output) {
            channels_.push_back({{"sampler", samplers_.size()}, {"target", {{"node", first + joint}, {"path", path}}}});
            samplers_.push_back({{"input", *times_}, {"output", output}, {"interpolation", "LINEAR"}});
        };
        std::vector<glm::vec3> roots;
        for (const theatre::ActorPose& pose : actor.poses) roots.emplace_back(pose.root);
        channel(0, "translation", accessor(roots, "VEC3", kFloat));
        for (std::size_t j = 0; j < actor.body.joints.size(); ++j) {
            std::vector<glm::vec4> turns;
            for (const theatre::ActorPose& pose : actor.poses) {
                const glm::dquat& q = pose.turns[j];
                turns.emplace_back(q.x, q.y, q.z, q.w);
            }
            channel(j, "rotation", accessor(turns, "VEC4", kFloat));
        }
    }

    std::size_t things() {
        if (!things_) things_ = material("platforms and props", kThings);
        return *things_;
    }
    std::size_t addProp(const theatre::Prop& prop, const glm::dvec3& place) {
        const std::string name = fmt::format("prop {}", prop.name);
        return node({{"name", name},
                     {"translation", listOf(place)},
                     {"rotation", listOf(prop.turn)},
                     {"mesh", mesh(name, primitive(prop.shape->mesh, things()))}});
    }

    void addStageSet(Json& roots) {
        for (const theatre::Prop& prop : scene_.stage.props)
            if (!prop.holder) roots.push_back(addProp(prop, prop.place));
        for (const theatre::Stage::Platform& platform : scene_.stage.platforms) {
            const std::string name = fmt::format("platform {}", platform.name);
            roots.push_back(node({{"name", name}, {"mesh", mesh(name, primitive(theatre::meshOf(platform), things()))}}));
        }
        const theatre::Stage& stage = scene_.stage;
        const std::size_t cloth = material("screen", kCloth);
        Json& lights = file_["extensions"]["KHR_lights_punctual"]["lights"];
        std::vector<bool> hung(stage.screens.size());
        for (std::size_t beam = 0; beam < stage.beams.size(); ++beam) {
            const auto numbered = [&](const std::string& thing) {
                return beam == 0 ? thing : fmt::format("{} {}", thing, beam + 1);
            };
            const std::size_t screen = stage.beams[beam].screen;
            if (!hung[screen])
                roots.push_back(
                    node({{"name", numbered("screen")}, {"mesh", mesh(numbered("screen"), primitive(screenOf(beam), cloth))}}));
            hung[screen] = true;
            roots.push_back(node({{"name", numbered("light")},
                                  {"translation", listOf(stage.beams[beam].light)},
                                  {"extensions", {{"KHR_lights_punctual", {{"light", lights.size()}}}}}}));
            // Importers match a light by its node's name.
            lights.push_back({{"type", "point"}, {"name", numbered("light")}, {"intensity", kLightPower}});
        }
    }

    // The part of a beam's screen in front of its light.
    TriangleMesh screenOf(std::size_t beam) const {
        const theatre::Screen& screen = scene_.stage.screenOf(beam);
        const double top = kScreenMargin * scene_.screenHeight, most = theatre::Screen::kMostArc * std::abs(screen.radius);
        double from = scene_.stage.lightOnScreen(beam).x - 0.5 * kScreenWide * top, to = from + kScreenWide * top;
        if (screen.isCurved()) from = std::clamp(from, -most, most), to = std::clamp(to, -most, most);
        const std::uint32_t columns = screen.isCurved() ? kCurvedColumns : 1;
        TriangleMesh mesh;
        for (std::uint32_t i = 0; i <= columns; ++i) {
            const double along = from + (to - from) * i / columns;
            for (const double up : {0.0, top}) mesh.vertices.emplace_back(screen.stageFromScreen(screen.surface({along, up})));
            if (i == columns) break;
            const std::uint32_t low = 2 * i;
            mesh.triangles.insert(mesh.triangles.end(), {{low, low + 2, low + 3}, {low, low + 3, low + 1}});
        }
        return mesh;
    }

    const MotionScene& scene_;
    Json file_, channels_ = Json::array(), samplers_ = Json::array();
    std::string bytes_;
    std::optional<std::size_t> times_, things_;
};

}  // namespace

std::string gltfOf(const MotionScene& scene, bool binary) { return Writer(scene).write(binary); }

}  // namespace fantascope::app
