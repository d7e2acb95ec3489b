#include "app/keys/run_keys.h"

#include "core/file.h"
#include "program.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

TEST(RunKeys, stand_in_the_help_of_both_commands) {
    for (const char* command : {"run", "rehearse"}) {
        const std::string help = runProgram({command, "--help"}, std::filesystem::temp_directory_path()).out;
        for (const RunKey& key : kRunKeys) EXPECT_THAT(help, HasSubstr(fmt::format("\n  {:<7}{}\n", key.name, key.does)));
        EXPECT_THAT(help, testing::AllOf(HasSubstr("\n  Ctrl-C "), HasSubstr("\n  Ctrl-Z ")));
    }
}

TEST(RunKeys, stand_in_the_readme) {
    const auto readme = readFile(sourceFolder() + "/README.md");
    ASSERT_TRUE(readme);
    for (const RunKey& key : kRunKeys) EXPECT_THAT(*readme, HasSubstr(fmt::format("\n| `{}` | {} |\n", key.name, key.does)));
}

TEST(QuitKey, ends_a_night_only_when_it_is_pressed_twice_within_some_seconds) {
    QuitKey key(true);
    EXPECT_FALSE(key.press(10s));
    EXPECT_FALSE(key.press(13001ms)) << "that was another slip";
    EXPECT_TRUE(key.press(16s));
}

TEST(QuitKey, ends_a_rehearsal_at_once) { EXPECT_TRUE(QuitKey(false).press(10s)); }

}  // namespace
}  // namespace fantascope::app
