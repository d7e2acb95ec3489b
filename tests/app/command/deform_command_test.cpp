// The program as a person runs it: its exit statuses, its messages, and what it leaves behind.

#include "theatre/deform/silhouette_sequence.h"

#include "core/file.h"
#include "media/image.h"
#include "pictures.h"
#include "program.h"
#include "running_program.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <glm/geometric.hpp>
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
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;
using Arguments = std::vector<std::string>;

// A bar that stands on the floor, and a motion that bends its upper end to the right within a
// second.
class DeformCommand : public testing::Test {
protected:
    DeformCommand() {
        EXPECT_TRUE(writePng(folder_ / "bar.png", bar()));
        motion(1.0, "");
    }
    static GreyImage bar() {
        return pictureOf(160, 140, [](int x, int y) { return isIn(x, y, 60, 30, 30, 100); });
    }
    void motion(double seconds, const std::string& head, const std::string& by = "[0.25, 0.1]",
                const std::string& more = "") const {
        folder_.file("bar.motion.yaml",
                     fmt::format("fantascope: motion\nversion: 1\nseconds: {}\nframes_per_second: 10\n{}handles:\n"
                                 "  - {{name: left foot, at: [0.4, 0.9]}}\n  - {{name: right foot, at: [0.54, 0.9]}}\n{}"
                                 "  - {{name: top, at: [0.47, 0.25], keys: [{{time: 0, by: [0, 0]}}, {{time: {}, by: {}}}]}}\n",
                                 seconds, head, more, 0.8 * seconds, by));
    }
    Outcome run(const Arguments& arguments) const { return runProgram(arguments, folder_ / "."); }
    Outcome deform(const Arguments& more = {}) const {
        Arguments arguments = {"deform", "bar.png", "--motion", "bar.motion.yaml", "-o", "out"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    }
    std::string text(const std::string& file) const { return readFile(folder_ / file).value(); }
    theatre::SilhouetteSequence sequence(const std::string& folder = "out") const {
        auto read = theatre::readSequence(folder_ / folder / "sequence.yaml");
        EXPECT_TRUE(read) << read.error().message();
        return std::move(read).value();
    }
    std::vector<std::string> written(const std::string& folder = ".") const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_ / folder)) names.push_back(entry.path().filename());
        std::sort(names.begin(), names.end());
        return names;
    }

    const ScratchFolder folder_;
};

struct Seen {
    int both = 0, either = 0, lowest = 0;
    double overlap() const { return double(both) / either; }
};
Seen compared(const GreyImage& a, const GreyImage& b) {
    Seen seen;
    for (int y = 0; y < a.height(); ++y)
        for (int x = 0; x < a.width(); ++x) {
            const bool inA = a.at(x, y) > 0.5f, inB = b.at(x, y) > 0.5f;
            seen.both += inA && inB, seen.either += inA || inB;
            if (inB) seen.lowest = y;
        }
    return seen;
}

// How much of the picture the triangles cover: 1 where a pixel's centre lies in one.
GreyImage covered(const theatre::SilhouetteSequence& sequence, std::size_t frame, int width, int height) {
    const auto& vertices = sequence.interior->vertices[frame];
    return pictureOf(width, height, [&](int x, int y) {
        const glm::dvec2 p(x + 0.5, y + 0.5);
        const auto side = [&](glm::dvec2 a, glm::dvec2 b) { return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x); };
        for (const glm::uvec3 t : sequence.interior->triangles) {
            const double a = side(vertices[t.x], vertices[t.y]), b = side(vertices[t.y], vertices[t.z]),
                         c = side(vertices[t.z], vertices[t.x]);
            if (std::min({a, b, c}) >= 0 || std::max({a, b, c}) <= 0) return true;
        }
        return false;
    });
}

