// Checks the rules of the craft that are visible in a file's text.

#include "house/repository.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <string_view>

namespace fantascope::house {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

using Words = std::vector<std::string>;

struct Ban {
    Words words;
    Words where;   // files whose path begins so; empty: everywhere
    Words unless;  // ... except those whose path begins so
    std::string_view why;
};

const Words kProgram = {"src/", "drivers/"}, kAllCode = {"src/", "drivers/", "tests/", "bench/"};

const std::vector<Ban> kBans = {
    {{"#version ", "gl_Position", "gl_Frag", "sampler2D"},
     kAllCode,
     {"bench/floor."},
     "shaders live in assets/, never inside C++"},
    {{"/home/", sourceFolder() + "/"}, {}, {}, "no path of one machine"},
    {{"_distribution<", "std::shuffle", "std::sample", "random_device", "default_random_engine", "rand()"},
     kAllCode,
     {},
     "chance comes from core/random.h, the same on every machine"},
    {{"steady_clock", "system_clock", "high_resolution_clock", "clock_gettime", "gettimeofday", "std::time("},
     kProgram,
     {"src/core/clock.", "src/app/"},
     "time is handed in as a Clock"},
    {{"sleep_for", "sleep_until", "usleep("}, kAllCode, {"src/core/clock.", "src/app/"}, "nobody sleeps but a Clock"},
    {{"SKIP_REGULAR_EXPRESSION"},
     {},
     {},
     "it wins over an exit code that says failed; fantascope_test_entry has one that says skipped"},
    {{"RUN_ALL_TESTS"}, {"tests/"}, {"tests/test_run.cpp", "tests/house/"}, "runTests() has the exit code for skipped tests"},
    {{"-ffast-math", "-Ofast"}, {"CMake", "src/", "drivers/"}, {}, "the same seed gives the same bytes"},
};

bool beginsWithAny(std::string_view path, const Words& beginnings) {
    return std::any_of(beginnings.begin(), beginnings.end(),
                       [&](std::string_view beginning) { return path.starts_with(beginning); });
}

// The forbidden text of a file, each with its place.
std::vector<std::string> banned(const TextFile& file) {
    std::vector<std::string> found;
    for (const Ban& ban : kBans) {
        const bool holds = ban.where.empty() || beginsWithAny(file.path, ban.where);
        if (!holds || beginsWithAny(file.path, ban.unless)) continue;
        for (std::size_t line = 0; line < file.lines.size(); ++line)
            for (const std::string_view word : ban.words)
                if (file.lines[line].find(word) != std::string::npos)
                    found.push_back(fmt::format("{}: '{}': {}", place(file, line), word, ban.why));
    }
    return found;
}

TEST(Text, keeps_the_rules_of_the_craft) {
    std::vector<std::string> found;
    for (const TextFile& file : repositoryFiles()) {
        if (file.path == "tests/house/text_test.cpp") continue;  // it has to name what it forbids
        const auto here = banned(file);
        found.insert(found.end(), here.begin(), here.end());
    }
    EXPECT_THAT(found, IsEmpty());
}

std::vector<std::string> told(const std::string& path, const std::string& line) { return banned({path, {line}}); }

TEST(TextReader, names_the_place_the_word_and_the_rule) {
    EXPECT_THAT(told("src/render/x.cpp", "const char* shader = \"#version 450\\n\";"),
                ElementsAre("src/render/x.cpp:1: '#version ': shaders live in assets/, never inside C++"));
}

TEST(TextReader, finds_each_forbidden_thing) {
    for (const char* line :
         {"gl_Position = p;", "uniform sampler2D guide;", "std::uniform_real_distribution<double> u;", "std::random_device{}()",
          "std::shuffle(a, b, rng);", "seed = rand();", "std::chrono::steady_clock::now()", "std::time(nullptr)",
          "std::this_thread::sleep_for(1s);", "readGrey(\"/home/somebody/a.png\")", "add_compile_options(-ffast-math)"})
        EXPECT_THAT(told("src/show/x.cpp", line), SizeIs(1)) << line;
}

TEST(TextReader, lets_a_rule_hold_only_where_it_holds) {
    EXPECT_THAT(told("src/core/clock.cpp", "std::chrono::steady_clock::now()"), IsEmpty());
    EXPECT_THAT(told("src/app/run.cpp", "std::chrono::system_clock::now()"), IsEmpty());
    EXPECT_THAT(told("src/app/run.cpp", "std::random_device{}()"), SizeIs(1)) << "a seed is an option, also in app";
    EXPECT_THAT(told("assets/shaders/pattern.vert", "#version 450"), IsEmpty());
    EXPECT_THAT(told("docs/tour.md", "a work of art, at home"), IsEmpty());
}

}  // namespace
}  // namespace fantascope::house
