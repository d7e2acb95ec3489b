#include "theatre/deform/silhouette_sequence.h"

#include "core/file.h"
#include "media/image.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <string>

namespace fantascope::theatre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class SequenceFile : public testing::Test {
protected:
    SequenceFile() {
        for (const char* name : {"a 1.png", "b.png"}) EXPECT_TRUE(writePng(folder_ / name, GreyImage(30, 20)));
    }
    SilhouetteSequence aSequence() const {
        SilhouetteSequence sequence{{folder_ / "a 1.png", folder_ / "b.png"}, 29.97, true, {}};
        sequence.interior = {{{0, 1, 2}, {2, 1, 3}},
                             {{{0, 0}, {1.0 / 3, 0}, {0, 0.1}, {-1e-7, 512.25}}, {{1, 2}, {3, 4}, {5, 6}, {7, 8}}}};
        return sequence;
    }
    std::string refusal(const std::string& rest) {
        folder_.file("s.yaml", "fantascope: sequence\nversion: 1\nframes_per_second: 12\n" + rest);
        const auto sequence = readSequence(folder_ / "s.yaml");
        return sequence ? "read" : folder_.relative(sequence.error().message());
    }
    const ScratchFolder folder_;
};

TEST_F(SequenceFile, comes_back_to_the_last_bit) {
    const SilhouetteSequence sequence = aSequence();
    ASSERT_TRUE(writeSequence(folder_ / "sequence.yaml", sequence));
    const auto again = readSequence(folder_ / "sequence.yaml");
    ASSERT_TRUE(again) << again.error().message();
    EXPECT_EQ(again->pictures, sequence.pictures);
    EXPECT_EQ(again->framesPerSecond, sequence.framesPerSecond);
    EXPECT_TRUE(again->loops);
    ASSERT_TRUE(again->interior);
    EXPECT_EQ(again->interior->triangles, sequence.interior->triangles);
    EXPECT_EQ(again->interior->vertices, sequence.interior->vertices);
    EXPECT_THAT(readFile(folder_ / "sequence.yaml").value(), HasSubstr("- 1 2 3 4 5 6 7 8\n")) << "no digit too many";
}

TEST_F(SequenceFile, may_be_pictures_alone) {
    SilhouetteSequence sequence = aSequence();
    sequence.interior.reset();
    sequence.loops = false;
    ASSERT_TRUE(writeSequence(folder_ / "sequence.yaml", sequence));
    const auto again = readSequence(folder_ / "sequence.yaml");
    ASSERT_TRUE(again) << again.error().message();
    EXPECT_FALSE(again->interior);
    EXPECT_FALSE(again->loops);
}

TEST_F(SequenceFile, that_could_not_be_read_again_is_not_written) {
    SilhouetteSequence sequence = aSequence();
    sequence.interior->vertices.pop_back();
    const auto written = writeSequence(folder_ / "sequence.yaml", sequence);
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message(), HasSubstr("1 frames, and there are 2 pictures"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "sequence.yaml"));
    EXPECT_FALSE(writeSequence(folder_ / "below/sequence.yaml", aSequence())) << "its pictures are not below it";
}

TEST_F(SequenceFile, is_refused_with_the_place_and_what_is_wrong) {
    const std::string pictures = "pictures: [a 1.png, b.png]\n";
    EXPECT_EQ(refusal(pictures), "read");
    EXPECT_THAT(refusal("pictures: []\n"), HasSubstr("pictures"));
    EXPECT_THAT(refusal("pictures: [a 1.png, c.png]\n"), HasSubstr("s.yaml:4:21: pictures[1]: c.png: cannot be read"));
    EXPECT_TRUE(writePng(folder_ / "large.png", GreyImage(31, 20)));
    EXPECT_THAT(refusal("pictures: [a 1.png, large.png]\n"),
                AllOf(HasSubstr("large.png is 31 x 20"), HasSubstr("30 x 20"), HasSubstr("one size")));
    const auto withInterior = [&](const std::string& triangles, const std::string& frames) {
        return refusal(pictures + "interior:\n  triangles: " + triangles + "\n  frames: " + frames + "\n");
    };
    EXPECT_EQ(withInterior("0 1 2", "[0 0 1 0 0 1, 0 0 1 0 0 1]"), "read");
    EXPECT_THAT(withInterior("0 1", "[0 0, 0 0]"), AllOf(HasSubstr("interior.triangles"), HasSubstr("takes three")));
    EXPECT_THAT(withInterior("0 1 1", "[0 0, 0 0]"), HasSubstr("three different"));
    EXPECT_THAT(withInterior("0 1 3", "[0 0 1 0 0 1, 0 0 1 0 0 1]"), HasSubstr("number 3 for a corner"));
    EXPECT_THAT(withInterior("0 1 2", "[0 0 1 0 0 1, 0 0 1 0]"),
                AllOf(HasSubstr("frames[1]"), HasSubstr("2 vertices, and the first frame has 3")));
    EXPECT_THAT(withInterior("0 1 2", "[0 0 1 0 0 1, 0 0 1]"), HasSubstr("takes two"));
    EXPECT_THAT(withInterior("0 1 2", "[0 0 1 0 0 1]"), HasSubstr("1 frames, and there are 2 pictures"));
    EXPECT_THAT(withInterior("0 1 2", "[0 0 1 0 0 1, 0 0 1 0 0 one]"),
                AllOf(HasSubstr("frames[1]"), HasSubstr("'one' is no number")));
    EXPECT_THAT(withInterior("0 1 2", "[0 0 1 0 0 1, 0 0 1 0 0 1e7]"),
                HasSubstr("'1e7' is no number within -1000000 .. 1000000"));
    EXPECT_THAT(withInterior("0 1 2", "[0 0 1 0 0 1, 0 0 1 0 0 nan]"), HasSubstr("'nan' is no number"));
    EXPECT_THAT(withInterior("0 1 -2", "[0 0 1 0 0 1, 0 0 1 0 0 1]"), HasSubstr("'-2' is no number"));
    EXPECT_THAT(refusal(pictures + "speed: 3\n"), HasSubstr("unknown key"));
}

}  // namespace
}  // namespace fantascope::theatre
