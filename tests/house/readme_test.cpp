// A newcomer types what a README or a document says, in its order: every file that a command reads
// is in the repository, or an earlier command made it.

#include "house/repository.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>
#include <string_view>

namespace fantascope::house {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::string_view kProgram = "fantascope";

// Whatever follows these options is written, or is not a file.
const std::set<std::string_view> kMakes = {"-o",       "--out",       "--image",  "--view",     "--each",
                                           "--sheet",  "--video",     "--record", "--pictures", "--report",
                                           "--meshes", "--solutions", "--board",  "--markers",  "--picture"};

// The words of each command of the program, with its line: whole lines of code blocks, and text
// between back quotes. A line that ends in a backslash continues on the next.
struct Command {
    std::vector<std::string> words;
    std::size_t line;
};

std::vector<std::string> wordsOf(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

std::vector<Command> commandsOf(const TextFile& file) {
    std::vector<Command> commands;
    const auto add = [&](const std::string& text, std::size_t line) {
        std::vector<std::string> words = wordsOf(text);
        if (words.size() > 1 && fs::path(words[0]).filename() == kProgram) commands.push_back({std::move(words), line});
    };
    bool inBlock = false;
    std::string begun;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
        const std::string& line = file.lines[i];
        if (line.starts_with("```")) {
            inBlock = !inBlock;
        } else if (inBlock || line.starts_with("    ")) {
            begun += line;
            if (begun.ends_with('\\')) {
                begun.back() = ' ';
            } else {
                add(begun, i);
                begun.clear();
            }
        } else {
            std::istringstream pieces(line);
            bool quoted = false;
            for (std::string piece; std::getline(pieces, piece, '`'); quoted = !quoted)
                if (quoted) add(piece, i);
        }
    }
    return commands;
}

// A path, but none of a placeholder such as DIR/NAME, NAME.stage.yaml or FOLDER/frame-0001.png.
bool isPath(const std::string& word) {
    const fs::path path(word);
    if (word.starts_with("-") || word.find_first_of("[]|{}") != std::string::npos) return false;
    const auto isLower = [](char c) { return c >= 'a' && c <= 'z'; };
    const std::string first = word.substr(0, word.find_first_of("./"));
    if (!first.empty() && std::none_of(first.begin(), first.end(), isLower)) return false;
    return (path.has_extension() || word.find('/') != std::string::npos) && std::any_of(word.begin(), word.end(), isLower);
}

// The paths that no earlier command has made and that do not exist, each with its place.
std::vector<std::string> missingIn(const TextFile& file, const auto& exists) {
    std::vector<std::string> missing;
    std::vector<std::string> made;
    for (const Command& command : commandsOf(file)) {
        for (std::size_t i = 2; i < command.words.size(); ++i) {
            const std::string& word = command.words[i];
            if (kMakes.contains(command.words[i - 1])) {
                made.push_back(word);
                continue;
            }
            const bool wasMade = std::any_of(made.begin(), made.end(), [&](const std::string& earlier) {
                return word == earlier || word.starts_with(earlier + "/");
            });
            if (isPath(word) && !wasMade && !exists(word))
                missing.push_back(fmt::format("{}: {}", place(file, command.line), word));
        }
    }
    return missing;
}

TEST(Readme, names_files_that_are_there) {
    const fs::path root = sourceFolder();
    std::vector<std::string> missing;
    std::size_t commands = 0;
    for (const TextFile& file : repositoryFiles()) {
        const fs::path path = file.path;
        if (path.filename() != "README.md" && (path.parent_path() != "docs" || path.extension() != ".md")) continue;
        commands += commandsOf(file).size();
        const auto exists = [&](const std::string& path) {
            return fs::exists(root / path) || fs::exists((root / file.path).parent_path() / path);
        };
        const auto here = missingIn(file, exists);
        missing.insert(missing.end(), here.begin(), here.end());
    }
    EXPECT_THAT(missing, IsEmpty());
    EXPECT_GT(commands, 30u) << "the commands were not found";
}

// A newcomer sees what to type and what comes of it on the first screen, and no wall of text after.
class FirstPage : public testing::Test {
protected:
    FirstPage() {
        for (const TextFile& file : repositoryFiles())
            if (file.path == "README.md") lines_ = file.lines;
    }
    std::size_t lineOf(std::string_view beginning) const {
        const auto found = std::ranges::find_if(lines_, [&](const std::string& line) { return line.starts_with(beginning); });
        return static_cast<std::size_t>(found - lines_.begin());
    }
    std::vector<std::string> lines_;
};

TEST_F(FirstPage, begins_with_the_two_commands_and_a_picture) {
    EXPECT_LT(lineOf("tools/rehearse"), lineOf("tools/test"));
    EXPECT_LT(lineOf("tools/test"), lineOf("!["));
    EXPECT_LT(lineOf("!["), 15u);
    EXPECT_LT(lineOf("!["), lineOf("## "));
}

// Of each paragraph that is no list, table, heading or code.
TEST_F(FirstPage, has_paragraphs_of_at_most_three_sentences) {
    std::vector<std::string> walls;
    std::string paragraph;
    bool inBlock = false;
    std::size_t paragraphs = 0;
    const auto end = [&] {
        std::size_t sentences = 0;
        for (std::size_t at = 0; (at = paragraph.find(". ", at)) != std::string::npos; ++at) ++sentences;
        if (sentences > 3) walls.push_back(paragraph);
        if (sentences > 0) ++paragraphs;
        paragraph.clear();
    };
    for (const std::string& line : lines_) {
        if (line.starts_with("```")) inBlock = !inBlock;
        if (line.empty() || inBlock || line.find_first_of("#|-!`") == 0)
            end();
        else
            paragraph += line + " ";
    }
    end();
    EXPECT_THAT(walls, IsEmpty());
    EXPECT_GT(paragraphs, 5u) << "the paragraphs were not found";
}

std::vector<std::string> told(const std::vector<std::string>& lines) {
    return missingIn({"README.md", lines}, [](const std::string& path) { return path == "shows/a"; });
}

TEST(ReadmeReader, knows_what_was_made_before) {
    EXPECT_THAT(told({"```", "build/release/fantascope pose rabbit.png -o try/a.cast.yaml",
                      "build/release/fantascope convert try/a.cast.yaml -o a.glb", "```"}),
                ElementsAre("README.md:2: rabbit.png"));
    EXPECT_THAT(
        told({"Take `fantascope pose moves/frame-0005.png`, `fantascope rehearse shows/a --window` or `fantascope check FILE`."}),
        ElementsAre("README.md:1: moves/frame-0005.png"));
    EXPECT_THAT(told({"`fantascope pose FOLDER/1.png --stage NAME.stage.yaml`"}), IsEmpty());
    EXPECT_THAT(told({"    fantascope deform shows/a -o moves", "    fantascope pose moves/1.png \\",
                      "      --hints h.yaml -o b.cast.yaml"}),
                ElementsAre("README.md:3: h.yaml"));
}

}  // namespace
}  // namespace fantascope::house
