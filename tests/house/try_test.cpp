// Checks the rule of core/result.h: in a braced initialiser, nothing comes before TRY. When TRY
// returns there, g++ does not destroy the members that were made before it.

#include "house/repository.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <string_view>

namespace fantascope::house {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// The code with comments and quoted text replaced by blanks; lines stay lines.
std::string withoutWords(const TextFile& file) {
    static const std::regex kWords(R"rx("(?:\\.|[^"\\])*"|\b(?:0x)?\d[\w.']*|'(?:\\.|[^'\\])'|//.*)rx");
    std::string code;
    for (const std::string& line : file.lines) code += std::regex_replace(line, kWords, "_") + '\n';
    return code;
}

bool isWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// Whether the brace at `at` begins an initialiser, as in Type{...}, = {...}, return {...}, f({...})
// and {{...}}; else it begins a block. The house format has a blank before a block's brace, and
// none after a type's name.
bool beginsValue(std::string_view code, std::size_t at) {
    if (at > 0 && (isWord(code[at - 1]) || code[at - 1] == '>')) return true;
    std::string_view before = code.substr(0, at);
    while (!before.empty() && std::isspace(static_cast<unsigned char>(before.back())) != 0) before.remove_suffix(1);
    if (before.ends_with("return")) return true;
    return !before.empty() && std::string_view("=(,{").find(before.back()) != std::string_view::npos;
}

// Whether something comes before the TRY at `at` in the braces of an initialiser around it.
bool comesAfterAMember(std::string_view code, std::size_t at) {
    int depth = 0;
    bool comma = false;
    for (std::size_t i = at; i-- > 0;) {
        const char c = code[i];
        if (c == ')' || c == ']' || c == '}') {
            ++depth;
        } else if (depth > 0) {
            if (c == '(' || c == '[' || c == '{') --depth;
        } else if (c == ',') {
            comma = true;
        } else if (c == '(' || c == '[') {
            comma = false;  // the arguments of a call: g++ destroys those
        } else if (c == '{') {
            if (!beginsValue(code, i)) return false;
            if (comma) return true;
        } else if (c == ';') {
            return false;
        }
    }
    return false;
}

std::vector<std::string> brokenIn(const TextFile& file) {
    static const std::regex kTry(R"(\bTRY\()");
    const std::string code = withoutWords(file);
    std::vector<std::string> broken;
    for (std::sregex_iterator found(code.begin(), code.end(), kTry), end; found != end; ++found) {
        const auto at = static_cast<std::size_t>(found->position());
        if (!comesAfterAMember(code, at)) continue;
        broken.push_back(place(file, static_cast<std::size_t>(std::count(code.begin(), code.begin() + found->position(), '\n'))));
    }
    return broken;
}

TEST(Try, comes_first_between_braces) {
    std::vector<std::string> broken;
    for (const TextFile& file : repositoryFiles()) {
        if (!(file.path.ends_with(".cpp") || file.path.ends_with(".h")) || file.path.starts_with("tests/house/")) continue;
        const auto here = brokenIn(file);
        broken.insert(broken.end(), here.begin(), here.end());
    }
    EXPECT_THAT(broken, IsEmpty()) << "g++ leaks what stands before TRY there: give TRY's value a name first";
}

std::vector<std::string> told(const std::vector<std::string>& lines) { return brokenIn({"a.cpp", lines}); }

TEST(TryReader, finds_a_member_before_it) {
    for (const char* line :
         {"return Picture{pattern, TRY(readGuide(file))};",
          "for (auto& f : files) TRY(copyTo(own, {f, TRY(relativeTo(f)), true}));",
          "std::array<P, 2> both = {TRY(make()), TRY(make())};", "Met met{TRY(widget.meet()), TRY(widget.number())};",
          "return {name, TRY(read())};", "add({{a}, std::make_shared<B>(TRY(read()))});", "Part part{{low}, {TRY(high())}};"})
        EXPECT_THAT(told({line}), ElementsAre("a.cpp:1")) << line;
    EXPECT_THAT(told({"Line line{universe,", "          // its port, \"first\"", "          TRY(open())};"}),
                ElementsAre("a.cpp:3"));
}

TEST(TryReader, knows_blocks_and_arguments) {
    for (const char* line :
         {"if (a) { f(b, c); TRY(d()); }", "{ const int a = TRY(b()), c = TRY(d()); }", "return glm::ivec2(TRY(a()), TRY(b()));",
          "text += fmt::format(\"{}, {}\", {a, b}, TRY(c()));", "return Result{TRY(a()), b};",
          "const auto f = [a, b] { return TRY(c()); };", "auto f() -> Result<int> { return TRY(c()); }",
          "return {std::vector{a, b}[TRY(c())]};  // {a, TRY(b)}"})
        EXPECT_THAT(told({line}), IsEmpty()) << line;
}

}  // namespace
}  // namespace fantascope::house