TEST_F(DeformCommand, writes_a_sequence_with_the_same_triangles_in_each_frame) {
    const Outcome done = deform();
    ASSERT_THAT(done, exits(0));
    EXPECT_THAT(done.out, StartsWith("out: 11 frames, 1.10 s, 160 x 140 pixels"));
    EXPECT_THAT(done.errors, Not(HasSubstr("warning")));
    EXPECT_THAT(written(), ElementsAre("bar.motion.yaml", "bar.png", "out"));
    fs::rename(folder_ / "out", folder_ / "moved");  // as a folder it can go anywhere
    const theatre::SilhouetteSequence sequence = this->sequence("moved");
    ASSERT_EQ(sequence.pictures.size(), 11u);
    EXPECT_EQ(sequence.pictures[0].filename(), "frame-0001.png");
    EXPECT_EQ(written("moved").size(), 12u);
    EXPECT_EQ(sequence.framesPerSecond, 10);
    EXPECT_FALSE(sequence.loops);
    const GreyImage first = readGrey(sequence.pictures[0]).value(), last = readGrey(sequence.pictures[10]).value();
    EXPECT_GT(compared(bar(), first).overlap(), 0.995) << "at rest it is the drawing";
    EXPECT_LT(compared(bar(), last).overlap(), 0.7);
    // Picture and triangles tell the same of each frame.
    for (std::size_t frame = 0; frame < 11; ++frame) {
        const GreyImage picture = readGrey(sequence.pictures[frame]).value();
        EXPECT_GT(compared(picture, covered(sequence, frame, 160, 140)).overlap(), 0.96) << frame;
        EXPECT_NEAR(compared(picture, picture).lowest, 129, 1) << "it stands on the floor";
    }
    // The motion ends at .8 s and stays there.
    EXPECT_EQ(readFile(sequence.pictures[8]).value(), readFile(sequence.pictures[10]).value());
    EXPECT_NE(readFile(sequence.pictures[7]).value(), readFile(sequence.pictures[8]).value());
}

TEST_F(DeformCommand, gives_the_same_bytes_again) {
    ASSERT_THAT(deform(), exits(0));
    fs::rename(folder_ / "out", folder_ / "first");
    ASSERT_THAT(deform(), exits(0));
    for (const std::string& name : written("first")) EXPECT_EQ(text("first/" + name), text("out/" + name)) << name;
}

TEST_F(DeformCommand, has_as_many_frames_as_are_wanted_over_the_whole_motion) {
    ASSERT_THAT(deform({"--fps", "5"}), exits(0));
    EXPECT_EQ(sequence().pictures.size(), 6u);
    EXPECT_EQ(sequence().framesPerSecond, 5);
    ASSERT_THAT(deform({"--frames", "5"}), exits(0));
    EXPECT_EQ(sequence().pictures.size(), 5u);
    EXPECT_EQ(sequence().framesPerSecond, 4);
    const auto end = sequence().interior->vertices.back();
    ASSERT_THAT(deform({"--frames", "3", "--fps", "24"}), exits(0));
    EXPECT_EQ(sequence().framesPerSecond, 24);
    EXPECT_EQ(sequence().interior->vertices.back(), end) << "the last frame is the motion's end";
    // A loop's last frame is the one before its first.
    motion(1.0, "loop: true\n");
    ASSERT_THAT(deform(), exits(0));
    EXPECT_EQ(sequence().pictures.size(), 10u);
    EXPECT_TRUE(sequence().loops);
    ASSERT_THAT(deform({"--vertices", "1000"}), exits(0));
    EXPECT_NEAR(static_cast<double>(sequence().interior->vertices[0].size()), 1000, 150);
}

// A second try replaces the first one, of which nothing is left; what else is in the folder is
// nobody's business.
TEST_F(DeformCommand, replaces_a_sequence_and_nothing_else) {
    ASSERT_THAT(deform({"--sheet", "out/sheet.png"}), exits(0));
    folder_.file("out/notes.txt", "mine");
    ASSERT_THAT(deform({"--frames", "2"}), exits(0));
    EXPECT_THAT(written("out"), ElementsAre("frame-0001.png", "frame-0002.png", "notes.txt", "sequence.yaml", "sheet.png"));
    EXPECT_EQ(sequence().pictures.size(), 2u);
}

