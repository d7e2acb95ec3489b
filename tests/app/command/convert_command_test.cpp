// What is written for other programs, as one of them reads it: assimp. Joints are where the poses
// have them.

#include "app/a_cast_file.h"

#include "theatre/body/body_mesh.h"

#include "core/file.h"
#include "program.h"

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <glm/geometric.hpp>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace fantascope {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using Arguments = std::vector<std::string>;

glm::dvec3 toGlm(const aiVector3D& v) { return {v.x, v.y, v.z}; }

// A scene as assimp has it, at a moment of its one animation, in the units of its own clock.
class Imported {
public:
    explicit Imported(const fs::path& file) : scene_(importer_.ReadFile(file.string(), 0)) {
        EXPECT_NE(scene_, nullptr) << importer_.GetErrorString();
    }
    const aiScene& scene() const { return *scene_; }
    const aiNode* node(const std::string& name) const { return scene_->mRootNode->FindNode(name.c_str()); }

    double ticksPerSecond() const {
        const double ticks = scene_->mAnimations[0]->mTicksPerSecond;
        return ticks != 0 ? ticks : 1;
    }
    // Keys are at the frames' times, so that nothing has to be interpolated; without an animation
    // the nodes' own places.
    aiMatrix4x4 worldOf(const aiNode* node, double seconds) const {
        aiMatrix4x4 local = node->mTransformation;
        if (scene_->mNumAnimations > 0)
            if (const aiNodeAnim* const channel = channelOf(node->mName)) {
                aiVector3D scaling, position;
                aiQuaternion turn;
                local.Decompose(scaling, turn, position);
                position = keyAt(channel->mPositionKeys, channel->mNumPositionKeys, seconds, position);
                turn = keyAt(channel->mRotationKeys, channel->mNumRotationKeys, seconds, turn);
                local = aiMatrix4x4(aiVector3D(1, 1, 1), turn, position);
            }
        return node->mParent != nullptr ? worldOf(node->mParent, seconds) * local : local;
    }
    glm::dvec3 placeOf(const std::string& name, double seconds) const {
        const aiNode* const found = node(name);
        if (found == nullptr) return glm::dvec3(std::numeric_limits<double>::quiet_NaN());
        return toGlm(worldOf(found, seconds) * aiVector3D(0, 0, 0));
    }
    std::size_t keys(const std::string& name) const {
        const aiNodeAnim* const channel = channelOf(aiString(name));
        return channel == nullptr ? 0 : channel->mNumRotationKeys;
    }

private:
    const aiNodeAnim* channelOf(const aiString& name) const {
        const aiAnimation& animation = *scene_->mAnimations[0];
        for (unsigned i = 0; i < animation.mNumChannels; ++i)
            if (animation.mChannels[i]->mNodeName == name) return animation.mChannels[i];
        return nullptr;
    }
    template <class Key, class Value>
    Value keyAt(const Key* keys, unsigned count, double seconds, const Value& otherwise) const {
        for (unsigned i = 0; i < count; ++i)
            if (std::abs(keys[i].mTime / ticksPerSecond() - seconds) < 1e-4) return keys[i].mValue;
        return count == 1 ? keys[0].mValue : otherwise;
    }

    Assimp::Importer importer_;
    const aiScene* scene_;
};

class ConvertCommand : public testing::Test {
protected:
    Outcome run(const Arguments& arguments) const { return runProgram(arguments, folder_ / "."); }

    // Every joint of every actor, at every frame.
    void expectJoints(const Imported& imported, const theatre::Cast& cast, std::size_t actor, const std::string& prefix,
                      char space) const {
        const theatre::Body body = theatre::humanBody(cast.actors[actor].stature);
        theatre::PosedBody posed;
        for (std::size_t frame = 0; frame < cast.actors[actor].poses.size(); ++frame) {
            posed.pose(body, theatre::dofsOf(body, cast.actors[actor].poses[frame]));
            const double at = cast.framesPerSecond > 0 ? double(frame) / cast.framesPerSecond : 0;
            for (std::size_t j = 0; j < body.joints.size(); ++j) {
                std::string name = prefix + body.joints[j].name;
                std::replace(name.begin(), name.end(), ' ', space);
                EXPECT_LT(glm::distance(imported.placeOf(name, at), posed.place(j)), 1e-4) << name << ", frame " << frame;
            }
        }
    }

    const ScratchFolder folder_;
};

TEST_F(ConvertCommand, joints_in_a_gltf_are_where_the_poses_have_them) {
    const theatre::Cast cast = writeACast(folder_, "a.cast.yaml", 4);
    for (const std::string file : {"a.glb", "a.gltf"}) {
        const Outcome outcome = run({"convert", "a.cast.yaml", "-o", file});
        ASSERT_THAT(outcome, exits(0));
        EXPECT_THAT(outcome.out, HasSubstr("2 actors, 4 frames at 12.5 per second"));
        const Imported imported(folder_ / file);
        for (std::size_t actor : {0u, 1u}) expectJoints(imported, cast, actor, fmt::format("actor {} ", actor + 1), ' ');
    }
}

TEST_F(ConvertCommand, skins_hang_on_their_joints_and_rest_as_they_were_made) {
    const theatre::Cast cast = writeACast(folder_, "a.cast.yaml", 2);
    ASSERT_THAT(run({"convert", "a.cast.yaml", "-o", "a.glb"}), exits(0));
    const Imported imported(folder_ / "a.glb");
    for (std::size_t actor : {0u, 1u}) {
        const aiMesh* mesh = nullptr;
        for (unsigned i = 0; i < imported.scene().mNumMeshes; ++i)
            if (imported.scene().mMeshes[i]->mName == aiString(fmt::format("actor {}", actor + 1)))
                mesh = imported.scene().mMeshes[i];
        ASSERT_NE(mesh, nullptr);
        const theatre::Body body = theatre::humanBody(cast.actors[actor].stature);
        const theatre::BodyMesh skin = theatre::humanMesh(body);
        ASSERT_EQ(mesh->mNumVertices, skin.atRest.vertices.size());
        ASSERT_EQ(mesh->mNumFaces, skin.atRest.triangles.size());
        std::vector<double> sums(mesh->mNumVertices, 0);
        std::vector<glm::dvec3> places(mesh->mNumVertices, glm::dvec3(0));
        // At rest every joint carries its vertices to where they are: matrix of a joint at rest
        // times that of the skin is 1.
        std::vector<glm::dvec3> rests;
        for (const auto& joint : body.joints)
            rests.push_back(joint.offset + (rests.empty() ? glm::dvec3(0) : rests[joint.parent]));
        ASSERT_GT(mesh->mNumBones, 10u);
        for (unsigned b = 0; b < mesh->mNumBones; ++b) {
            const aiBone& bone = *mesh->mBones[b];
            const std::string name = std::string(bone.mName.C_Str()).substr(fmt::format("actor {} ", actor + 1).size());
            const glm::dvec3 rest = rests[body.joint(name)];
            for (unsigned w = 0; w < bone.mNumWeights; ++w) {
                const auto& [v, weight] = bone.mWeights[w];
                sums[v] += weight;
                places[v] += double{weight} * (rest + toGlm(bone.mOffsetMatrix * mesh->mVertices[v]));
            }
        }
        for (unsigned v = 0; v < mesh->mNumVertices; ++v) {
            EXPECT_NEAR(sums[v], 1, 1e-5);
            EXPECT_LT(glm::distance(places[v], glm::dvec3(skin.atRest.vertices[v])), 1e-4);
        }
    }
}

TEST_F(ConvertCommand, props_platforms_lamp_and_screen_come_along) {
    writeAStage(folder_, "hall.stage.yaml");
    const theatre::Cast cast = writeACast(folder_, "a.cast.yaml", 3, "hall.stage.yaml");
    ASSERT_THAT(run({"convert", "a.cast.yaml", "-o", "a.glb"}), exits(0));
    const Imported imported(folder_ / "a.glb");
    EXPECT_LT(glm::distance(imported.placeOf("prop rock", 0), {-1.5, 0.1, 2}), 1e-5);
    ASSERT_NE(imported.node("platform step"), nullptr);
    ASSERT_NE(imported.node("screen"), nullptr);
    ASSERT_EQ(imported.scene().mNumLights, 1u);
    EXPECT_EQ(imported.scene().mLights[0]->mType, aiLightSource_POINT);
    EXPECT_LT(glm::distance(imported.placeOf(imported.scene().mLights[0]->mName.C_Str(), 0), {0.1, 0.05, 7}), 1e-5);
    // What is held goes with the hand.
    const theatre::Body body = theatre::humanBody(cast.actors[1].stature);
    const theatre::Body::Point& hand = body.parts[static_cast<std::size_t>(theatre::BodyPart::LeftHand)];
    theatre::PosedBody posed;
    for (std::size_t frame = 0; frame < 3; ++frame) {
        posed.pose(body, theatre::dofsOf(body, cast.actors[1].poses[frame]));
        const glm::dvec3 expected = posed.point(hand.joint, hand.local + glm::dvec3(0.05, 0, 0));
        EXPECT_LT(glm::distance(imported.placeOf("prop parcel", double(frame) / 12.5), expected), 1e-4) << frame;
    }
}

// Every light and every screen once; a curved screen is a strip that bends.
TEST_F(ConvertCommand, further_lights_and_screens_come_along) {
    folder_.file("corner.stage.yaml",
                 "fantascope: stage\nversion: 1\nlight: [0, 0.1, 7]\nscreen: {radius: -6}\nfurther_beams:\n"
                 "  - {light: [-6, 0.2, 5], screen: {at: [4, 0, 5], turned: -90}}\n  - {light: [1, 0.3, 6]}\n");
    theatre::Cast cast = writeACast(folder_, "a.cast.yaml", 1);
    cast.stageFile = folder_ / "corner.stage.yaml";
    for (int i = 0; i < 2; ++i) cast.targets.push_back({cast.targets[0].file, 1.6, 0});
    ASSERT_TRUE(theatre::writeCast(folder_ / "a.cast.yaml", cast));
    ASSERT_THAT(run({"convert", "a.cast.yaml", "-o", "a.glb"}), exits(0));
    const Imported imported(folder_ / "a.glb");
    EXPECT_EQ(imported.scene().mNumLights, 3u);
    EXPECT_LT(glm::distance(imported.placeOf("light 2", 0), {-6, 0.2, 5}), 1e-5);
    EXPECT_LT(glm::distance(imported.placeOf("light 3", 0), {1, 0.3, 6}), 1e-5);
    EXPECT_EQ(imported.node("screen 3"), nullptr) << "it is the first again";
    const auto pointsOf = [&](const char* name) {
        std::vector<glm::dvec3> points;
        const aiNode* const node = imported.node(name);
        if (node == nullptr || node->mNumMeshes == 0) return points;
        const aiMesh& mesh = *imported.scene().mMeshes[node->mMeshes[0]];
        for (unsigned i = 0; i < mesh.mNumVertices; ++i) points.push_back(toGlm(mesh.mVertices[i]));
        return points;
    };
    ASSERT_FALSE(pointsOf("screen").empty());
    for (const glm::dvec3& point : pointsOf("screen")) EXPECT_NEAR(std::hypot(point.x, point.z + 6), 6, 1e-5);
    ASSERT_EQ(pointsOf("screen 2").size(), 4u);
    for (const glm::dvec3& point : pointsOf("screen 2")) EXPECT_NEAR(point.x, 4, 1e-5);
}

TEST_F(ConvertCommand, joints_in_a_bvh_are_where_the_poses_have_them) {
    const theatre::Cast cast = writeACast(folder_, "a.cast.yaml", 3);
    ASSERT_THAT(run({"convert", "a.cast.yaml", "-o", "a.bvh"}), exits(0));
    for (std::size_t actor : {0u, 1u})
        expectJoints(Imported(folder_ / fmt::format("a-actor-{}.bvh", actor + 1)), cast, actor, "", '_');
    EXPECT_FALSE(fs::exists(folder_ / "a.bvh"));
    ASSERT_THAT(run({"convert", "a.cast.yaml", "-o", "b.bvh", "--actor", "2"}), exits(0));
    EXPECT_EQ(readFile(folder_ / "b.bvh").value(), readFile(folder_ / "a-actor-2.bvh").value());
}

TEST_F(ConvertCommand, poses_in_between_go_through_the_frames) {
    const theatre::Cast cast = writeACast(folder_, "a.cast.yaml", 3);
    ASSERT_THAT(run({"convert", "a.cast.yaml", "-o", "a.glb", "--fps", "50"}), exits(0));
    const Imported imported(folder_ / "a.glb");
    EXPECT_EQ(imported.keys("actor 1 pelvis"), 9u) << "two steps of four, and the last";
    const theatre::Body body = theatre::humanBody(cast.actors[0].stature);
    theatre::PosedBody posed;
    for (std::size_t frame = 0; frame < 3; ++frame) {
        posed.pose(body, theatre::dofsOf(body, cast.actors[0].poses[frame]));
        EXPECT_LT(
            glm::distance(imported.placeOf("actor 1 left wrist", double(frame) / 12.5), posed.place(body.joint("left wrist"))),
            2e-2)
            << frame;
    }
}

TEST_F(ConvertCommand, a_still_stands_without_an_animation) {
    const theatre::Cast cast = writeACast(folder_, "a.cast.yaml", 1);
    ASSERT_THAT(run({"convert", "a.cast.yaml", "-o", "a.glb"}), exits(0));
    const Imported imported(folder_ / "a.glb");
    EXPECT_EQ(imported.scene().mNumAnimations, 0u);
    expectJoints(imported, cast, 1, "actor 2 ", ' ');
}

TEST_F(ConvertCommand, refuses_what_it_cannot_convert) {
    writeACast(folder_, "a.cast.yaml", 1);
    const auto refused = [&](const Arguments& arguments, int status, const auto& what) {
        const Outcome outcome = run(arguments);
        EXPECT_THAT(outcome, exits(status));
        EXPECT_THAT(outcome.errors, what);
    };
    refused({"convert", "none.cast.yaml", "-o", "a.glb"}, 1, HasSubstr("none.cast.yaml"));
    refused({"convert", "a.cast.yaml", "-o", "a.fbx"}, 2, HasSubstr("does not end in .glb, .gltf or .bvh"));
    refused({"convert", "a.cast.yaml", "-o", "a.glb", "--fps", "30"}, 1, HasSubstr("this is a still"));
    refused({"convert", "a.cast.yaml", "-o", "a.glb", "--actor", "1"}, 1, HasSubstr("--actor is for a .bvh"));
    refused({"convert", "a.cast.yaml", "-o", "a.bvh", "--actor", "3"}, 1, HasSubstr("the cast has actors 1 .. 2"));
}

}  // namespace
}  // namespace fantascope
