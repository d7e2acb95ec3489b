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

// Points sampled on the contour of a target of 256 rows; the radius of the disc that normals and
// curvatures are read in, pixels of the target's 256 rows.
constexpr std::size_t kContourPoints = 200;
constexpr double kDiscRadius = 6;

// Where a target is: on which beam's screen, and how far along that, unrolled, its middle is from
// the screen frame's x = 0, metres.
struct TargetPlace {
    std::size_t beam = 0;
    std::optional<double> middle{};  // none: before the light

    double scale = 1;  // how many times as large as on the first beam's screen a shadow is there

    // Where a beam throws the shadow of people who stand before the first beam's light.
    static TargetPlace on(const Stage& stage, std::size_t beam);
};

// A target silhouette on the screen of a beam, ready to be compared with: masks of target and
// shadows share its frame. Where the screen is curved, masks are of the flat one, with the target
// as it falls there.
struct PoseTarget {
    // The picture's silhouette (what is lighter than a half) becomes `height` metres high on the
    // screen, its lowest row on the floor, and `rows` pixels high in masks. Beyond it the masks
    // have a margin of a third, for shadows that stick out. Error: nothing white, nothing black, an
    // island of fewer than kFewest pixels of the picture, two farther from each other than
    // kFarApart of the height, a silhouette wider than kWidest times its height, a picture with a
    // side of more than kMostSide pixels, or one that a projector's light does not hold, that is
    // longer than a curved screen, or from which another screen keeps the light.
    static Result<PoseTarget> from(const GreyImage& picture, const Stage& stage, double height, int rows,
                                   const TargetPlace& place = {});
    // The frames of a silhouette that moves, in one frame on the first beam's screen: the
    // representative one (from 0) is laid by as from() lays a picture, and the masks hold them all.
    // Error: names the frame (from 1); as from(), and pictures of different sizes, or a silhouette
    // that reaches below where the representative one stands by more than kBelow of its height.
    static Result<std::vector<PoseTarget>> ofSequence(std::span<const GreyImage> pictures, std::size_t representative,
                                                      const Stage& stage, double height, int rows);
    // The same in pixels of twice the side, with half as many points: for a search's first look.
    PoseTarget halved(const Stage& stage) const;

    // Another mask of the same frame instead of this one's.
    PoseTarget reshaped(BitMask mask) const;

    // Whether from() takes a picture of this size.
    static Result<void> checkSize(int width, int height);

    static constexpr int kFewest = 64, kWidest = 8, kMostSide = 2048;
    static constexpr double kFarApart = 0.125, kBelow = 0.02;

    ScreenFrame frame;
    BitMask mask;
    double area = 0;  // pixels
    std::vector<ContourPoint> contour;
    double refPixelsPerPixel = 1;  // of the target's height, a pixel of the mask is so many of 256
    ScreenFrame given{Stage{}, 0, 0,
                      1,       0, 0};  // the whole picture as it was given, on the unrolled screen; empty if there was none
    std::size_t beam = 0;              // of the stage's
    // Of a curved screen.
    struct Unrolled {
        Screen screen;
        glm::dvec3 light;   // in the screen's frame
        BitMask onScreen;   // of the flat screen: where a shadow falls on the curved one, and not on the floor before it
        ScreenFrame frame;  // of the target as it is to look, which the energy does not know
        BitMask mask;
    };
    std::optional<Unrolled> unrolled{};

    // Blackens a shadow where the light does not fall on the screen.
    void cut(const Stage& stage, BitMask& shadow) const;
    // A shadow, or another mask of the frame, as it looks on the screen: unrolled if that is
    // curved.
    BitMask asSeen(const BitMask& shadow) const;
    const BitMask& maskAsSeen() const { return unrolled ? unrolled->mask : mask; }
    const ScreenFrame& frameAsSeen() const { return unrolled ? unrolled->frame : frame; }
    // Where on the flat screen a point of the picture is, its pixels from the top left; none if no
    // light comes there.
    std::optional<glm::dvec2> flatFromGiven(glm::dvec2 pixel) const;

    // The energy's sums over points are those of kContourPoints, however many there are.
    double perPoint() const { return double(kContourPoints) / static_cast<double>(contour.size()); }
};

struct PoseProblem {
    Stage stage;
    std::vector<PoseTarget> targets;  // of each beam of the stage
    std::vector<Body> actors;
    PoseWeights weights;
    // Of the actors; with them shadows and what touches the floor are the skins', without the
    // capsules'.
    std::vector<std::shared_ptr<const BodyMesh>> skins{};
    // Gives them their skins; actors of one stature share one.
    void buildSkins();
    std::vector<PoseHint> hints{};
    std::vector<Continuity> continuity{};  // of the actors, at a frame of a motion; none: a still

    std::size_t dofs() const { return firstDof(actors.size()); }
    // Of an actor's, among those of all.
    std::size_t firstDof(std::size_t actor) const {
        std::size_t first = 0;
        for (std::size_t i = 0; i < actor; ++i) first += actors[i].dofs;
        return first;
    }
};

// The same problem in no more than 256 rows; the same with simpler skins; and in half as many rows,
// without skins.
PoseProblem in256Rows(PoseProblem problem);
PoseProblem simpler(PoseProblem problem);
PoseProblem forFirstLook(PoseProblem problem);

}  // namespace fantascope::theatre
