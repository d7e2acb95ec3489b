// The program as a person runs it, and its STL as another program reads it.

#include "app/a_cast_file.h"

#include "core/file.h"
#include "media/solid.h"
#include "program.h"

#include <glm/common.hpp>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
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

// The shadow cast again, from what is written alone: the STL, and the lamp's and the screen's
// places.
TEST_F(FabricateCommand, lamp_and_screen_are_where_the_shadow_is_the_poses) {
    const theatre::Cast cast = writeACast(folder_, "a.cast.yaml", 1);
    ASSERT_THAT(fabricate({"--report", "r.json"}), exits(0));
    const auto report = nlohmann::json::parse(text("r.json"));
    const TriangleMesh print = readMesh(folder_ / "a.stl").value();
    const glm::dvec3 lamp(report["lamp_mm"][0], report["lamp_mm"][1], report["lamp_mm"][2]);
    const double screen = report["screen_mm"], mm = 1000 * report["scale"].get<double>();  // of the print, in a metre
    // The picture's rectangle on the screen: 11/9 as wide as high, in front of the lamp, on the
    // floor.
    constexpr int kAcross = 500, kUp = 250;
    const double pixel = cast.targets[0].height * mm / 160;
    const auto isTarget = [&](int x, int y) {
        return std::abs(x + 0.5 - kAcross / 2) * pixel < cast.targets[0].height * mm * 11 / 18 && y < 160;
    };
    std::vector<char> shadow(kAcross * kUp, 0);
    for (const glm::uvec3& triangle : print.triangles) {
        glm::dvec2 p[3];
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 v = print.vertices[triangle[i]];
            const double along = (screen - lamp.y) / (v.y - lamp.y);
            p[i] = {kAcross / 2 + along * (v.x - lamp.x) / pixel, (lamp.z + along * (v.z - lamp.z)) / pixel};
        }
        const auto side = [](const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
            return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        };
        const glm::dvec2 low = glm::min(glm::min(p[0], p[1]), p[2]), high = glm::max(glm::max(p[0], p[1]), p[2]);
        for (int y = std::max(0, static_cast<int>(low.y)); y < std::min<double>(kUp, high.y); ++y)
            for (int x = std::max(0, static_cast<int>(low.x)); x < std::min<double>(kAcross, high.x); ++x) {
                const glm::dvec2 c(x + 0.5, y + 0.5);
                const double a = side(p[0], p[1], c), b = side(p[1], p[2], c), d = side(p[2], p[0], c);
                if ((a >= 0 && b >= 0 && d >= 0) || (a <= 0 && b <= 0 && d <= 0))
                    shadow[static_cast<std::size_t>(y * kAcross + x)] = 1;
            }
    }
    double either = 0, both = 0;
    for (int y = 0; y < kUp; ++y)
        for (int x = 0; x < kAcross; ++x) {
            const bool isDark = shadow[static_cast<std::size_t>(y * kAcross + x)] != 0;
            either += isDark || isTarget(x, y), both += isDark && isTarget(x, y);
        }
    EXPECT_GT(both / either, 0.1);
    EXPECT_NEAR(both / either, report["target_iou"].get<double>(), 0.01);
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
    EXPECT_THAT(fabricate({"--frame", "3"}),
                AllOf(exits(1), testing::Field(&Outcome::errors, HasSubstr("beyond the last frame, 2"))));
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
