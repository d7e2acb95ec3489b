// A run that was killed goes on where it died. FANTASCOPE_KILLS=200
// build/release/tests/app/app_test --gtest_filter='KilledNight*' kills two hundred.

#include "app/video_reader.h"

#include "core/clock.h"
#include "core/file.h"
#include "core/random.h"
#include "media/image.h"
#include "program.h"
#include "running_program.h"
#include "scratch_folder.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <vector>

namespace fantascope::app {
namespace {

using testing::HasSubstr;

constexpr int kCues = 40;
constexpr double kSeconds = 16;  // so a simulated hand presses GO some three times a second

constexpr double kWait = 0.1, kFade = 1;
constexpr bool isOn(int cue) { return cue % 2 == 0; }

std::string show() {
    std::string text =
        "fantascope: show\nversion: 2\ntitle: Steps\ngo_interval: 0\nsources: {red: {solid: [1, 0, 0]}}\n"
        "looks:\n  on: {outputs: {wall: [{source: red}]}, relays: {street: off}}\n"
        "  off: {outputs: {wall: []}, relays: {street: on}}\ncues:\n";
    for (int cue = 0; cue < kCues; ++cue)
        text += fmt::format("  - {{name: Step {}, look: {}, wait: {}, fade: {}}}\n", cue, isOn(cue) ? "on" : "off", kWait, kFade);
    return text;
}

constexpr const char* kSite = R"(fantascope: site
version: 1
outputs:
  - {name: wall, display: {driver: headless}, size: [64, 36], refresh_rate: 30,
     projector: {position: [0, 2, 8], look_at: [0, 1, 0], throw_ratio: 1.5}}
relay_banks: [{name: road, device: {driver: simulated}}]
relays: [{name: street, coil: 0, safe: on}]
cue_controller: {device: {driver: simulated}, buttons: {go: 1}}
simulation:
  objects: [{name: wall, rectangle: {corner: [-9, 0, 0], right: [18, 0, 0], up: [0, 5, 0]}}]
  projectors: {wall: {lumens: 3000}}
)";

// What the test reads of a journal by itself.
struct Written {
    int cue = -1;                   // GO was taken so often, less one
    double newest = 0;              // seconds
    std::size_t end = 0;            // of the last whole line
    std::vector<double> presses{};  // when GO was taken, seconds

