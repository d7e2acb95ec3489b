#include "app/keys/edit_keys.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using Name = Key::Name;
using show::edit::Tool;
using testing::ElementsAre;
using testing::IsEmpty;

std::vector<Key> keysOf(const std::string& characters) {
    TerminalKeyParser parser;
    std::vector<Key> keys;
    for (const char character : characters)
        if (const auto key = parser.take(character)) keys.push_back(*key);
    for (const Time moment : {0ms, 60ms})
        if (const auto key = parser.pause(moment)) keys.push_back(*key);
    return keys;
}

TEST(TerminalKeyParser, puts_a_terminals_characters_together) {
    EXPECT_THAT(keysOf("a B"), ElementsAre(Key{.letter = 'a'}, Key{.letter = ' '}, Key{.letter = 'b', .shift = true}));
    EXPECT_THAT(keysOf("\t\x1b[Z\r"), ElementsAre(Key{Name::Tab}, Key{.name = Name::Tab, .shift = true}, Key{Name::Enter}));
    EXPECT_THAT(keysOf("\x1b[A\x1bOB\x1b[C\x1b[D"),
                ElementsAre(Key{Name::Up}, Key{Name::Down}, Key{Name::Right}, Key{Name::Left}));
    EXPECT_THAT(keysOf("\x1b[1;2C\x1b[1;5A"),
                ElementsAre(Key{.name = Name::Right, .shift = true}, Key{.name = Name::Up, .control = true}));
    EXPECT_THAT(keysOf("\x1b"), ElementsAre(Key{Name::Escape}));
    // A key that nobody has asked for must not leave its characters behind as others.
    EXPECT_THAT(keysOf("\x1b[5~\x1b[15~x"), ElementsAre(Key{.letter = 'x'}));
}

// What is typed fast arrives in one piece, what comes over a slow line in two.
TEST(TerminalKeyParser, waits_for_the_rest_of_a_sequence) {
    TerminalKeyParser parser;
    EXPECT_FALSE(parser.take('\x1b'));
    EXPECT_FALSE(parser.pause(0ms));
    EXPECT_FALSE(parser.pause(40ms)) << "it may still be on its way";
    EXPECT_FALSE(parser.take('['));
    EXPECT_FALSE(parser.pause(200ms));
    EXPECT_EQ(parser.take('A'), Key{Name::Up});
}

// Every key that the legend promises does something, and the legend tells of every key that does.
TEST(EditKeys, the_legend_lists_the_keys_that_there_are) {
    std::string legend;
    for (const std::string& line : editKeyLegend()) legend += " " + line + " ";
    for (char letter = '!'; letter <= '~'; ++letter) {
        if (letter == '=' || (letter >= '1' && letter <= '9') || (letter >= 'A' && letter <= 'Z'))
            continue;  // another way to say it
        const bool known = editCommandFor(Key{.letter = letter}, Tool::Corners, glm::ivec2(3)).has_value() || letter == 'w' ||
                           letter == 'h' || letter == 'e';
        const bool told = legend.find(std::string(" ") + letter + " ") != std::string::npos;
        EXPECT_EQ(known, told) << letter;
    }
}

TEST(EditKeys, modifiers_make_a_move_longer_and_shorter) {
    const auto moved = [](const Key& key) { return std::get<show::edit::Move>(*editCommandFor(key, Tool::Corners, {})).steps; };
    EXPECT_EQ(moved({Name::Left}), glm::dvec2(-1, 0));
    EXPECT_EQ(moved({.name = Name::Down, .shift = true}), glm::dvec2(0, 10));
    EXPECT_EQ(moved({.name = Name::Up, .control = true}), glm::dvec2(0, -0.1));
}

// From no mesh to one and back, by the same two keys.
TEST(EditKeys, brackets_make_a_mesh_finer_and_take_it_away) {
    const auto points = [](char key, glm::ivec2 mesh) {
        return std::get<show::edit::MeshPoints>(*editCommandFor(Key{.letter = key}, Tool::Mesh, mesh)).points;
    };
    EXPECT_EQ(points(']', {0, 0}), glm::ivec2(3, 3));
    EXPECT_EQ(points(']', {4, 3}), glm::ivec2(5, 4));
    EXPECT_EQ(points('[', {3, 4}), glm::ivec2(2, 3));
    EXPECT_EQ(points('[', {2, 3}), glm::ivec2(0, 0));
}

// The same two, where masks are set.
TEST(EditKeys, brackets_add_points_to_a_mask_and_take_them_away) {
    const auto change = [](char key) {
        return std::get<show::edit::MaskPoints>(*editCommandFor(Key{.letter = key}, Tool::Masks, {4, 3})).change;
    };
    EXPECT_EQ(change(']'), 1);
    EXPECT_EQ(change('['), -1);
}

}  // namespace
}  // namespace fantascope::app
