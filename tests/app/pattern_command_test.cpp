// The program as a person runs it: its exit statuses, its messages, and what it leaves behind.

#include "pattern/shape_pattern.h"

#include "core/file.h"
#include "core/image.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <set>
#include <string>

namespace fantascope {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

struct Outcome {
    int status;
    std::string output;  // standard output and error together
};

Outcome run(const std::string& arguments) {
    FILE* pipe = ::popen(fmt::format("{} {} 2>&1", FANTASCOPE_PROGRAM, arguments).c_str(), "r");
    std::string output;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) output += static_cast<char>(c);
    return {WEXITSTATUS(::pclose(pipe)), output};
}

class PatternCommand : public testing::Test {
protected:
    void SetUp() override {
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        GreyImage guide(64, 36);
        for (int y = 8; y < 28; ++y)
            for (int x = 8; x < 40; ++x) guide.at(x, y) = 1;
        ASSERT_TRUE(writePng(guide_, guide));
        fs::copy(FANTASCOPE_SOURCE_DIR "/assets/shapes/sculpture.obj", folder_ / "sculpture.obj");
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string file(const std::string& name) const { return (folder_ / name).string(); }
    std::string text(const std::string& name) const { return readFile(folder_ / name).value(); }
    // `pattern GUIDE -o out/p.pattern.yaml`, a small one.
    Outcome find(const std::string& more) const {
        return run(fmt::format("pattern {} -o {} --instances 40 {}", guide_.string(), file("out/p.pattern.yaml"), more));
    }
    std::set<std::string> written() const {
        std::set<std::string> names;
        if (fs::exists(folder_ / "out"))
            for (const auto& entry : fs::directory_iterator(folder_ / "out")) names.insert(entry.path().filename());
        return names;
    }
    nlohmann::json report() const { return nlohmann::json::parse(text("out/r.json")); }

    const fs::path folder_ = fs::path(testing::TempDir()) / "pattern_command";
    const fs::path guide_ = folder_ / "guide.png";
};

TEST_F(PatternCommand, writes_a_pattern_with_all_it_needs_beside_it) {
    const Outcome done = find(fmt::format("--iterations 20 --shapes circle,{} --image {} --report {}", file("sculpture.obj"),
                                          file("out/p.png"), file("out/r.json")));
    ASSERT_EQ(done.status, 0) << done.output;
    EXPECT_EQ(written(), (std::set<std::string>{"p.pattern.yaml", "p.guide.png", "p.sculpture.obj", "p.png", "r.json"}));
    // It can move elsewhere as a folder.
    fs::rename(folder_ / "out", folder_ / "moved");
    const auto pattern = pattern::readPattern(folder_ / "moved" / "p.pattern.yaml");
    ASSERT_TRUE(pattern) << pattern.error().message();
    EXPECT_EQ(readFile(pattern->guide).value(), text("guide.png"));
    EXPECT_EQ(pattern->shapes[1].name, "p.sculpture.obj");
    fs::rename(folder_ / "moved", folder_ / "out");
}

TEST_F(PatternCommand, refers_to_what_lies_beside_or_below_it) {
    const Outcome done = run(fmt::format("pattern {} -o {} --iterations 2 --shapes {}", guide_.string(), file("p.pattern.yaml"),
                                         file("sculpture.obj")));
    ASSERT_EQ(done.status, 0) << done.output;
    EXPECT_THAT(text("p.pattern.yaml"), HasSubstr("guide: guide.png"));
    EXPECT_THAT(text("p.pattern.yaml"), HasSubstr("- sculpture.obj"));
}

// Anybody can compute z from the drawing and the picture.
TEST_F(PatternCommand, reports_the_figures_of_the_picture_that_it_writes) {
    ASSERT_EQ(find(fmt::format("--iterations 30 --image {} --report {}", file("out/p.png"), file("out/r.json"))).status, 0);
    const GreyImage guide = readGrey(guide_).value(), image = readGrey(folder_ / "out" / "p.png").value();
    double sum = 0;
    for (std::size_t i = 0; i < guide.pixels().size(); ++i) sum += std::abs(guide.pixels()[i] - image.pixels()[i]);
    const nlohmann::json figures = report();
    EXPECT_NEAR(figures["z"].get<double>(), sum / (64 * 36), 1e-9);
    EXPECT_EQ(figures["z_bound"], 0);  // the guide is black and white
    EXPECT_GE(figures["loop_z"].get<double>(), 0);
    EXPECT_EQ(figures["iterations"], 30);
    EXPECT_EQ(figures["evaluations"], 1 + 12 * 30);
    EXPECT_EQ(figures["stop_reason"], "iterations");
    EXPECT_EQ(figures["seed"], 1);
    EXPECT_EQ(figures["guide_transfer"], "srgb");
    for (const char* column : {"z_min", "z_max", "accepted"}) EXPECT_EQ(figures["history"][column].size(), 30u);
    for (const char* key : {"tone", "overlap", "instances", "seconds"}) EXPECT_TRUE(figures[key].is_number()) << key;
}

// Example failure: the clock has a say in more than when to stop.
TEST_F(PatternCommand, a_run_that_stopped_by_time_is_replayed_byte_for_byte_by_its_iterations) {
    ASSERT_EQ(find(fmt::format("--seconds 0.2 --threads 2 --seed 5 --report {}", file("out/r.json"))).status, 0);
    const nlohmann::json figures = report();
    EXPECT_EQ(figures["stop_reason"], "time");
    const std::string first = text("out/p.pattern.yaml");
    fs::rename(folder_ / "out", folder_ / "before");  // and in a folder of the same name, made anew
    ASSERT_EQ(find(fmt::format("--iterations {} --threads 1 --seed 5", figures["iterations"].get<int>())).status, 0);
    EXPECT_EQ(text("out/p.pattern.yaml"), first);
}

TEST_F(PatternCommand, gives_the_same_bytes_in_another_folder) {
    const std::string arguments = fmt::format("--iterations 10 --shapes {}", file("sculpture.obj"));
    ASSERT_EQ(find(arguments).status, 0);
    ASSERT_EQ(
        run(fmt::format("pattern {} -o {} --instances 40 {}", guide_.string(), file("a/b/p.pattern.yaml"), arguments)).status, 0);
    EXPECT_EQ(text("a/b/p.pattern.yaml"), text("out/p.pattern.yaml"));
}

TEST_F(PatternCommand, takes_its_numbers_from_a_settings_file_and_the_line_has_the_last_word) {
    ASSERT_TRUE(writeFile(folder_ / "s.yaml",
                          "fantascope: pattern-settings\nversion: 1\nguide_transfer: linear\n"
                          "shapes: {instances: 500}\nsearch: {candidates: 3}\nmotion: {frames: 100}\n"));
    ASSERT_EQ(find(fmt::format("--iterations 4 --settings {} --report {}", file("s.yaml"), file("out/r.json"))).status, 0);
    EXPECT_EQ(report()["evaluations"], 1 + 3 * 4);
    EXPECT_EQ(report()["guide_transfer"], "linear");
    EXPECT_LE(report()["instances"], 40);
    EXPECT_THAT(text("out/p.pattern.yaml"), HasSubstr("frames: 100"));
}

// The world refuses: one message, status 1, and nothing is written.
TEST_F(PatternCommand, bad_input_is_refused_with_one_message_and_leaves_nothing) {
    const auto refused = [&](const std::string& arguments) {
        const Outcome outcome = run(fmt::format("pattern {} -o {} --iterations 1", arguments, file("out/p.pattern.yaml")));
        EXPECT_EQ(outcome.status, 1) << arguments;
        EXPECT_THAT(outcome.output, StartsWith("fantascope: error: "));
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
        EXPECT_EQ(written(), std::set<std::string>()) << arguments;
        return outcome.output;
    };
    EXPECT_THAT(refused(file("nowhere.png")), HasSubstr("nowhere.png: cannot be read"));

    const std::string png = text("guide.png");
    ASSERT_TRUE(writeFile(folder_ / "half.png", png.substr(0, png.size() / 2)));
    EXPECT_THAT(refused(file("half.png")), HasSubstr("half.png: the picture is truncated"));
    ASSERT_TRUE(writeFile(folder_ / "words.png", "This is no picture."));
    EXPECT_THAT(refused(file("words.png")), HasSubstr("words.png: not a picture"));

    ASSERT_TRUE(writeFile(folder_ / "points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"));
    EXPECT_THAT(refused(guide_.string() + " --shapes " + file("points.obj")), HasSubstr("points.obj: "));
    ASSERT_TRUE(writeFile(folder_ / "floor.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n"));
    EXPECT_THAT(refused(guide_.string() + " --shapes " + file("floor.obj")), HasSubstr("floor.obj: seen from the front"));
    EXPECT_THAT(refused(guide_.string() + " --shapes circel"), HasSubstr("did you mean 'circle'?"));
    EXPECT_THAT(refused(guide_.string() + " --shapes circle,circle"), HasSubstr("given twice"));

    ASSERT_TRUE(writeFile(folder_ / "s.yaml", "fantascope: pattern-settings\nversion: 1\nsearch: {candidates: none}\n"));
    EXPECT_THAT(refused(guide_.string() + " --settings " + file("s.yaml")),
                HasSubstr("s.yaml:3:22: search.candidates: a whole number"));
    EXPECT_THAT(refused(guide_.string() + " --settings " + file("absent.yaml")), HasSubstr("absent.yaml: cannot be read"));
}

TEST_F(PatternCommand, wrong_usage_has_a_status_of_its_own_and_points_to_the_help) {
    for (const char* arguments : {"--instances 0", "--seconds -1", "--iterations many", "--target-z 2", "--threads 0",
                                  "--seed -1", "--method refined", "--nonsense"}) {
        const Outcome outcome = find(arguments);
        EXPECT_EQ(outcome.status, 2) << arguments;
        EXPECT_THAT(outcome.output, StartsWith("fantascope: error: "));
        EXPECT_THAT(outcome.output, HasSubstr("See 'fantascope pattern --help'."));
    }
    EXPECT_THAT(find("--method refined").output, HasSubstr("the only one is 'paper'"));
    EXPECT_EQ(run("pattern").status, 2);
    EXPECT_EQ(run("").status, 2);
    EXPECT_EQ(run("no-such-command").status, 2);
    // A slip that would write the pattern over the drawing.
    EXPECT_EQ(run(fmt::format("pattern {0} -o {0}", guide_.string())).status, 2);
    EXPECT_EQ(run("pattern --help").status, 0);
}

// The artist's stop: Ctrl-C keeps the best pattern so far. The signal is sent once the first line of progress says that the
// search runs.
TEST_F(PatternCommand, ctrl_c_keeps_the_best_so_far) {
    std::array<int, 2> pipe{};
    ASSERT_EQ(::pipe(pipe.data()), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        ::dup2(pipe[1], STDERR_FILENO);
        ::close(pipe[0]);
        ::execl(FANTASCOPE_PROGRAM, "fantascope", "pattern", guide_.c_str(), "-o", file("out/p.pattern.yaml").c_str(),
                "--instances", "40", "--seconds", "100000", "--report", file("out/r.json").c_str(), nullptr);
        ::_exit(127);
    }
    ::close(pipe[1]);
    char firstByte = 0;
    ASSERT_EQ(::read(pipe[0], &firstByte, 1), 1);
    ::kill(child, SIGINT);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ::close(pipe[0]);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    EXPECT_EQ(report()["stop_reason"], "interrupted");
    EXPECT_TRUE(pattern::readPattern(folder_ / "out" / "p.pattern.yaml"));
}

}  // namespace
}  // namespace fantascope
