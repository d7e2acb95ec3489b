// What is said of the wall's light, by what was measured of it.

#include "vision/watch/wall_causes.h"

#include <gmock/gmock.h>

namespace fantascope::vision {
namespace {

using testing::IsEmpty;

OutputLight usual() { return {}; }
OutputLight with(void (*change)(OutputLight&)) {
    OutputLight light;
    change(light);
    return light;
}
const OutputLight kDim = with([](OutputLight& light) { light.contrast = 0.5; });
const OutputLight kBlurred = with([](OutputLight& light) { light.blur = 3, light.asUsual = 0.1; });
const OutputLight kDark = with([](OutputLight& light) { light.contrast = 0, light.asUsual = 0; });
const OutputLight kForeign =
    with([](OutputLight& light) { light.contrast = 0, light.asUsual = 0, light.explained = 0.2, light.otherLight = 0.2; });
const OutputLight kHidden = with([](OutputLight& light) { light.asUsual = light.explained = 0.7, light.hidden = 0.3; });
const OutputLight kPassing = with([](OutputLight& light) { light.asUsual = light.explained = 0.7; });
const OutputLight kLit = with([](OutputLight& light) { light.otherLight = 0.05; });
const OutputLight kStrong = with([](OutputLight& light) { light.contrast = 2, light.asUsual = 0; });

// "blocked view 1": the cause, and the output if there is one.
std::vector<std::pair<Cause, int>> said(const std::vector<OutputLight>& outputs,
                                        std::optional<SurroundingsLight> around = SurroundingsLight{}) {
    WallLight light;
    for (const OutputLight& output : outputs) light.outputs.emplace_back(output);
    light.surroundings = around;
    std::vector<std::pair<Cause, int>> said;
    for (const NamedCause& cause : causesOf(light))
        said.emplace_back(cause.cause, cause.output ? static_cast<int>(*cause.output) : -1);
    return said;
}
std::vector<std::pair<Cause, int>> one(Cause cause, int output = -1) { return {{cause, output}}; }

TEST(WallCauses, are_none_if_all_is_as_usual_or_nothing_was_measured) {
    EXPECT_THAT(said({usual(), usual()}), IsEmpty());
    EXPECT_THAT(said({kPassing, usual()}), IsEmpty()) << "somebody passes";
    WallLight nothing;
    nothing.outputs.resize(2);
    EXPECT_THAT(causesOf(nothing), IsEmpty());
}

TEST(WallCauses, of_one_output_leave_the_others_alone) {
    EXPECT_EQ(said({usual(), kDim}), one(Cause::DimLamp, 1));
    EXPECT_EQ(said({kBlurred, usual()}), one(Cause::OutOfFocus, 0));
    EXPECT_EQ(said({usual(), kDark, usual()}), one(Cause::DeadOutput, 1));
    EXPECT_EQ(said({kForeign, usual()}), one(Cause::WrongInput, 0));
    EXPECT_EQ(said({kHidden, usual()}), one(Cause::BlockedView, 0));
    EXPECT_EQ(said({kBlurred, kPassing}), one(Cause::OutOfFocus, 0));
    EXPECT_EQ(said({kPassing, kDim}), one(Cause::DimLamp, 1));
}

TEST(WallCauses, of_all_outputs_together_are_no_projector) {
    EXPECT_EQ(said({kDim, kDim}, SurroundingsLight{0.9, 0.01, 1.1}), one(Cause::Fog));
    EXPECT_EQ(said({kDim, kDim}, SurroundingsLight{0.5, 0, 0.5}), one(Cause::CameraExposure));
    EXPECT_EQ(said({kDim, kDim}, SurroundingsLight{0.7, 0.001, 0.98}), one(Cause::CameraExposure)) << "there is hardly any light";
    // Thin fog takes nearly as much from a picture that is not weak yet.
    OutputLight weak, almost, hardly;
    weak.contrast = 0.83, almost.contrast = 0.88, hardly.contrast = 0.96;
    EXPECT_EQ(said({almost, weak, almost}, SurroundingsLight{0.9, 0.01, 1.5}), one(Cause::Fog));
    EXPECT_EQ(said({weak, almost}, SurroundingsLight{0.85, 0, 0.85}), one(Cause::CameraExposure));
    EXPECT_EQ(said({hardly, weak, almost}, SurroundingsLight{0.9, 0.01, 1.5}), one(Cause::DimLamp, 1));
    EXPECT_THAT(said({almost, almost}, SurroundingsLight{0.9, 0.01, 1.5}), IsEmpty()) << "hardly any fog";
    EXPECT_EQ(said({kStrong, kStrong}, SurroundingsLight{2, 0}), one(Cause::CameraExposure));
    const OutputLight saturates =
        with([](OutputLight& light) { light.contrast = 1.9, light.asUsual = 0.7, light.explained = 0.8, light.saturated = 0.1; });
    EXPECT_EQ(said({saturates, saturates}), one(Cause::CameraExposure)) << "some of it is white";
    EXPECT_EQ(said({kBlurred, kBlurred}), one(Cause::CameraDirty));
    EXPECT_EQ(said({kDark, kDark}), one(Cause::CameraBlind));
    EXPECT_EQ(said({kForeign, kForeign}), one(Cause::CameraElsewhere));
    EXPECT_EQ(said({kLit, kLit}, SurroundingsLight{8, 0}), one(Cause::AmbientLight));
    EXPECT_EQ(said({kLit, kLit}, SurroundingsLight{1, 0.01}), one(Cause::CameraDirty)) << "a veil over what is dark, too";
    const OutputLight onWall = with([](OutputLight& light) { light.otherLight = 0.05, light.textured = 0.8; });
    EXPECT_EQ(said({onWall, onWall}, SurroundingsLight{1, 0.01}), one(Cause::AmbientLight)) << "it shows the wall's texture";
    EXPECT_THAT(said({kLit, usual()}, SurroundingsLight{1, 0}), IsEmpty()) << "a lamp on one picture";
}

// What hangs before the camera may hide one picture whole and another in part.
TEST(WallCauses, do_not_call_a_covered_output_dead) {
    EXPECT_EQ(said({kHidden, kDark}), one(Cause::BlockedView, 0));
    EXPECT_EQ(said({kHidden, kHidden}), one(Cause::BlockedView));
    EXPECT_THAT(said({kPassing, kDark}), IsEmpty()) << "it may be hidden for long soon";
}

TEST(WallCauses, of_a_single_output_are_told_by_its_surroundings) {
    EXPECT_EQ(said({kDim}, SurroundingsLight{1, 0}), one(Cause::DimLamp, 0));
    EXPECT_EQ(said({kDim}, SurroundingsLight{0.7, 0.0005, 0.9}), one(Cause::CameraExposure));
    EXPECT_EQ(said({kDim}, SurroundingsLight{0.8, 0.01, 1.06}), one(Cause::Fog));
    const OutputLight dimAndLit =
        with([](OutputLight& light) { light.contrast = 0.7, light.asUsual = 0, light.otherLight = 0.005; });
    EXPECT_EQ(said({dimAndLit}, SurroundingsLight{1, 0}), one(Cause::DimLamp, 0)) << "fog is seen around the picture, too";
    EXPECT_EQ(said({kDark}, SurroundingsLight{1, 0}), one(Cause::DeadOutput, 0));
    EXPECT_EQ(said({kDark}, SurroundingsLight{0.05, 0}), one(Cause::CameraBlind));
    EXPECT_EQ(said({kBlurred}), one(Cause::OutOfFocus, 0));
    OutputLight byCamera = kBlurred;
    byCamera.isCameraBlurred = true;
    EXPECT_EQ(said({byCamera}), one(Cause::CameraDirty));
    WallLight early;
    early.outputs = {kDim};
    early.isSettling = true;
    EXPECT_THAT(causesOf(early), IsEmpty());
    early.outputs = {kDim, kDim};
    EXPECT_THAT(causesOf(early), IsEmpty());
}

}  // namespace
}  // namespace fantascope::vision
