#include "core/file.h"
#include "core/image.h"
#include "program.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

namespace fantascope {
namespace {

using testing::HasSubstr;

// A folder with a small pattern, its drawing and the report of its search.
class PlotCommand : public testing::Test {
protected:
    PlotCommand() {
        GreyImage guide(64, 36);
        for (int y = 8; y < 28; ++y)
            for (int x = 8; x < 40; ++x) guide.at(x, y) = 1;
        EXPECT_TRUE(writePng(folder_ / "guide.png", guide));
        EXPECT_EQ(
            run({"pattern", "guide.png", "-o", "p.pattern.yaml", "--instances", "40", "--iterations", "3", "--report", "p.json"})
                .status,
            0);
    }
    Outcome run(const std::vector<std::string>& arguments) const { return runProgram(arguments, folder_ / "."); }
    int width(const std::string& picture) const { return readRgba(folder_ / picture).value().width(); }

    const ScratchFolder folder_;
};

TEST_F(PlotCommand, draws_a_pattern_or_a_report_by_what_it_is) {
    for (const char* figure : {"difference", "trajectories", "spectrum"})
        EXPECT_EQ(run({"plot", "p.pattern.yaml", "--figure", figure, "-o", std::string(figure) + ".png"}).status, 0) << figure;
    EXPECT_EQ(run({"plot", "p.json", "--figure", "search", "-o", "search.png"}).status, 0);
    EXPECT_EQ(run({"plot", "p.pattern.yaml", "-o", "pattern.png"}).status, 0);
    EXPECT_EQ(run({"plot", "p.json", "-o", "report.svg"}).status, 0);
    EXPECT_EQ(readFile(folder_ / "pattern.png").value(), readFile(folder_ / "difference.png").value());
    EXPECT_NE(readFile(folder_ / "trajectories.png").value(), readFile(folder_ / "spectrum.png").value());
    EXPECT_GT(width("search.png"), 500);
    EXPECT_THAT(readFile(folder_ / "report.svg").value(), HasSubstr("<svg"));
}

TEST_F(PlotCommand, says_what_it_cannot_draw) {
    EXPECT_TRUE(writeFile(folder_ / "other.json", "{\"history\": 3}"));
    EXPECT_TRUE(writeFile(folder_ / "broken.json", "{"));
    for (const char* file : {"other.json", "broken.json"}) {
        const Outcome refused = run({"plot", file, "-o", "x.png"});
        EXPECT_EQ(refused.status, 1);
        EXPECT_THAT(refused.errors, HasSubstr(std::string(file) + ": is no report of a search"));
    }
    EXPECT_THAT(run({"plot", "p.json", "--figure", "spectrum", "-o", "x.png"}).errors, HasSubstr("needs a pattern"));
    EXPECT_THAT(run({"plot", "p.pattern.yaml", "--figure", "search", "-o", "x.png"}).errors, HasSubstr("needs the report"));
    EXPECT_THAT(run({"plot", "absent.pattern.yaml", "-o", "x.png"}).errors, HasSubstr("absent.pattern.yaml"));
    EXPECT_EQ(run({"plot", "p.pattern.yaml", "-o", "x.jpg"}).status, 2);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "x.png"));
}

}  // namespace
}  // namespace fantascope
