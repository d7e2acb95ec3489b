// Recorded pictures, and a person who ends the reading.

#include "app/lens/recorded_views.h"

#include "app/lens/lens_result.h"

#include "vision/board_pictures.h"

#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace fantascope::app {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using vision::BoardCamera;
using vision::CameraModel;

TEST(RecordedViews, are_those_of_the_pictures_before_the_end) {
    const BoardCamera camera(*CameraModel::fromFieldOfView(Pose(), {400, 300}, 1));
    const ScratchFolder folder;
    Rng rng(3);
    const auto poses = camera.poses(4, rng);
    for (std::size_t i = 0; i < poses.size(); ++i)
        ASSERT_TRUE(writePng(folder / fmt::format("{}.PNG", i), camera.picture(poses[i], rng)));
    const std::vector<std::uint8_t> jpeg = jpegOf(camera.picture(poses[0], rng), 95);
    folder.file("a.jpeg", {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
    folder.file("notes.txt", "");
    const auto all = recordedViews(folder / ".", std::nullopt, [](double) { return true; });
    ASSERT_TRUE(all) << all.error().message();
    EXPECT_THAT(all->names, ElementsAre("0.PNG", "1.PNG", "2.PNG", "3.PNG", "a.jpeg"));
    std::vector<double> told;
    const auto some = recordedViews(folder / ".", glm::ivec2(400, 300), [&](double done) {
        told.push_back(done);
        return told.size() < 4;
    });
    EXPECT_THAT(some->names, ElementsAre("0.PNG", "1.PNG", "2.PNG"));
    EXPECT_THAT(told, ElementsAre(0, 0.2, 0.4, testing::DoubleEq(0.6)));
    // What there is by then is fitted, and said to be too little.
    EXPECT_THAT(lensOf(some->views, some->missed)->trouble, HasSubstr("only 3 views"));
}

}  // namespace
}  // namespace fantascope::app
