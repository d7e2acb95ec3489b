// The program as a person runs it, and its STL as another program reads it.

#include "app/a_cast_file.h"

#include "core/file.h"
#include "core/solid.h"
#include "program.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace fantascope {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using Arguments = std::vector<std::string>;

class FabricateCommand : public testing::Test {
protected:
    Outcome run(const Arguments& arguments) const { return runProgram(arguments, folder_ / "."); }
    // Small, to be quick.
    Outcome fabricate(const Arguments& more = {}, const std::string& cast = "a.cast.yaml") const {
        Arguments arguments = {"fabricate", cast, "-o", "a.stl", "--height", "40", "--detail", "0.4"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    }
    std::string text(const std::string& file) const { return readFile(folder_ / file).value(); }

    const ScratchFolder folder_;
};

TEST_F(FabricateCommand, writes_one_solid_that_another_reader_finds_sound) {
    writeACast(folder_, "a.cast.yaml", 1);
    const Outcome outcome = fabricate({"--report", "r.json", "--view", "v.png", "--sheet", "s.pdf"});
    ASSERT_THAT(outcome, exits(0));
    EXPECT_THAT(outcome.out, HasSubstr("one closed piece"));
    const TriangleMesh read = readMesh(folder_ / "a.stl").value();  // by assimp
    const SolidCheck check = checkSolid(read);
    EXPECT_TRUE(check.isSound());
    EXPECT_EQ(check.pieces, 1u);
    const auto report = nlohmann::json::parse(text("r.json"));
    EXPECT_NEAR(report["volume_cm3"].get<double>(), check.volume / 1000, 1e-3);
    EXPECT_EQ(report["triangles"].get<std::size_t>(), read.triangles.size());
    EXPECT_GT(report["shadow_iou"].get<double>(), 0.9);
    EXPECT_GE(report["contacts"].size(), 2u);
    EXPECT_NEAR(report["scale"].get<double>() * 1000, 40 / 1.7, 4) << "the taller one is 1.7 m, arms raised or not";
    EXPECT_GT(fs::file_size(folder_ / "v.png"), 1000u);
    EXPECT_THAT(text("s.pdf"), AllOf(StartsWith("%PDF"), testing::Not(HasSubstr("CreationDate"))));
}

TEST_F(FabricateCommand, is_the_same_bytes_every_time) {
    writeACast(folder_, "a.cast.yaml", 1);
    ASSERT_THAT(fabricate({"--sheet", "s.pdf"}), exits(0));
    const std::string stl = text("a.stl"), sheet = text("s.pdf");
    ASSERT_THAT(fabricate({"--sheet", "s.pdf"}), exits(0));
    EXPECT_TRUE(stl == text("a.stl"));
    EXPECT_TRUE(sheet == text("s.pdf"));
}

// A sheet with a bar to be measured is of no use in pixels.
TEST_F(FabricateCommand, the_sheet_is_as_large_as_its_paper) {
    writeACast(folder_, "a.cast.yaml", 1);
    ASSERT_THAT(fabricate({"--sheet", "s.svg"}), exits(0));
    EXPECT_THAT(text("s.svg"), AllOf(HasSubstr("width=\"842pt\""), HasSubstr("height=\"595pt\"")));
}

TEST_F(FabricateCommand, prints_what_stands_on_the_stage_and_what_is_held) {
    writeAStage(folder_, "hall.stage.yaml");
    writeACast(folder_, "a.cast.yaml", 1, "hall.stage.yaml");
    ASSERT_THAT(fabricate({"--report", "r.json"}), exits(0));
    const auto report = nlohmann::json::parse(text("r.json"));
    EXPECT_EQ(report["pieces"], 1);
    std::string contacts;
    for (const auto& contact : report["contacts"]) contacts += contact["who"].get<std::string>() + "\n";
    EXPECT_THAT(contacts,
                AllOf(HasSubstr("actor 1"), HasSubstr("actor 2"), HasSubstr("prop 'rock'"), HasSubstr("platform 'step'")));
    EXPECT_TRUE(report["rods"].empty()) << "the parcel is in a hand: " << report["rods"];
}

TEST_F(FabricateCommand, takes_the_frame_that_is_asked_for) {
    writeACast(folder_, "a.cast.yaml", 3);
    ASSERT_THAT(fabricate(), exits(0));
    const std::string first = text("a.stl");
    ASSERT_THAT(fabricate({"--frame", "2"}), exits(0));
    EXPECT_FALSE(first == text("a.stl"));
    EXPECT_THAT(fabricate({"--frame", "3"}), AllOf(exits(1), testing::Field(&Outcome::errors, HasSubstr("beyond its last, 2"))));
}

TEST_F(FabricateCommand, leaves_nothing_when_it_is_interrupted) {
    writeACast(folder_, "a.cast.yaml", 1);
    EXPECT_EQ(interruptProgram({"fabricate", "a.cast.yaml", "-o", "b.stl"}, folder_ / ".", 1), 1);
    EXPECT_FALSE(fs::exists(folder_ / "b.stl"));
}

TEST_F(FabricateCommand, refuses_what_it_cannot_print) {
    writeACast(folder_, "a.cast.yaml", 1);
    const auto refused = [&](const Outcome& outcome, int status, const auto& what) {
        EXPECT_THAT(outcome, exits(status));
        EXPECT_THAT(outcome.errors, what);
    };
    refused(run({"fabricate", "none.cast.yaml", "-o", "a.stl"}), 1, HasSubstr("none.cast.yaml"));
    refused(run({"fabricate", "a.cast.yaml", "-o", "a.obj"}), 2, HasSubstr("does not end in .stl"));
    refused(run({"fabricate", "a.cast.yaml", "-o", "a.stl", "--sheet", "s.png"}), 2, HasSubstr("does not end in .pdf or .svg"));
    refused(run({"fabricate", "a.cast.yaml", "-o", "a.stl", "--height", "5"}), 1, HasSubstr("height = 5 must be 20 .. 1000 mm"));
    refused(run({"fabricate", "a.cast.yaml", "-o", "target.png/a.stl"}), 1, HasSubstr("cannot be written"));
    fs::remove(folder_ / "target.png");
    refused(fabricate(), 1, HasSubstr("target.png"));
}

}  // namespace
}  // namespace fantascope
