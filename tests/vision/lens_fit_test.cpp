// Finds lenses in pictures of the board that a known lens drew, and holds each against its truth
// all over the picture: a wrong half pixel, a swapped axis or a model of another form shows there,
// even where single parameters look alike.

#include "vision/lens_fit.h"

#include "vision/picture_trouble.h"

#include "board_pictures.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <numbers>

namespace fantascope::vision {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::SizeIs;

constexpr double kDegree = std::numbers::pi / 180;

CameraModel cameraWith(double fieldOfView, double k1, double k2, glm::dvec2 offCentre = {0, 0}, glm::ivec2 size = {640, 480}) {
    CameraModel camera = *CameraModel::fromFieldOfView(Pose(), size, fieldOfView * kDegree, k1, k2);
    camera.centre += offCentre;
    return camera;
}

// The largest distance in pixels between where two lenses draw a direction, over a grid of the
// picture; `turn`: how the camera is turned in between, radians about its axes.
double worst(const CameraModel& truth, const CameraModel& found, glm::dvec3 turn = glm::dvec3(0)) {
    double worst = 0;
    for (int i = 0; i < 21 * 21; ++i) {
        const glm::dvec2 pixel = glm::dvec2(truth.size) * glm::dvec2(i % 21, i / 21) / 20.0;
        const auto drawn = found.pixelFromWorld(rotationXyz(turn) * truth.rayThrough(pixel).direction);
        worst = std::max(worst, drawn ? glm::distance(*drawn, pixel) : 1e9);
    }
    return worst;
}

// The same for the turn that makes it smallest: where the camera looks is no part of its lens.
double worstTurned(const CameraModel& truth, const CameraModel& found) {
    glm::dvec3 turn(0);
    for (double step = 0.004; step > 1e-6;) {
        const double before = worst(truth, found, turn);
        for (int axis = 0; axis < 3; ++axis)
            for (const double way : {-step, step}) {
                glm::dvec3 next = turn;
                next[axis] += way;
                if (worst(truth, found, next) < worst(truth, found, turn)) turn = next;
            }
        if (worst(truth, found, turn) >= before) step /= 2;
    }
    return worst(truth, found, turn);
}

std::vector<BoardView> viewsOf(const BoardCamera& camera, const std::vector<BoardPose>& poses, Rng& rng,
                               const BoardCamera::Conditions& conditions = {}) {
    std::vector<BoardView> views;
    for (const BoardPose& pose : poses)
        if (auto view = findBoard(camera.picture(pose, rng, conditions))) views.push_back(std::move(*view));
    return views;
}

TEST(LensBoard, is_a_chessboard_with_a_marker_in_every_white_square) {
    glm::ivec2 low(1000), high(0);
    int squares = 0, markers = 0;
    for (const LensBoard::Box& box : LensBoard::boxes()) {
        low = glm::min(low, box.low);
        high = glm::max(high, box.high);
        squares += box.dark && box.high - box.low == glm::ivec2(LensBoard::kCells);
        markers += box.dark && box.high - box.low == glm::ivec2(6);
    }
    EXPECT_EQ(low, glm::ivec2(0));
    EXPECT_EQ(high, LensBoard::kSquares * LensBoard::kCells);
    EXPECT_EQ(squares, 27);
    EXPECT_EQ(markers, 27);
    EXPECT_EQ(LensBoard::placeOf(0), glm::dvec2(1, 1));
    EXPECT_EQ(LensBoard::placeOf(LensBoard::kCorners - 1), glm::dvec2(LensBoard::kSquares - 1));
}

// Half a pixel, or a mirrored or turned board, would show here.
TEST(FindBoard, finds_every_corner_where_it_is) {
    const CameraModel lens = cameraWith(60, -0.1, 0.02);
    const BoardCamera camera(lens);
    Rng rng(1);
    for (const BoardPose& pose : {BoardPose{}, BoardPose{{1, -1, 14}, {25, -20, 170}}, BoardPose{{-1, 1, 15}, {-10, 35, 90}}}) {
        const auto view = findBoard(camera.picture(pose, rng));
        ASSERT_TRUE(view);
        EXPECT_THAT(view->corners, SizeIs(std::size_t{LensBoard::kCorners}));
        glm::dvec2 mean(0);
        double square = 0;
        for (const BoardView::Corner& corner : view->corners) {
            const glm::dvec2 off = corner.pixel - *camera.pixelOf(corner.corner, pose);
            mean += off / double(LensBoard::kCorners);
            square += glm::dot(off, off) / LensBoard::kCorners;
        }
        EXPECT_LT(glm::length(mean), 0.04);
        EXPECT_LT(std::sqrt(square), 0.2);
    }
}

TEST(FindBoard, finds_nothing_where_there_is_no_board) {
    Rng rng(2);
    RgbaImage noise(320, 240);
    for (Rgba8& pixel : noise.pixels()) pixel.r = pixel.g = pixel.b = static_cast<std::uint8_t>(rng.below(256));
    EXPECT_FALSE(findBoard(noise));
    EXPECT_FALSE(findBoard(RgbaImage(320, 240)));
    EXPECT_FALSE(findBoard(RgbaImage(320, 240, {255, 255, 255, 255})));
    EXPECT_EQ(troubleOf(RgbaImage(320, 240)), PictureTrouble::Black);
    EXPECT_EQ(troubleOf(RgbaImage(320, 240, {255, 255, 255, 255})), PictureTrouble::Saturated);
    EXPECT_EQ(troubleOf(noise), PictureTrouble::None);
}

struct Case {
    const char* name;
    double fieldOfView, k1, k2;
    glm::dvec2 offCentre;
    double worst, turned;  // pixels that are allowed, as worst() and worstTurned()
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

class KnownLens : public testing::TestWithParam<Case> {};

TEST_P(KnownLens, is_found_all_over_the_picture) {
    const Case& one = GetParam();
    const CameraModel truth = cameraWith(one.fieldOfView, one.k1, one.k2, one.offCentre);
    const BoardCamera camera(truth);
    Rng rng(3);
    const std::vector<BoardView> views = viewsOf(camera, camera.poses(24, rng), rng);
    EXPECT_GE(views.size(), 22u);
    const auto fit = fitLens(views);
    ASSERT_TRUE(fit) << fit.error().message();
    const double raw = worst(truth, fit->lens), turned = worstTurned(truth, fit->lens);
    const std::string figures =
        fmt::format("worst {:.3f} px, turned {:.3f}, rms {:.3f}, uncertainty {:.3f}, focal {:.2f} for {:.2f}", raw, turned,
                    fit->rms, fit->uncertainty, fit->lens.focal, truth.focal);
    SCOPED_TRACE(figures);
    RecordProperty("figures", figures);
    EXPECT_LT(raw, one.worst);
    EXPECT_LT(turned, one.turned);
    EXPECT_LT(fit->rms, 0.2);
    EXPECT_LT(fit->uncertainty, goodUncertainty(truth.size));
    EXPECT_GT(fit->uncertainty, turned / 5) << "it promises more than it holds";
    EXPECT_TRUE(needsOf(views, &*fit).none()) << needsOf(views, &*fit).sentence();
}

INSTANTIATE_TEST_SUITE_P(
    Lenses, KnownLens,
    testing::Values(Case{"straight", 60, 0, 0, {0, 0}, 0.8, 0.6}, Case{"bent_inwards", 55, -0.3, 0.1, {0, 0}, 1.2, 0.6},
                    Case{"bent_outwards", 60, 0.1, 0, {0, 0}, 0.8, 0.6}, Case{"wide", 90, -0.12, 0.012, {0, 0}, 0.8, 0.6},
                    Case{"narrow", 30, -0.2, 0, {0, 0}, 2, 0.6}, Case{"off_centre", 65, -0.15, 0.03, {14, -9}, 0.8, 0.6}),
    [](const auto& info) { return std::string(info.param.name); });

// A night's board: held by its edge, a lamp from one side, a shaking camera, a poor sensor.
TEST(LensFit, is_found_from_poor_pictures) {
    const CameraModel truth = cameraWith(65, -0.2, 0.05, {5, 6});
    const BoardCamera camera(truth);
    BoardCamera::Conditions poor;
    poor.noise = 6;
    poor.blur = 1.1;
    poor.light = [](glm::dvec2 at) { return 0.12 + 0.9 * at.x * at.x; };
    poor.covered = [](glm::dvec2 at) { return at.x > 0.72 && at.y > 0.6; };
    Rng rng(4);
    const std::vector<BoardView> views = viewsOf(camera, camera.poses(20, rng), rng, poor);
    EXPECT_GE(views.size(), 15u);
    for (const BoardView& view : views) EXPECT_LT(view.corners.size(), std::size_t{LensBoard::kCorners});
    const auto fit = fitLens(views);
    ASSERT_TRUE(fit);
    EXPECT_LT(worst(truth, fit->lens), 1.5);
    EXPECT_LT(worstTurned(truth, fit->lens), 1);
}

// A view in which the board moved, and a corner under a finger.
TEST(LensFit, leaves_out_what_does_not_fit) {
    const CameraModel truth = cameraWith(60, -0.1, 0.02);
    const BoardCamera camera(truth);
    Rng rng(5);
    std::vector<BoardView> views = viewsOf(camera, camera.poses(18, rng), rng);
    const double clean = worst(truth, fitLens(views)->lens);
    for (BoardView::Corner& corner : views[2].corners) corner.pixel.y += 6 * std::sin(corner.pixel.x / 40);
    for (BoardView::Corner& corner : views[9].corners) corner.pixel.y += 5 * std::cos(corner.pixel.x / 30);
    views[5].corners[3].pixel += 4.0;
    const auto fit = fitLens(views);
    ASSERT_TRUE(fit);
    EXPECT_FALSE(fit->views[2].used);
    EXPECT_FALSE(fit->views[9].used);
    EXPECT_GT(fit->views[2].rms, 1);
    EXPECT_TRUE(fit->views[5].used);
    EXPECT_EQ(fit->usedViews(), static_cast<int>(views.size()) - 2);
    EXPECT_LT(worst(truth, fit->lens), clean + 0.25);
}

// Small residuals say nothing where the board always faced the camera.
TEST(LensFit, knows_that_views_without_tilt_tell_nothing) {
    const CameraModel truth = cameraWith(60, -0.1, 0.02);
    const BoardCamera camera(truth);
    Rng rng(6);
    std::vector<BoardPose> poses = camera.poses(18, rng);
    for (BoardPose& pose : poses) pose.turn = {0, 0, pose.turn.z};
    const std::vector<BoardView> views = viewsOf(camera, poses, rng);
    const auto fit = fitLens(views);
    ASSERT_TRUE(fit);
    EXPECT_LT(fit->rms, 0.2);
    EXPECT_GT(fit->uncertainty, 2 * goodUncertainty(truth.size));
    const LensNeeds needs = needsOf(views, &*fit);
    EXPECT_TRUE(needs.isUncertain);
    EXPECT_THAT(needs.tilts, SizeIs(4));
    EXPECT_THAT(needs.sentence(), HasSubstr("turn its left edge towards the camera"));
}

TEST(LensNeeds, tell_which_edge_was_not_turned_and_which_part_not_seen) {
    const CameraModel truth = cameraWith(60, 0, 0);
    const BoardCamera camera(truth);
    Rng rng(7);
    // The left edge towards the camera, and never the right one; all in the left half.
    std::vector<BoardPose> poses = camera.poses(9, rng);
    for (BoardPose& pose : poses) {
        pose.middle.x = -std::abs(pose.middle.x) - 3;
        pose.turn = {pose.turn.x > 0 ? 25.0 : -25.0, 0, 0};
    }
    BoardPose turned{{-3, 0, 16}, {0, 30, 0}};
    const auto left = camera.pixelOf(0, turned), right = camera.pixelOf(7, turned);
    const auto leftLower = camera.pixelOf(32, turned), rightLower = camera.pixelOf(39, turned);
    const bool leftIsNearer = glm::distance(*left, *leftLower) > glm::distance(*right, *rightLower);
    if (!leftIsNearer) turned.turn.y = -30;
    poses.push_back(turned);
    const std::vector<BoardView> views = viewsOf(camera, poses, rng);
    const auto fit = fitLens(views);
    ASSERT_TRUE(fit);
    const LensNeeds needs = needsOf(views, &*fit);
    EXPECT_THAT(needs.tilts, testing::ElementsAre("its right edge"));
    EXPECT_THAT(needs.places, Contains("top right"));
    EXPECT_THAT(needs.places, testing::Not(Contains("left")));
    EXPECT_EQ(needs.views, kEnoughViews - static_cast<int>(views.size()));
}

TEST(LensFit, needs_three_views) { EXPECT_THAT(fitLens({}).error().message(), HasSubstr("at least 3 views")); }

}  // namespace
}  // namespace fantascope::vision
