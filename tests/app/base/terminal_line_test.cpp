#include "app/base/terminal_line.h"

#include <gmock/gmock.h>

#include <sstream>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;

TEST(Columns, are_those_of_the_terminal_and_not_the_bytes) {
    EXPECT_EQ(columnsOf(""), 0);
    EXPECT_EQ(columnsOf("Both"), 4);
    EXPECT_EQ(columnsOf("Dämmerung"), 9);
    EXPECT_EQ(columnsOf("全部"), 4) << "a wide character takes two";
    EXPECT_EQ(columnsOf("e\u0301"), 1) << "a combining one takes none";
    EXPECT_EQ(columnsOf("\x1b[2J"), 4) << "what is not to be printed is a question mark";
    EXPECT_EQ(columnsOf("\xff\xfe"), 2);
}

TEST(Columns, a_text_is_cut_where_it_does_not_fit) {
    EXPECT_EQ(fitted("Farewell", 8), "Farewell");
    EXPECT_EQ(fitted("Farewell", 7), "Farewe…");
    EXPECT_EQ(fitted("全部の影", 7), "全部の…");
    EXPECT_EQ(fitted("全部の影", 6), "全部…") << "half a character is none";
    EXPECT_EQ(fitted("Farewell", 1), "…");
    EXPECT_EQ(fitted("Farewell", 0), "");
}

// Example failure: a cue's name clears the operator's screen.
TEST(Columns, what_is_not_to_be_printed_is_not) { EXPECT_EQ(fitted("a\x1b[2Jb\xff", 20), "a?[2Jb?"); }

TEST(TerminalLine, never_fills_the_terminal_and_follows_its_width) {
    std::ostringstream out;
    int columns = 9;
    {
        TerminalLine line(out, [&] { return columns; });
        line.draw("Farewell");
        columns = 8;
        line.draw("Farewell");
    }
    EXPECT_EQ(out.str(), "\r\x1b[JFarewell\r\r\x1b[JFarewe…\r\n");
}

TEST(TerminalLine, says_news_above_it) {
    std::ostringstream out;
    {
        TerminalLine line(out, [] { return 80; });
        line.draw("status");
        line.say("news");
        line.draw("status");
    }
    EXPECT_EQ(out.str(), "\r\x1b[Jstatus\r\r\x1b[Jnews\n\r\x1b[Jstatus\r\n");
}

TEST(Duration, is_short_and_never_too_short) {
    EXPECT_EQ(shortDuration(0s), "0 s");
    EXPECT_EQ(shortDuration(59001ms), "1:00 min");
    EXPECT_EQ(shortDuration(65s), "1:05 min");
    EXPECT_EQ(shortDuration(7800s), "2:10 h");
}

}  // namespace
}  // namespace fantascope::app