// Example failure: each frame is widened by itself, and the feet jump.
TEST_F(DeformCommand, widens_all_pictures_alike_for_what_leaves_them) {
    motion(1.0, "", "[0.6, -0.3]");
    const Outcome done = deform({"--report", "r.json"});
    ASSERT_THAT(done, exits(0));
    EXPECT_THAT(done.out, HasSubstr("all pictures are wider than the silhouette's by 0 pixels on the left"));
    const nlohmann::json report = nlohmann::json::parse(text("r.json"));
    const std::vector<int> widened = report["widened"], size = report["size"];
    EXPECT_EQ(widened[0], 0);
    EXPECT_EQ(widened[3], 0);
    EXPECT_GT(widened[1], 0);
    EXPECT_GT(widened[2], 0);
    EXPECT_THAT(size, ElementsAre(160 + widened[2], 140 + widened[1]));
    const theatre::SilhouetteSequence sequence = this->sequence();
    for (std::size_t frame = 0; frame < sequence.pictures.size(); ++frame) {
        const GreyImage picture = readGrey(sequence.pictures[frame]).value();
        EXPECT_NEAR(compared(picture, picture).lowest, 129 + widened[1], 1);
        EXPECT_GT(compared(picture, covered(sequence, frame, size[0], size[1])).overlap(), 0.9);
        for (int x = 0; x < size[0]; ++x) EXPECT_EQ(picture.at(x, 0), 0) << "nothing is cut off";
        for (int y = 0; y < size[1]; ++y) EXPECT_EQ(picture.at(size[0] - 1, y), 0) << "nothing is cut off";
    }
}

TEST_F(DeformCommand, tells_where_it_folds_and_writes_it_all_the_same) {
    motion(1.0, "", "[0, 0.75]");  // the top goes down through the feet
    const Outcome done = deform({"--report", "r.json"});
    ASSERT_THAT(done, exits(0));
    EXPECT_THAT(done.errors, AllOf(HasSubstr("deform: warning: frames "), HasSubstr("to 11 ("), HasSubstr("fold over, at 'top'"),
                                   HasSubstr("move what is there less far")));
    const nlohmann::json report = nlohmann::json::parse(text("r.json"));
    EXPECT_EQ(report["rows"][0]["folded"], 0);
    EXPECT_GT(report["rows"][10]["folded"], 0);
    EXPECT_EQ(sequence().pictures.size(), 11u);
}

TEST_F(DeformCommand, leaves_a_sheet_a_video_and_figures) {
    ASSERT_THAT(deform({"--sheet", "s.png", "--video", "v.mp4", "--report", "r.json"}), exits(0));
    // Rest and 11 frames: two rows of six.
    const RgbaImage sheet = readRgba(folder_ / "s.png").value();
    EXPECT_EQ(sheet.width(), 6 * (288 + 8) + 8);
    EXPECT_EQ(sheet.height(), 2 * (252 + 24 + 8) + 8);
    EXPECT_GT(fs::file_size(folder_ / "v.mp4"), 1000u);
    const nlohmann::json report = nlohmann::json::parse(text("r.json"));
    EXPECT_EQ(report["frames"], 11);
    EXPECT_EQ(report["fps"], 10);
    EXPECT_EQ(report["loops"], false);
    EXPECT_EQ(report["size"], nlohmann::json({160, 140}));
    EXPECT_GT(report["rest_iou"].get<double>(), 0.995);
    EXPECT_EQ(report["vertices"], sequence().interior->vertices[0].size());
    EXPECT_EQ(report["triangles"], sequence().interior->triangles.size());
    ASSERT_EQ(report["rows"].size(), 11u);
    EXPECT_EQ(report["rows"][5]["time"], 0.5);
    EXPECT_NEAR(report["rows"][0]["area"].get<double>(), 1, 1e-4);
    EXPECT_NEAR(report["rows"][10]["area"].get<double>(), 1, 0.1);
}

