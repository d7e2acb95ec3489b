#include "app/live/table_file.h"

#include "core/file.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <string>
#include <thread>
#include <vector>

namespace fantascope::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class TableFileTest : public testing::Test {
protected:
    std::string now() const {
        const auto text = readFile(folder_ / "dmx.csv.unfinished");
        return text ? *text : "missing";
    }
    const ScratchFolder folder_;
    TableFile table_{folder_ / "dmx.csv", "time,level\n"};
};

// Example failure: the lines of a whole night are in memory, and lost with the power.
TEST_F(TableFileTest, what_was_written_is_there_whatever_happens_next) {
    table_.add("1,0\n");
    EXPECT_EQ(now(), "missing") << "nobody waits for the disk";
    ASSERT_TRUE(table_.write());
    EXPECT_EQ(now(), "time,level\n1,0\n");
    table_.add("2,7\n");
    EXPECT_EQ(now(), "time,level\n1,0\n");
    ASSERT_TRUE(table_.write());
    EXPECT_EQ(now(), "time,level\n1,0\n2,7\n");
}

TEST_F(TableFileTest, it_has_its_name_once_it_is_finished) {
    table_.add("1,0\n");
    ASSERT_TRUE(table_.write());
    table_.add("2,7\n");
    ASSERT_TRUE(table_.finish());
    EXPECT_EQ(*readFile(folder_ / "dmx.csv"), "time,level\n1,0\n2,7\n");
    EXPECT_EQ(now(), "missing");
}

TEST_F(TableFileTest, without_a_line_it_has_its_heading) {
    ASSERT_TRUE(table_.finish());
    EXPECT_EQ(*readFile(folder_ / "dmx.csv"), "time,level\n");
}

// Example failure: half of an older night's table follows the new one's.
TEST_F(TableFileTest, what_a_sudden_end_left_behind_is_overwritten) {
    ASSERT_TRUE(writeFile(folder_ / "dmx.csv.unfinished", std::string(10'000, 'x')));
    ASSERT_TRUE(table_.finish());
    EXPECT_EQ(*readFile(folder_ / "dmx.csv"), "time,level\n");
}

// Every write to this device says that the disk is full.
TEST_F(TableFileTest, a_full_disk_is_told_once_and_ends_the_table) {
    std::filesystem::create_symlink("/dev/full", folder_ / "dmx.csv.unfinished");
    table_.add("1,0\n");
    const auto written = table_.write();
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message(), AllOf(HasSubstr("dmx.csv: cannot be written"), HasSubstr("No space left")));
    table_.add("2,7\n");
    EXPECT_TRUE(table_.write());
    EXPECT_TRUE(table_.finish());
    EXPECT_FALSE(std::filesystem::exists(folder_ / "dmx.csv"));
}

// Example failure: a disk that hangs fills the memory, until the system ends the program.
TEST_F(TableFileTest, a_disk_that_does_not_keep_up_ends_the_table) {
    const std::string line(std::size_t{1} << 20, 'x');
    for (std::size_t bytes = 0; bytes <= 2 * TableFile::kMostWaiting; bytes += line.size()) table_.add(line);
    const auto written = table_.write();
    ASSERT_FALSE(written);
    EXPECT_THAT(written.error().message(), HasSubstr("does not keep up"));
    EXPECT_LE(std::filesystem::file_size(folder_ / "dmx.csv.unfinished"), TableFile::kMostWaiting);
}

TEST_F(TableFileTest, lines_of_several_threads_stay_whole) {
    constexpr int kLines = 1000;
    {
        std::vector<std::jthread> threads;
        for (const char letter : {'a', 'b', 'c'})
            threads.emplace_back([this, letter] {
                for (int line = 0; line < kLines; ++line) table_.add(std::string(9, letter) + '\n');
            });
        for (int i = 0; i < 20; ++i) ASSERT_TRUE(table_.write());
    }
    ASSERT_TRUE(table_.finish());
    const std::string text = *readFile(folder_ / "dmx.csv");
    ASSERT_EQ(text.size(), std::string("time,level\n").size() + 3 * kLines * 10);
    for (std::size_t at = std::string("time,level\n").size(); at < text.size(); at += 10)
        EXPECT_EQ(text.substr(at, 10), std::string(9, text[at]) + '\n');
}

}  // namespace
}  // namespace fantascope::app
