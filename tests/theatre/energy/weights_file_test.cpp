#include "theatre/energy/weights_file.h"

#include "core/file.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <gmock/gmock.h>

#include <array>

namespace fantascope::theatre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::filesystem::path kPaper = sourceFolder() + "/assets/silhouettes/weights.yaml";

std::array<double, 12> all(const PoseWeights& w) {
    return {w.w1, w.w2, w.w3, w.w4, w.w5, w.w6, w.w7, w.w8, w.w9, w.w10, w.w11, w.w12};
}

class WeightsFile : public testing::Test {
protected:
    std::filesystem::path file(const std::string& rest) {
        EXPECT_TRUE(writeFile(folder_ / "a.weights.yaml", "fantascope: pose-weights\nversion: 1\n" + rest));
        return folder_ / "a.weights.yaml";
    }
    std::string refusal(const std::string& rest, std::string_view preset = "") {
        const auto read = readWeights(file(rest), preset);
        return read ? "read" : read.error().message();
    }
    ScratchFolder folder_;
};

// Table 1, by hand.
TEST_F(WeightsFile, of_the_paper_is_table_1) {
    const auto rabbit = readWeights(kPaper, "rabbit"), airplane = readWeights(kPaper, "airplane"),
               circle = readWeights(kPaper, "circle");
    ASSERT_TRUE(rabbit && airplane && circle);
    EXPECT_EQ(all(*rabbit), (std::array<double, 12>{0.01, 0.01, 0.005, 1500, 5, 0.1, 3, 0.001, 10, 0.04, 0.04, 0.25}));
    EXPECT_EQ(all(*airplane), (std::array<double, 12>{0.02, 0.01, 0.01, 1000, 5, 0.1, 3, 0.001, 10, 0.04, 0.04, 0.25}));
    EXPECT_EQ(all(*circle), all(PoseWeights())) << "the defaults are those of simple shapes";
    for (const char* name : {"triangle", "rectangle", "elephant", "hat", "highheel", "mountain", "tshirt", "car", "violin"})
        EXPECT_TRUE(readWeights(kPaper, name)) << name;
}

TEST_F(WeightsFile, of_ones_own_is_laid_over_others) {
    PoseWeights base;
    base.w1 = 0.5, base.w12 = 7;
    const auto own = readWeights(file("common: {w5: 8, w4: 10}\npresets:\n  cat: {w4: 20, w2: 0}\n"), "cat", base);
    ASSERT_TRUE(own);
    EXPECT_EQ(own->w1, 0.5);
    EXPECT_EQ(own->w12, 7);
    EXPECT_EQ(own->w5, 8);
    EXPECT_EQ(own->w4, 20) << "a preset counts over what is common";
    EXPECT_EQ(own->w2, 0);
    const auto common = readWeights(file("common: {w5: 8, w4: 10}\npresets:\n  cat: {w4: 20}\n"), "", base);
    ASSERT_TRUE(common);
    EXPECT_EQ(common->w4, 10);
    EXPECT_EQ(all(*readWeights(file(""), "", base)), all(base));
}

TEST_F(WeightsFile, is_refused_with_the_place_and_the_weight) {
    EXPECT_THAT(refusal("common: {w5: -1}\n"),
                AllOf(HasSubstr("a.weights.yaml:3:14: common.w5: -1 is out of range"), HasSubstr("0 ..")));
    EXPECT_THAT(refusal("presets:\n  cat: {w1: 1}\n  dog: {w4: -2}\n", "cat"), HasSubstr("presets.dog.w4: -2"));
    EXPECT_THAT(refusal("common: {w17: 1}\n"), HasSubstr("unknown key"));
    EXPECT_THAT(refusal("weights: {w1: 1}\n"), HasSubstr("unknown key"));
    EXPECT_THAT(refusal("presets:\n  cat: {w1: 1}\n  dog: {}\n", "cta"),
                AllOf(HasSubstr("no preset 'cta'"), HasSubstr("it has cat, dog")));
    EXPECT_THAT(refusal("presets:\n  rabbit: {w1: 1}\n", "rabit"), HasSubstr("did you mean 'rabbit'?"));
    EXPECT_THAT(refusal("", "cat"), HasSubstr("it has none"));
    EXPECT_THAT(refusal("common: {w1: much}\n"), HasSubstr("a number"));
}

}  // namespace
}  // namespace fantascope::theatre