// The world refuses: one message, status 1, and nothing is written.
TEST_F(DeformCommand, bad_input_is_refused_with_one_message_and_leaves_nothing) {
    const auto refusal = [&](const Arguments& arguments) {
        const std::vector<std::string> before = written();
        const Outcome outcome = run(arguments);
        EXPECT_THAT(outcome, exits(1));
        EXPECT_EQ(written(), before);
        const std::size_t at = outcome.errors.find("fantascope: error: ");
        EXPECT_NE(at, std::string::npos) << outcome.errors;
        EXPECT_EQ(std::count(outcome.errors.begin() + static_cast<std::ptrdiff_t>(at), outcome.errors.end(), '\n'), 1)
            << outcome.errors;
        return outcome.errors;
    };
    const auto with = [&](const std::string& picture, const Arguments& more = {}) {
        Arguments arguments = {"deform", picture, "--motion", "bar.motion.yaml"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        if (std::find(more.begin(), more.end(), "-o") == more.end()) arguments.insert(arguments.end(), {"-o", "out"});
        return refusal(arguments);
    };
    EXPECT_THAT(with("nowhere.png"), HasSubstr("nowhere.png: cannot be read"));
    EXPECT_THAT(refusal({"deform", "bar.png", "--motion", "no.yaml", "-o", "out"}), HasSubstr("no.yaml"));
    ASSERT_TRUE(writePng(folder_ / "black.png", GreyImage(50, 50)));
    EXPECT_THAT(with("black.png"), HasSubstr("black.png: nothing is drawn, it is black all over"));
    RgbaImage red(50, 50, {0, 0, 0});
    for (int y = 10; y < 40; ++y)
        for (int x = 10; x < 40; ++x) red.at(x, y) = {255, 60, 40};
    ASSERT_TRUE(writePng(folder_ / "red.png", red));
    EXPECT_THAT(with("red.png"), HasSubstr("red.png: is a picture in colours"));
    // What would be overwritten.
    EXPECT_THAT(with("bar.png", {"-o", "."}), HasSubstr("has other files in it and no sequence.yaml"));
    EXPECT_THAT(with("bar.png", {"-o", "bar.png"}), HasSubstr("is a file"));
    EXPECT_THAT(with("bar.png", {"--sheet", "bar.png"}), HasSubstr("is the silhouette, and would be overwritten"));
    EXPECT_THAT(with("bar.png", {"--sheet", "bar.png/x.png"}), HasSubstr("bar.png is not a folder"));
    EXPECT_THAT(with("bar.png", {"--report", "bar.motion.yaml"}), HasSubstr("is the motion, and would be overwritten"));
    EXPECT_THAT(with("bar.png", {"--sheet", "out/frame-0007.png"}), HasSubstr("the folder's own files are called so"));
    folder_.file("out.unfinished/letter.txt", "mine");
    EXPECT_THAT(with("bar.png"),
                HasSubstr("out.unfinished: is needed for writing the sequence, but has another file in it: letter.txt"));
    EXPECT_EQ(text("out.unfinished/letter.txt"), "mine");
    fs::remove_all(folder_ / "out.unfinished");
    // Too much of it.
    EXPECT_THAT(with("bar.png", {"--frames", "5000"}), HasSubstr("give --fps"));
    motion(3600, "");
    EXPECT_THAT(with("bar.png"), AllOf(HasSubstr("36001 frames are too many"), HasSubstr("--fps")));
    motion(1, "", "[0.5, -0.1]", "  - {name: nose, at: [0.9, 0.5]}\n");
    EXPECT_THAT(with("bar.png"), AllOf(HasSubstr("bar.motion.yaml:8:"), HasSubstr("'nose' is 54 pixels outside the white")));
    // The whole bar goes off, since it has no other handle there.
    folder_.file("bar.motion.yaml",
                 "fantascope: motion\nversion: 1\nseconds: 1\nhandles:\n  - {name: all, at: [0.47, 0.5], keys: [{time: 0, by: "
                 "[0, 0]}, {time: "
                 "1, by: [10, 0]}]}\n  - {name: low, at: [0.47, 0.9], keys: [{time: 0, by: [0, 0]}, {time: 1, by: [10, 5]}]}\n");
    fs::path wide = folder_ / "wide.png";
    ASSERT_TRUE(writePng(wide, resized(bar(), 800, 700)));
    EXPECT_THAT(with("wide.png"),
                AllOf(HasSubstr("bar.motion.yaml: frame "), HasSubstr("leaves the picture"), HasSubstr("more than 2048")));
}

TEST_F(DeformCommand, never_writes_over_a_silhouette_that_lies_in_its_folder) {
    ASSERT_THAT(deform(), exits(0));
    const std::string before = text("out/frame-0005.png");
    const Outcome again = run({"deform", "out/frame-0005.png", "--motion", "bar.motion.yaml", "-o", "out"});
    EXPECT_THAT(again, exits(1));
    EXPECT_THAT(again.errors, HasSubstr("out/frame-0005.png: is the silhouette, and would be overwritten"));
    EXPECT_EQ(text("out/frame-0005.png"), before);
}

TEST_F(DeformCommand, wrong_usage_has_a_status_of_its_own_and_points_to_the_help) {
    for (const Arguments& arguments : std::vector<Arguments>{{"--fps", "0"},
                                                             {"--frames", "0"},
                                                             {"--vertices", "3"},
                                                             {"--sheet", "s.jpg"},
                                                             {"--video", "v.avi"},
                                                             {"--nonsense"}}) {
        const Outcome outcome = deform(arguments);
        EXPECT_THAT(outcome, exits(2)) << arguments[0];
        EXPECT_THAT(outcome.errors, HasSubstr("See 'fantascope deform --help'."));
    }
    EXPECT_THAT(run({"deform", "bar.png", "-o", "out"}), exits(2));
    EXPECT_THAT(run({"deform", "--help"}), exits(0));
}

// The signal is sent once a line of progress says that it draws; as many frames take minutes.
TEST_F(DeformCommand, ctrl_c_leaves_nothing_half) {
    motion(1000, "");
    const Arguments endless = {"deform", "bar.png",  "--motion", "bar.motion.yaml", "-o", "out",        "--video",
                               "v.mp4",  "--frames", "10000",    "--fps",           "10", "--vertices", "20"};
    EXPECT_EQ(interruptProgram(endless, folder_ / ".", 2), 1);
    EXPECT_THAT(written(), ElementsAre("bar.motion.yaml", "bar.png"));
}

// Example failure: a second Ctrl-C leaves a folder behind, and every later run is refused because
// of it.
TEST_F(DeformCommand, what_a_killed_run_leaves_is_taken_over_and_what_a_running_one_makes_is_not) {
    motion(1000, "");
    RunningProgram first(
        {"deform", "bar.png", "--motion", "bar.motion.yaml", "-o", "out", "--frames", "10000", "--fps", "10", "--vertices", "20"},
        folder_ / ".");
    while (!fs::exists(folder_ / "out.unfinished/frame-0002.png")) ASSERT_TRUE(first.line()) << first.all();
    motion(1, "");
    const Outcome beside = deform();
    EXPECT_THAT(beside, exits(1));
    EXPECT_THAT(beside.errors, HasSubstr("out.unfinished: another run is writing this sequence"));
    first.stop(SIGKILL);
    ASSERT_TRUE(fs::exists(folder_ / "out.unfinished/frame-0002.png"));
    EXPECT_THAT(deform(), exits(0));
    EXPECT_FALSE(fs::exists(folder_ / "out.unfinished"));
    EXPECT_TRUE(fs::exists(folder_ / "out/sequence.yaml"));
}

// Those that come with the program.
TEST_F(DeformCommand, moves_the_projects_drawings_with_their_feet_on_the_floor_and_without_folds) {
    const std::string drawings = sourceFolder() + "/assets/silhouettes/";
    for (const auto& [name, frames] : {std::pair("rabbit", 16u), {"elephant", 34u}, {"car", 12u}}) {
        SCOPED_TRACE(name);
        const Outcome done = run({"deform", drawings + name + ".png", "--motion", drawings + name + ".motion.yaml", "-o", name});
        ASSERT_THAT(done, exits(0));
        EXPECT_THAT(done.errors, Not(HasSubstr("warning")));
        const theatre::SilhouetteSequence sequence = this->sequence(name);
        ASSERT_EQ(sequence.pictures.size(), frames);
        EXPECT_TRUE(sequence.loops);
        const GreyImage drawing = readGrey(drawings + name + ".png").value();
        double least = 1;
        for (const fs::path& picture : sequence.pictures) {
            const Seen seen = compared(drawing, readGrey(picture).value());
            EXPECT_NEAR(seen.lowest, 470, 1) << picture;
            least = std::min(least, seen.overlap());
        }
        EXPECT_GT(compared(drawing, readGrey(sequence.pictures[0]).value()).overlap(), 0.995);
        EXPECT_LT(least, 0.95) << "it moves";
    }
}

}  // namespace
}  // namespace fantascope
