#pragma once

#include "theatre/body/body_mesh.h"
#include "theatre/energy/pose_hints.h"
#include "theatre/energy/pose_weights.h"
#include "theatre/mask/contour.h"
#include "theatre/stage/continuity.h"
#include "theatre/stage/stage.h"

#include "core/result.h"
#include "media/image.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace fantascope::theatre {

// A target of 256 rows has this number of points sampled on its contour. Normals and curvatures are
// measured in a disc of this radius, in pixels of such a target.
constexpr std::size_t kContourPoints = 200;
constexpr double kDiscRadius = 6;

// Where a target is: on which beam's screen, and where its middle is along the unrolled screen, in
// metres from the screen frame's x = 0.
struct TargetPlace {
    std::size_t beam = 0;
    std::optional<double> middle{};  // none: straight in front of the light

    double scale = 1;  // size of a shadow there relative to the first beam's screen

    // The place where a beam throws the shadow of people who stand in the first beam's light.
    static TargetPlace on(const Stage& stage, std::size_t beam);
};

// A target silhouette on the screen of a beam, ready for comparison: the masks of target and
// shadows share its frame. If the screen is curved, masks lie on the flat screen, with the target
// as it falls there.
struct PoseTarget {
    // The picture's silhouette (pixels lighter than a half) becomes `height` metres high on the
    // screen, with its lowest row on the floor, and `rows` pixels high in masks. Masks have a
    // margin of a third of that height, for shadows that stick out. Error: nothing white, nothing
    // black, an island of fewer than kFewest pixels of the picture, two farther from each other
    // than kFarApart of the height, a silhouette wider than kWidest times its height, a picture
    // with a side of more than kMostSide pixels, or a silhouette that exceeds a projector's
    // picture, is longer than a curved screen, or is blocked from the light by another screen.
    static Result<PoseTarget> from(const GreyImage& picture, const Stage& stage, double height, int rows,
                                   const TargetPlace& place = {});
    // The targets of a sequence, in one ScreenFrame on the first beam's screen. The representative
    // frame (from 0) is placed as by from(), and the masks are large enough for all frames.
    // Error: names the frame (from 1). Errors are those of from(), pictures of different sizes, and
    // a silhouette that reaches below the foot of the representative one by more than kBelow of its
    // height.
    static Result<std::vector<PoseTarget>> ofSequence(std::span<const GreyImage> pictures, std::size_t representative,
                                                      const Stage& stage, double height, int rows);
    // The same target in pixels of twice the side, with half as many contour points, for the coarse
    // stage of a search.
    PoseTarget halved(const Stage& stage) const;

    // The same target with another mask of the same frame.
    PoseTarget reshaped(BitMask mask) const;

    // Whether from() takes a picture of this size.
    static Result<void> checkSize(int width, int height);

    static constexpr int kFewest = 64, kWidest = 8, kMostSide = 2048;
    static constexpr double kFarApart = 0.125, kBelow = 0.02;

    ScreenFrame frame;
    BitMask mask;
    double area = 0;  // pixels
    std::vector<ContourPoint> contour;
    double refPixelsPerPixel = 1;               // size of a mask pixel, in pixels of a target 256 high
    ScreenFrame given{Stage{}, 0, 0, 1, 0, 0};  // the whole given picture, on the unrolled screen; empty if there was none
    std::size_t beam = 0;                       // index of the stage's beam
    // Only for a curved screen.
    struct Unrolled {
        Screen screen;
        glm::dvec3 light;   // in the screen's frame
        BitMask onScreen;   // on the flat screen: where light reaches the curved screen, not the floor before it
        ScreenFrame frame;  // of the target as it should look; the energy does not use it
        BitMask mask;
    };
    std::optional<Unrolled> unrolled{};

    // Blackens a shadow where the light does not fall on the screen.
    void cut(const Stage& stage, BitMask& shadow) const;
    // A shadow, or another mask of the frame, as it looks on the screen. It is unrolled if the
    // screen is curved.
    BitMask asSeen(const BitMask& shadow) const;
    const BitMask& maskAsSeen() const { return unrolled ? unrolled->mask : mask; }
    const ScreenFrame& frameAsSeen() const { return unrolled ? unrolled->frame : frame; }
    // The place on the flat screen, metres, of a point of the given picture, in its pixels from the
    // top left. None: no light reaches it.
    std::optional<glm::dvec2> flatFromGiven(glm::dvec2 pixel) const;

    // The weight of a contour point, so that sums over points are comparable to those over
    // kContourPoints.
    double perPoint() const { return double(kContourPoints) / static_cast<double>(contour.size()); }
};

struct PoseProblem {
    Stage stage;
    std::vector<PoseTarget> targets;  // one for each beam of the stage
    std::vector<Body> actors;
    PoseWeights weights;
    // One an actor, or none. With skins, shadows and contacts are computed from the skins; without,
    // from the capsules.
    std::vector<std::shared_ptr<const BodyMesh>> skins{};
    // Builds the actors' skins. Actors of one stature share a skin.
    void buildSkins();
    std::vector<PoseHint> hints{};
    std::vector<Continuity> continuity{};  // one for each actor, at a frame of a motion; empty: a still

    std::size_t dofs() const { return firstDof(actors.size()); }
    // The index of an actor's first degree of freedom among those of all actors.
    std::size_t firstDof(std::size_t actor) const {
        std::size_t first = 0;
        for (std::size_t i = 0; i < actor; ++i) first += actors[i].dofs;
        return first;
    }
};

// Cheaper versions of a problem: in256Rows() has targets of no more than 256 rows; simpler() has
// simpler skins; forFirstLook() has half as many rows and no skins.
PoseProblem in256Rows(PoseProblem problem);
PoseProblem simpler(PoseProblem problem);
PoseProblem forFirstLook(PoseProblem problem);

}  // namespace fantascope::theatre
