// A lens is kept by its camera, and comes back the same.

#include "app/lens/lens_file.h"

#include "app/site/site_file.h"

#include "core/file.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <cstdlib>

namespace fantascope::app {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const CameraDescription kCamera{.card = "HD: Webcam/C525", .serial = "4F2A", .format = "", .lacks = "", .exposure = {}};

KeptLens aLens() { return {kCamera.card, kCamera.serial, {1280, 720}, 1.0625, {641.25, 355.5}, -0.0625, 0.0123, 0.21, 18, {}}; }

void expectSame(const KeptLens& a, const KeptLens& b) {
    EXPECT_NEAR(a.fieldOfView, b.fieldOfView, 1e-5);
    EXPECT_EQ(a.centre, b.centre);
    EXPECT_EQ(std::pair(a.k1, a.k2), std::pair(b.k1, b.k2));
    EXPECT_EQ(std::pair(a.rms, a.views), std::pair(b.rms, b.views));
    EXPECT_EQ(a.light, b.light);
}

TEST(LensFile, comes_back_for_its_camera_and_size_alone) {
    const ScratchFolder folder;
    const auto file = keepLens(folder / "lenses", aLens());
    ASSERT_TRUE(file) << file.error().message();
    const auto kept = keptLens(folder / "lenses", kCamera, {1280, 720});
    ASSERT_TRUE(kept && *kept);
    expectSame(**kept, aLens());
    EXPECT_FALSE(*keptLens(folder / "lenses", kCamera, {640, 360}));
    CameraDescription other = kCamera;
    other.serial = "4F2B";
    EXPECT_FALSE(*keptLens(folder / "lenses", other, {1280, 720}));
    // Its name gives the same file.
    other = kCamera;
    other.card = "HD- Webcam/C525";
    EXPECT_FALSE(*keptLens(folder / "lenses", other, {1280, 720}));
    EXPECT_EQ((**kept).camera(), "HD: Webcam/C525, serial 4F2A");
}

TEST(LensFile, keeps_the_light_beside_a_new_lens_and_the_lens_beside_new_light) {
    const ScratchFolder folder;
    KeptLens light{kCamera.card, kCamera.serial, {1280, 720}, 0, {0, 0}, 0, 0, 0, 0, {{0, 0.25, 1}, {{3, 4}, {900, 700}}}};
    ASSERT_TRUE(keepLens(folder / ".", light));
    ASSERT_TRUE(keepLens(folder / ".", aLens()));
    KeptLens both = aLens();
    both.light = light.light;
    expectSame(**keptLens(folder / ".", kCamera, {1280, 720}), both);
    light.light.response = {0, 0.5, 1};
    ASSERT_TRUE(keepLens(folder / ".", light));
    both.light = light.light;
    expectSame(**keptLens(folder / ".", kCamera, {1280, 720}), both);
}

TEST(LensFile, is_refused_where_it_is_damaged) {
    const ScratchFolder folder;
    const auto refusal = [&](const std::string& more) {
        const auto read =
            readLens(folder.file("a.lens.yaml", "fantascope: lens\nversion: 1\ncard: C525\nsize: [640, 480]\n" + more));
        return read ? "accepted" : folder.relative(read.error().message());
    };
    EXPECT_EQ(refusal(""), "accepted");
    EXPECT_THAT(refusal("len: {}\n"), HasSubstr("a.lens.yaml:5:1: len: unknown key"));
    EXPECT_THAT(refusal("lens: {field_of_view: 60}\n"), HasSubstr("'centre'"));
    EXPECT_THAT(refusal("response: [0, 0.6, 0.5, 1]\n"), HasSubstr("must rise"));
    EXPECT_THAT(refusal("response: [0, 0.6]\n"), HasSubstr("to 1"));
    EXPECT_THAT(refusal("hot_pixels: [[3, -1]]\n"), HasSubstr("a.lens.yaml:5"));
}

class LensInASite : public testing::Test {
protected:
    show::Site site(const std::string& more = "") {
        folder_.file("site.yaml",
                     "fantascope: site\nversion: 1\n"
                     "outputs: [{name: a, display: {driver: headless}, size: [64, 64], refresh_rate: 30}]\n"
                     "camera:   # on the tree\n  device: {driver: v4l2}\n  size: [1280, 720]\n  field_of_view: 50\n"
                     "  position: [0, 0, 5]\n  look_at: [0, 0, 0]\n" +
                         more);
        return readSite(folder_ / "site.yaml").value();
    }
    const ScratchFolder folder_;
};

TEST_F(LensInASite, replaces_the_lens_and_nothing_else) {
    KeptLens lens = aLens();
    lens.light = {{0, 0.25, 1}, {{3, 4}}};
    ASSERT_TRUE(writeLens(site(), lens));
    const show::Site now = readSite(folder_ / "site.yaml").value();
    const show::NominalCamera& camera = *now.nominalCamera;
    EXPECT_NEAR(camera.fieldOfView, lens.fieldOfView, 1e-5);
    EXPECT_EQ(camera.centre, lens.centre);
    EXPECT_EQ(std::pair(camera.k1, camera.k2), std::pair(lens.k1, lens.k2));
    EXPECT_EQ(camera.lensOf, lens.camera());
    EXPECT_EQ(camera.response, lens.light.response);
    EXPECT_THAT(camera.hotPixels, ElementsAre(glm::ivec2(3, 4)));
    EXPECT_THAT(now.text, AllOf(HasSubstr("# on the tree"), HasSubstr("position: [0, 0, 5]")));

    // From pictures: nobody knows whose lens it is.
    KeptLens unknown = aLens();
    unknown.card = unknown.serial = "";
    ASSERT_TRUE(writeLens(now, unknown));
    EXPECT_THAT(readFile(folder_ / "site.yaml").value(), Not(HasSubstr("lens_of")));
}

TEST_F(LensInASite, is_told_where_it_belongs_to_another_camera) {
    EXPECT_THAT(lensMismatch(site(), kCamera), IsEmpty());
    const show::Site ours = site("  lens_of: 'HD: Webcam/C525, serial 4F2A'\n");
    EXPECT_THAT(lensMismatch(ours, kCamera), IsEmpty());
    EXPECT_THAT(lensMismatch(ours, {}), IsEmpty()) << "the camera is not there yet";
    CameraDescription other = kCamera;
    other.serial = "77";
    EXPECT_THAT(lensMismatch(ours, other), AllOf(HasSubstr("serial 4F2A"), HasSubstr("serial 77"), HasSubstr("--kept")));
}

TEST(LensFolder, is_the_persons_own) {
    ::setenv("XDG_DATA_HOME", "/data", 1);
    EXPECT_EQ(*lensFolder(), "/data/fantascope/lenses");
    ::setenv("XDG_DATA_HOME", "no absolute path", 1);
    ::setenv("HOME", "/root", 1);
    EXPECT_EQ(*lensFolder(), "/root/.local/share/fantascope/lenses");
    ::unsetenv("HOME");
    EXPECT_FALSE(lensFolder());
}

}  // namespace
}  // namespace fantascope::app
