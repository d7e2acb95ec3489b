// What a crash, a full disk or a second machine leaves of a night's inputs can be played again.

#include "show/play/input_journal.h"

#include "core/file.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>
#include <string>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr const char* kFirstLine = "fantascope-inputs 1\n";

CueList oneCue() {
    CueList list;
    list.cues.push_back({{{{}}, {}, {}}, Time{}, std::nullopt});
    list.dark = {{{}}, {}, {}};
    return list;
}

template <class T>
std::string errorOf(const Result<T>& result) {
    return result ? "" : result.error().message();
}

TEST(InputJournal, is_on_the_disk_after_each_write_with_what_was_ignored) {
    const ScratchFolder folder;
    InputLog log(oneCue());
    log.submit({.at = 1s, .kind = Input::Kind::Go, .source = Input::Source::Terminal});
    auto journal = InputJournal::create(folder / "inputs", log);
    ASSERT_TRUE(journal) << journal.error().message();
    EXPECT_EQ(*readFile(folder / "inputs"), fmt::format("{}1000000000 go 0 terminal 0\n", kFirstLine))
        << "what came before it, too";
    log.submit({.at = 2s, .kind = Input::Kind::Go, .source = Input::Source::Controller, .which = 4});  // the last cue is on
    ASSERT_TRUE(journal->write());
    ASSERT_TRUE(journal->write());
    EXPECT_THAT(*readFile(folder / "inputs"), testing::EndsWith("terminal 0\n2000000000 go 0 controller 4\n"));
}

TEST(InputJournal, never_takes_the_place_of_another) {
    const ScratchFolder folder;
    const auto file = folder.file("inputs", "of yesterday");
    const InputLog log(oneCue());
    EXPECT_THAT(errorOf(InputJournal::create(file, log)), AllOf(HasSubstr(file.string()), HasSubstr("exists")));
    EXPECT_EQ(*readFile(file), "of yesterday");
    EXPECT_THAT(errorOf(InputJournal::create(folder / "none/inputs", log)), HasSubstr("none/inputs: No such file"));
}

// Example failure: the end of a line is written twice, or never, after the disk has room again.
TEST(InputJournal, goes_on_in_the_middle_of_a_line_where_the_disk_was_full) {
    const ScratchFolder folder;
    InputLog log(oneCue());
    auto journal = InputJournal::create(folder / "inputs", log);
    ASSERT_TRUE(journal);
    log.submit({.at = 1s, .kind = Input::Kind::Dark});
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit full{std::string_view(kFirstLine).size() + 5, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &full);
    const std::string refusal = errorOf(journal->write());
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_THAT(refusal, StartsWith((folder / "inputs").string()));
    EXPECT_EQ(*readFile(folder / "inputs"), fmt::format("{}10000", kFirstLine));
    EXPECT_THAT(*readJournal(folder / "inputs"), IsEmpty()) << "the line has no end";
    log.submit({.at = 2s, .kind = Input::Kind::Light});
    ASSERT_TRUE(journal->write());
    EXPECT_THAT(*readJournal(folder / "inputs"),
                ElementsAre(Input{.at = 1s, .kind = Input::Kind::Dark}, Input{.at = 2s, .kind = Input::Kind::Light}));
}

// Example failure: half a number is read as a number, and the show jumps to another time.
TEST(Journal, without_the_end_of_its_last_line_is_read_up_to_there) {
    const ScratchFolder folder;
    const std::string lines = "1000000000 jump 3 terminal 0\n2000000000 go 0 terminal 0\n";
    for (std::size_t left = 0; left <= lines.size(); ++left) {
        const auto inputs = readJournal(folder.file("inputs", kFirstLine + lines.substr(0, left)));
        ASSERT_TRUE(inputs) << inputs.error().message();
        EXPECT_EQ(inputs->size(), std::size_t{left >= lines.find('\n') + 1} + std::size_t{left == lines.size()}) << left;
    }
    EXPECT_THAT(*readJournal(folder.file("inputs", "fantascope-inp")), IsEmpty()) << "it died at once";
}

TEST(Journal, that_is_damaged_is_refused_with_the_line) {
    const ScratchFolder folder;
    const auto refusal = [&](const std::string& text) { return errorOf(readJournal(folder.file("inputs", text))); };
    EXPECT_THAT(refusal(std::string(kFirstLine) + "1 go 0 start 0\n1 went 0 start 0\n"),
                HasSubstr("inputs:3: 'went' is none of go"));
    EXPECT_THAT(refusal(std::string(kFirstLine) + "\n"), HasSubstr("inputs:2: an input has 5 words"));
    EXPECT_THAT(refusal("fantascope-inputs 2\n"), HasSubstr("inputs:1: this is no journal of inputs"));
    EXPECT_THAT(refusal("1 go 0 start 0\n"), HasSubstr("inputs:1: this is no journal of inputs"));
    EXPECT_THAT(errorOf(readJournal(folder / "none")), HasSubstr("none"));
}

}  // namespace
}  // namespace fantascope::show
