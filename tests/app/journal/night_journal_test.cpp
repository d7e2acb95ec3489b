#include "app/journal/night_journal.h"

#include "core/file.h"
#include "scratch_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/resource.h>

#include <csignal>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Begun = show::journal::Run;
using show::journal::Told;

constexpr Time kEvening = 1'700'000'000s;

class Nights : public testing::Test {
protected:
    Nights() { wall_.set(kEvening, 0s); }
    std::unique_ptr<NightJournal> open(bool anew = false) {
        auto journal = NightJournal::open(folder_ / "nights", anew, true, wall_);
        return journal ? std::move(*journal) : nullptr;
    }
    std::vector<std::string> files() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::directory_iterator(folder_ / "nights"))
            if (const std::string name = entry.path().filename(); name != "clock") names.push_back(name);
        std::ranges::sort(names);
        return names;
    }
    const ScratchFolder folder_;
    ManualWallClock wall_;
};

TEST_F(Nights, go_on_where_they_ended_with_the_time_that_was_noted_last) {
    {
        const auto journal = open();
        EXPECT_FALSE(journal->earlier());
        journal->write(Begun{.at = 0s, .utc = kEvening, .show = {}});
        journal->write(show::Input{.at = 2s, .kind = show::Input::Kind::Go});
        journal->noteTime(3s);
    }
    wall_.set(kEvening + 1h, 0s);
    {
        const auto journal = open();
        ASSERT_TRUE(journal->earlier());
        EXPECT_EQ(journal->earlier()->at, 3s);
        EXPECT_EQ(journal->earlier()->journal.entries.size(), 2u);
        journal->write(show::journal::End{4s, "length"});
    }
    EXPECT_EQ(open()->earlier()->journal.entries.size(), 3u);
    EXPECT_EQ(open()->earlier()->at, 4s) << "a line may be newer than the clock";
}

TEST_F(Nights, begin_another_journal_hours_later_or_when_asked_and_keep_the_old_ones) {
    open()->write(Begun{.at = 0s, .utc = kEvening, .show = {}});
    wall_.set(kEvening + NightJournal::kNight + 1s, 0s);
    open()->write(Begun{.at = 0s, .utc = wall_.now().utc, .show = {}});
    EXPECT_THAT(files(), ElementsAre("journal", "journal-20231114T221320"));
    EXPECT_TRUE(open()->earlier()) << "this night's";
    EXPECT_FALSE(open(true)->earlier());
    EXPECT_THAT(files(), ElementsAre("journal", "journal-20231114T221320", "journal-20231115T041321"));
}

// Example failure: the clock of a machine is years behind when it boots, and the night is over.
TEST_F(Nights, go_on_when_the_clock_is_behind) {
    open()->write(Begun{.at = 0s, .utc = kEvening, .show = {}});
    wall_.set(0s, 0s);
    EXPECT_TRUE(open()->earlier());
}

TEST_F(Nights, cut_a_torn_line_before_they_write_another) {
    open()->write(Begun{.at = 0s, .utc = kEvening, .show = {}});
    const auto file = folder_ / "nights" / "journal";
    const std::string whole = *readFile(file);
    folder_.file("nights/journal", whole + "1234 inp");
    open()->write(Told{1s, "after"});
    EXPECT_EQ(*readFile(file), whole + show::lineOf(Told{1s, "after"}));
}

// Example failure: nothing happened for a minute, the program died, and the next run began; when
// that one died after six seconds, the show went on in its second minute.
TEST_F(Nights, count_no_times_from_before_the_show_began) {
    {
        const auto journal = open();
        journal->begin(Begun{.at = 0s, .utc = kEvening, .show = {}});
        journal->write(Told{50s, "nobody has pressed GO"});
        journal->noteTime(60s);
    }
    {
        const auto journal = open();
        EXPECT_EQ(journal->earlier()->at, 60s);
        journal->begin(Begun{.at = 0s, .utc = kEvening + 70s, .show = {}});
        journal->noteTime(6s);
    }
    EXPECT_EQ(open()->earlier()->at, 6s);
    open()->begin(Begun{.at = 6s, .utc = kEvening + 80s, .goesOn = true, .show = {}});
    EXPECT_EQ(open()->earlier()->at, 6s) << "the line of the beginning tells the time, too";
}

