// What all subcommands have in common at the prompt.

#include "program.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <sstream>

namespace fantascope::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::filesystem::path kHere = std::filesystem::temp_directory_path();

std::string helpOf(const std::string& command) { return runProgram({command, "--help"}, kHere).out; }

// As `fantascope --help` lists them.
std::vector<std::string> allCommands() {
    std::istringstream help(runProgram({"--help"}, kHere).out);
    std::vector<std::string> commands;
    std::string line;
    while (std::getline(help, line) && line != "Subcommands:") {
    }
    while (std::getline(help, line) && line.starts_with("  "))
        if (line[2] != ' ') commands.push_back(line.substr(2, line.find(' ', 2) - 2));
    return commands;
}

TEST(EveryCommand, lists_the_names_of_a_choice_alone) {
    const std::vector<std::string> commands = allCommands();
    ASSERT_GE(commands.size(), 14u);
    for (const std::string& command : commands)
        EXPECT_THAT(helpOf(command), AllOf(Not(HasSubstr("ENUM")), Not(HasSubstr("->")))) << command;
    EXPECT_THAT(helpOf("pattern"), HasSubstr("--method {refined,paper}"));
    const Outcome wrong = runProgram({"pattern", "a.png", "-o", "a.pattern.yaml", "--method", "papre"}, kHere);
    EXPECT_THAT(wrong, exits(2));
    EXPECT_THAT(wrong.errors, HasSubstr("'papre' is none of {refined,paper}"));
}

// One option, one meaning, in all commands: -o is a file, --output a projector.
TEST(EveryCommand, calls_a_file_o_and_a_projector_output) {
    for (const std::string& command : allCommands()) {
        const std::string help = helpOf(command);
        EXPECT_EQ(help.find("-o,"), help.find("-o,--out ")) << command;
        EXPECT_EQ(help.find("  --output"), help.find("  --output NAME")) << command;
    }
}

TEST(EveryCommand, tells_whoever_gives_a_file_to_output_what_was_meant) {
    for (const char* command :
         {"pattern", "pose", "deform", "adapt", "fabricate", "convert", "plot", "devices", "export", "preview", "template"}) {
        const Outcome outcome = runProgram({command, "--output", "out/file.png"}, kHere);
        EXPECT_THAT(outcome, exits(2)) << command;
        EXPECT_THAT(outcome.errors, HasSubstr("--output names a projector; write -o out/file.png")) << command;
    }
}

}  // namespace
}  // namespace fantascope::app
