#include "core/text.h"

#include "core/config/naming.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>

namespace fantascope {
namespace {

TEST(Text, what_a_terminal_would_obey_is_shown_instead) {
    EXPECT_EQ(printable("a\x1b[31mb\r\n\tc\x7f"), "a\\x1b[31mb\\x0d\\x0a\\x09c\\x7f");
    EXPECT_EQ(printable("M\xc3\xbcller \xe2\x82\xac \xf0\x9f\x8c\x99"), "M\xc3\xbcller \xe2\x82\xac \xf0\x9f\x8c\x99");
    EXPECT_EQ(printable("\xc2\x9b"
                        "2J"),
              "\\xc2\\x9b2J")
        << "the C1 form of ESC [";
    EXPECT_EQ(printable("\xff\xc3"), "\\xff\\xc3");
}

TEST(Text, a_long_text_loses_its_end_at_a_whole_character) {
    EXPECT_EQ(printable("abcdef", 3), "abc...");
    EXPECT_EQ(printable("abc", 3), "abc");
    EXPECT_EQ(printable("\xc3\xbc\xc3\xbc\xc3\xbc", 3), "\xc3\xbc\xc3\xbc...");
}

TEST(Text, the_lines_of_a_message_stay) { EXPECT_EQ(printableLines("a\x1b\nb"), "a\\x1b\nb"); }

// A person who reads "t.png: cannot be read" would have to search three files for the one that
// names it.
TEST(NamedIn, the_error_of_a_named_file_is_led_by_the_place_of_its_key) {
    const ScratchFolder folder;
    folder.file("c.yaml", "a: 1\nmany:\n  - {picture: other.png}\n  - {picture: ./t.png}\n");
    const Error cause("t.png: cannot be read");
    EXPECT_EQ(folder.relative(namedIn(folder / "c.yaml", folder / "t.png", cause).message()),
              "c.yaml:4:15: many[1].picture: t.png: cannot be read");
    EXPECT_EQ(namedIn(folder / "c.yaml", folder / "u.png", cause).message(), "t.png: cannot be read");
    EXPECT_EQ(namedIn(folder / "none.yaml", folder / "t.png", cause).message(), "t.png: cannot be read");
}

}  // namespace
}  // namespace fantascope