// Example failure: a single byte, the end of the first line, and the night begins again.
TEST_F(Nights, go_on_though_the_line_of_their_beginning_is_damaged) {
    open()->write(Begun{.at = 0s, .utc = kEvening, .show = {}});
    open()->write(show::Input{.at = 2s, .kind = show::Input::Kind::Go});
    std::string text = *readFile(folder_ / "nights" / "journal");
    text[text.find('\n')] ^= 1;
    folder_.file("nights/journal", text);
    const auto journal = open();
    ASSERT_TRUE(journal->earlier());
    EXPECT_EQ(journal->earlier()->at, 2s);
}

TEST_F(Nights, have_one_writer) {
    const auto journal = open();
    journal->write(Told{1s, "mine"});
    const auto other = NightJournal::open(folder_ / "nights", true, true, wall_);
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().message(), HasSubstr("another run writes this journal"));
    EXPECT_THAT(files(), ElementsAre("journal"));
}

TEST_F(Nights, keep_a_file_that_is_no_journal) {
    folder_.file("nights/journal", "dear diary\n");
    EXPECT_FALSE(open()->earlier());
    EXPECT_THAT(files(), ElementsAre("journal", "journal-20231114T221320"));
    EXPECT_EQ(*readFile(folder_ / "nights" / "journal-20231114T221320"), "dear diary\n");
}

TEST_F(Nights, that_cannot_be_written_say_so_and_hold_nothing_up) {
    folder_.file("nights", "a file, where the folder should be");
    const auto journal = open();
    ASSERT_NE(journal, nullptr);
    EXPECT_THAT(journal->trouble(), HasSubstr("nights"));
    journal->write(Told{1s, "nobody hears it"});
    journal->noteTime(1s);
}

// Example failure: a line has two ends, or none, after the disk has room again.
TEST_F(Nights, write_what_is_left_once_the_disk_has_room_again) {
    const auto file = folder_ / "nights" / "journal";
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    {
        const auto journal = open();
        journal->write(Told{1s, "first"});
        const rlimit full{std::filesystem::file_size(file) + 5, before.rlim_max};
        setrlimit(RLIMIT_FSIZE, &full);
        for (int i = 0; i < 100; ++i) journal->write(Told{2s, fmt::format("line {}", i)});
        EXPECT_THAT(journal->trouble(), HasSubstr("make room"));
        EXPECT_EQ(std::filesystem::file_size(file), full.rlim_cur);
        setrlimit(RLIMIT_FSIZE, &before);
    }
    std::signal(SIGXFSZ, handler);
    const auto journal = show::readJournal(file);
    ASSERT_TRUE(journal);
    EXPECT_EQ(journal->entries.size(), 101u);
    EXPECT_EQ(journal->damaged, 0u);
    EXPECT_FALSE(journal->isTorn);
}

TEST_F(Nights, leave_out_what_a_full_disk_could_not_take_for_too_long_and_mark_the_gap) {
    const auto file = folder_ / "nights" / "journal";
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    std::size_t gaps = 0;
    {
        const auto journal = open();
        journal->write(Told{1s, "first"});
        const rlimit full{std::filesystem::file_size(file), before.rlim_max};
        setrlimit(RLIMIT_FSIZE, &full);
        for (int i = 0; i < 3000; ++i) journal->write(Told{2s, std::string(900, 'x')});
        setrlimit(RLIMIT_FSIZE, &before);
        for (SteadyClock waits; !journal->trouble().empty();) waits.sleepUntil(waits.now() + 20ms);
        journal->write(Told{3s, "last"});
    }
    std::signal(SIGXFSZ, handler);
    const auto journal = show::readJournal(file);
    ASSERT_TRUE(journal);
    for (const auto& entry : journal->entries) gaps += std::holds_alternative<show::journal::Gap>(entry.line);
    EXPECT_EQ(gaps, 1u);
    EXPECT_TRUE(journal->entries.back().line == show::journal::Line(Told{3s, "last"}));
    EXPECT_LT(journal->entries.size(), 3000u);
}

}  // namespace
}  // namespace fantascope::app