    // The red light of the wall, 0..1 linear, and whether the street's lamp is on; by the presses
    // alone.
    double lightAt(double time) const {
        double from = 0, to = 0, start = 0;
        const auto at = [&](double moment) { return from + (to - from) * std::clamp((moment - start) / kFade, 0., 1.); };
        for (std::size_t cue = 0; cue < presses.size() && presses[cue] + kWait <= time; ++cue) {
            // A cue that another one has replaced before its wait was over changes nothing.
            if (cue + 1 < presses.size() && presses[cue + 1] < presses[cue] + kWait) continue;
            from = at(presses[cue] + kWait);
            to = isOn(static_cast<int>(cue)) ? 1 : 0;
            start = presses[cue] + kWait;
        }
        return at(time);
    }
    bool streetAt(double time) const {
        bool isLit = true;
        for (std::size_t cue = 0; cue < presses.size() && presses[cue] + kWait <= time; ++cue)
            if (cue + 1 == presses.size() || presses[cue + 1] >= presses[cue] + kWait) isLit = !isOn(static_cast<int>(cue));
        return isLit;
    }
};
Written read(const std::string& text) {
    Written written;
    for (std::size_t begin = text.find('\n') + 1, end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
        std::istringstream line(text.substr(begin, end - begin));
        std::string check, kind, what;
        double time = 0;
        line >> check >> kind >> time >> what;
        const bool isLate = text.compare(end - 5, 5, " late") == 0;  // the machine was busy, and the show ignored it
        if (kind == "input" && what == "go" && !isLate) {
            ++written.cue;
            written.presses.push_back(time / 1e9);
        }
        written.newest = std::max(written.newest, time / 1e9);
        written.end = end + 1;
    }
    return written;
}
// The newer one of its two times, seconds.
double clockOf(const std::string& text) {
    std::istringstream slots(text);
    double newest = 0, time = 0;
    for (std::string check; slots >> time >> check;) newest = std::max(newest, time / 1e9);
    return newest;
}

// What a run shows and switches, by its recording.
void expectRight(const std::filesystem::path& recording, const Written& left) {
    std::istringstream frames(*readFile(recording / "frames.csv")), relays(*readFile(recording / "relays.csv"));
    std::string line;
    std::getline(frames, line);
    const Video video = readVideo(recording / "wall.mp4");
    for (const Rgba16Image& picture : video.frames) {
        ASSERT_TRUE(std::getline(frames, line));
        const double time = std::stod(line.substr(line.find(',') + 1));
        const double wanted = srgbFromLinear(static_cast<float>(left.lightAt(time)));
        EXPECT_NEAR(picture.at(32, 18).r / 65535.0, wanted, 0.02) << "at " << time;
    }
    EXPECT_FALSE(video.frames.empty());
    std::getline(relays, line);
    while (std::getline(relays, line)) {
        const double time = std::stod(line) + 1e-6;  // it is rounded
        const bool isLit = line.back() == '1';
        // A relay is written some ticks after the moment whose state it is given.
        EXPECT_TRUE(isLit || !left.streetAt(time) || !left.streetAt(time - 0.1))
            << line << " of\n"
            << *readFile(recording / "relays.csv") << "pressed at " << fmt::format("{}", fmt::join(left.presses, ", "));
    }
}

// Example failures: a press is lost that was acted on a moment before; the time is that of the last
// press; a torn line is read, or everything before it is lost.
TEST(KilledNight, goes_on_where_it_died_whatever_is_torn_or_damaged) {
    const char* const wanted = std::getenv("FANTASCOPE_KILLS");
    const int kills = wanted != nullptr ? std::atoi(wanted) : 6;
    Rng rng(4);
    SteadyClock clock;
    std::vector<double> starts;
    for (int kill = 0; kill < kills; ++kill) {
        const ScratchFolder folder;
        folder.file("show.yaml", show());
        folder.file("site.yaml", kSite);
        const auto journal = folder / "night" / "journal";
        {
            RunningProgram program(
                {"rehearse", ".", "--site", ".", "--seconds", fmt::format("{}", kSeconds), "--journal", "night"}, folder.path());
            while (!std::filesystem::exists(journal)) ASSERT_TRUE(program.line()) << program.all();
            clock.sleepUntil(clock.now() + std::chrono::milliseconds(300 + rng.below(3000)));
            program.stop(SIGKILL);
        }
        std::string text = *readFile(journal);
        Written left = read(text);
        double time = std::max(left.newest, clockOf(*readFile(folder / "night" / "clock")));
        const int harm = kill % 5 == 4 ? 1 + static_cast<int>(rng.below(2)) : 0;
        if (harm == 1) {  // torn: the end of the file did not reach the disk
            text.resize(text.size() - std::min<std::size_t>(text.size() / 2, rng.below(60)));
            left = read(text);
            std::filesystem::remove(folder / "night" / "clock");
            time = left.newest;
        } else if (harm == 2) {  // damaged: but not the last second, of which nothing else tells
            const std::size_t state = text.rfind(" state ");
            const std::size_t last = text.rfind('\n', state);
            if (state != std::string::npos) text[rng.below(last)] ^= 1;
        }
        if (harm != 0) std::ofstream(journal, std::ios::binary) << text;

        RunningProgram again({"rehearse", ".", "--site", ".", "--seconds", "1", "--by-hand", "--journal", "night", "--record",
                              "seen", "--report", "report.json"},
                             folder.path());
        while (again.line()) continue;
        EXPECT_EQ(again.stop(), 0) << again.all();
        const auto report = nlohmann::json::parse(*readFile(folder / "report.json"));
        const auto& resumed = report["resumed"];
        if (left.cue < 0) {
            EXPECT_TRUE(resumed.is_null()) << "nothing had happened yet";
            continue;
        }
        ASSERT_FALSE(resumed.is_null()) << kill << ", harm " << harm << "\n" << text << again.all();
        EXPECT_EQ(resumed["cue"], fmt::format("Step {}", left.cue)) << kill << ", harm " << harm << "\n" << text;
        EXPECT_NEAR(resumed["at"].get<double>(), time, 1e-6) << kill << ", harm " << harm << "\n" << text;
        ASSERT_TRUE(report.contains("start_to_frame_ms")) << "nothing was shown";
        starts.push_back(report["start_to_frame_ms"].get<double>());
        if (harm != 2) expectRight(folder / "seen", left);  // with a damaged journal fades may be other ones
    }
    std::ranges::sort(starts);
    if (!starts.empty())
        fmt::print("from the start of the program to its first frame: {:.0f} ms, half of {}; {:.0f} at most\n",
                   starts[starts.size() / 2], starts.size(), starts.back());
}

// Example failures: the time of day gets into it; a thread of the disk's decides what comes first.
TEST(FastNight, has_the_same_journal_twice_and_goes_on_where_it_ended) {
    const ScratchFolder folder;
    folder.file("show.yaml", show());
    folder.file("site.yaml", kSite);
    const auto rehearse = [&](const std::string& journal) {
        return runProgram({"rehearse", ".", "--site", ".", "--as-fast-as-possible", "--seconds", "4", "--journal", journal,
                           "--report", "report.json"},
                          folder.path());
    };
    for (const char* journal : {"one", "two"}) EXPECT_THAT(rehearse(journal), exits(0));
    for (const char* file : {"journal", "clock"}) EXPECT_EQ(*readFile(folder / "one" / file), *readFile(folder / "two" / file));
    EXPECT_EQ(nlohmann::json::parse(*readFile(folder / "report.json"))["resumed"], nullptr);
    EXPECT_THAT(rehearse("one"), exits(0));
    const auto report = nlohmann::json::parse(*readFile(folder / "report.json"));
    EXPECT_EQ(report["resumed"]["cue"], fmt::format("Step {}", kCues - 1));
    EXPECT_EQ(report["resumed"]["at"], 4);
}

// Example failure: the show does not begin, because nobody may write down that it does.
TEST(FastNight, plays_without_its_journal_and_says_so) {
    const ScratchFolder folder;
    folder.file("show.yaml", show());
    folder.file("site.yaml", kSite);
    folder.file("night", "a file, where the folder should be");
    const auto played = runProgram({"rehearse", ".", "--site", ".", "--as-fast-as-possible", "--seconds", "2", "--journal",
                                    "night", "--report", "report.json"},
                                   folder.path());
    EXPECT_THAT(played, exits(0));
    EXPECT_THAT(played.errors, HasSubstr("the journal is not written: night: "));
    const auto report = nlohmann::json::parse(*readFile(folder / "report.json"));
    EXPECT_EQ(report["cues"].size(), static_cast<std::size_t>(kCues));
    EXPECT_THAT(report["faults"][0]["what"].get<std::string>(), HasSubstr("the journal is not written"));
    EXPECT_EQ(report["inputs"]["by_source"]["controller"], kCues);
    EXPECT_EQ(report["inputs"]["by_outcome"]["taken"], kCues);
}

}  // namespace
}  // namespace fantascope::app
