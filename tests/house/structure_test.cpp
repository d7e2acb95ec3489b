// Holds what docs/design.md promises whoever looks for the way: rooms that a person can survey, no
// circle among them, files and functions that can be read in one go.

#include "house/repository.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>
#include <string_view>

namespace fantascope::house {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::size_t kMostFiles = 40, kMostLines = 450, kMostLinesOfAFunction = 60;

std::vector<TextFile> code() {
    std::vector<TextFile> files = repositoryFiles();
    std::erase_if(files, [](const TextFile& file) {
        return !(file.path.starts_with("src/") || file.path.starts_with("drivers/")) ||
               !(file.path.ends_with(".h") || file.path.ends_with(".cpp"));
    });
    return files;
}

std::string roomOf(std::string_view path) {
    if (path.starts_with("src/")) path.remove_prefix(4);
    return std::string(path.substr(0, path.rfind('/')));
}

using Graph = std::map<std::string, std::set<std::string>>;

Graph includesBetweenRooms(const std::vector<TextFile>& files) {
    Graph graph;
    for (const TextFile& file : files)
        for (const std::string& line : file.lines) {
            char header[256] = "";
            if (std::sscanf(line.c_str(), " # include \"%255[^\"]", header) == 1 && roomOf(header) != roomOf(file.path))
                graph[roomOf(file.path)].insert(roomOf(header));
        }
    return graph;
}

// The rooms of a circle that can be reached from `room`, the first one once more at the end; empty
// where there is none.
std::vector<std::string> circleFrom(const std::string& room, const Graph& graph, std::vector<std::string>& way,
                                    std::set<std::string>& done) {
    if (const auto before = std::find(way.begin(), way.end(), room); before != way.end()) {
        std::vector<std::string> circle(before, way.end());
        circle.push_back(room);
        return circle;
    }
    if (!done.insert(room).second) return {};
    way.push_back(room);
    if (const auto found = graph.find(room); found != graph.end())
        for (const std::string& next : found->second)
            if (auto circle = circleFrom(next, graph, way, done); !circle.empty()) return circle;
    way.pop_back();
    return {};
}

std::vector<std::string> circleOf(const Graph& graph) {
    std::vector<std::string> way;
    std::set<std::string> done;
    for (const auto& [room, includes] : graph)
        if (auto circle = circleFrom(room, graph, way, done); !circle.empty()) return circle;
    return {};
}

TEST(Rooms, include_each_other_in_no_circle) {
    const Graph graph = includesBetweenRooms(code());
    EXPECT_GT(graph.size(), 20u) << "the sources were not found";
    EXPECT_THAT(circleOf(graph), IsEmpty());
}

TEST(RoomReader, finds_a_circle_and_names_its_rooms) {
    const std::vector<TextFile> files = {{"src/a/one.cpp", {"#include \"b/c/two.h\"", "#include \"a/one.h\""}},
                                         {"src/b/c/two.h", {"#include \"drivers/d/three.h\""}},
                                         {"drivers/d/three.h", {"#include \"b/c/two.h\""}}};
    EXPECT_THAT(circleOf(includesBetweenRooms(files)), ElementsAre("b/c", "drivers/d", "b/c"));
}

TEST(Rooms, hold_as_many_files_as_a_person_can_survey) {
    std::map<std::string, std::size_t> files;
    for (const TextFile& file : code()) ++files[roomOf(file.path)];
    for (const auto& [room, count] : files) EXPECT_LE(count, kMostFiles) << room;
}

TEST(Files, can_be_read_in_one_go) {
    for (const TextFile& file : code()) EXPECT_LE(file.lines.size(), kMostLines) << file.path;
}

std::size_t indentOf(const std::string& line) { return std::min(line.find_first_not_of(' '), line.size()); }

bool opensAScope(const std::string& head) {
    for (const char* word : {"namespace ", "class ", "struct ", "enum ", "union ", "extern "})
        if (head.find(word) != std::string::npos) return head.find('(') == std::string::npos;
    return false;
}

// Where the statement begins that opens a block at `line`.
std::size_t beginningOf(const TextFile& file, std::size_t line) {
    const auto ends = [](const std::string& text) {
        return text.empty() || text.find_first_of(";{}", text.size() - 1) != std::string::npos ||
               text.find("//") != std::string::npos || text.ends_with("public:") || text.ends_with("private:") ||
               text.ends_with("protected:") || text.starts_with('#');
    };
    while (line > 0 && !ends(file.lines[line - 1])) --line;
    return line;
}

// What clang-format has laid out needs no parser: a block ends at the first line that is a brace
// below the beginning of the statement that opened it. Gives the blocks that are longer than a
// function may be, by their first lines; classes and tables are none.
std::vector<std::string> longBlocks(const TextFile& file) {
    std::vector<std::string> blocks;
    for (std::size_t line = 0; line < file.lines.size(); ++line) {
        if (!file.lines[line].ends_with('{')) continue;
        const std::size_t first = beginningOf(file, line);
        if (opensAScope(file.lines[first])) continue;
        const std::string end = std::string(indentOf(file.lines[first]), ' ') + '}';
        std::size_t last = line + 1;
        while (last < file.lines.size() && !file.lines[last].starts_with(end)) ++last;
        if (last == file.lines.size()) continue;
        line = last;  // the blocks inside are parts of this one
        if (last - first + 1 > kMostLinesOfAFunction && !file.lines[last].starts_with(end + ';'))
            blocks.push_back(fmt::format("{}: {} lines", place(file, first), last - first + 1));
    }
    return blocks;
}

TEST(Functions, can_be_read_in_one_go) {
    std::vector<std::string> longer;
    for (const TextFile& file : code())
        for (const std::string& block : longBlocks(file)) longer.push_back(block);
    EXPECT_THAT(longer, IsEmpty());
}

TEST(FunctionReader, measures_functions_and_not_classes_or_tables) {
    TextFile file{"src/a/one.cpp", {"class Long {", "    void f() {"}};
    file.lines.resize(61, "        work();");
    file.lines.insert(file.lines.end(), {"    }", "};", "const int kTable[] = {"});
    file.lines.resize(160, "    1,");
    file.lines.push_back("};");
    EXPECT_THAT(longBlocks(file), ElementsAre("src/a/one.cpp:2: 61 lines"));
}

}  // namespace
}  // namespace fantascope::house
