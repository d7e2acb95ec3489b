// The documents of the two formats are read as their readers read them: the examples must load, and the tables must list the keys
// that the program knows, no more and no fewer.

#include "show/show.h"
#include "show/show_folder.h"
#include "show/site.h"

#include <gmock/gmock.h>

#include <functional>
#include <regex>
#include <set>

namespace fantascope::show {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

std::string documentOf(const std::string& name) {
    return readFile(std::filesystem::path(FANTASCOPE_SOURCE_DIR) / "docs" / name).value();
}

// The fenced YAML blocks of a document.
std::vector<std::string> examplesIn(const std::string& document) {
    static const std::string kOpen = "```yaml\n", kClose = "```";
    std::vector<std::string> examples;
    for (std::size_t at = 0; (at = document.find(kOpen, at)) != std::string::npos;) {
        const std::size_t begin = at + kOpen.size(), end = document.find(kClose, begin);
        examples.push_back(document.substr(begin, end - begin));
        at = end;
    }
    return examples;
}

// The words in code type in the first column of the tables.
std::set<std::string> documentedKeys(const std::string& document) {
    static const std::regex kRow(R"(\n\|((?: `\w+`,?)+) \|)"), kWord(R"(`(\w+)`)");
    std::set<std::string> keys;
    for (std::sregex_iterator row(document.begin(), document.end(), kRow), end; row != end; ++row) {
        const std::string cell = (*row)[1];
        for (std::sregex_iterator word(cell.begin(), cell.end(), kWord); word != end; ++word) keys.insert((*word)[1]);
    }
    return keys;
}

// Everything that the reader of a file knows: an unknown key is put into each map of an example in turn, and the refusal lists
// the known ones.
std::set<std::string> knownKeys(const std::string& example, const std::function<std::string(const std::string&)>& refusal) {
    static const std::string kUnknown = "unknown_to_everybody";
    static const std::regex kBlockKey(R"((^|\n)( *)(- )?\w[\w-]*:)"), kFlowMap(R"(\{(?=\w))"), kList(R"(known here: ([\w, ]+))"),
        kWord(R"(\w+)");
    std::set<std::string> keys;
    const auto ask = [&](const std::string& text) {
        const std::string message = refusal(text);
        std::smatch list;
        if (!std::regex_search(message, list, kList)) return;
        const std::string words = list[1];
        for (std::sregex_iterator word(words.begin(), words.end(), kWord), end; word != end; ++word) keys.insert(word->str());
    };
    for (std::sregex_iterator at(example.begin(), example.end(), kBlockKey), end; at != end; ++at) {
        const std::string indent = (*at)[2], dash = (*at)[3];
        const auto place = static_cast<std::size_t>(at->position(0) + (*at)[1].length());
        // Before a key at its own depth; an item's first key moves to the line below.
        std::string text = example;
        if (!dash.empty()) text.replace(place + indent.size(), dash.size(), std::string(dash.size(), ' '));
        ask(text.insert(place, indent + dash + kUnknown + ": 1\n"));
    }
    for (std::sregex_iterator at(example.begin(), example.end(), kFlowMap), end; at != end; ++at)
        ask(std::string(example).insert(static_cast<std::size_t>(at->position() + 1), kUnknown + ": 1, "));
    return keys;
}

std::string siteRefusal(const std::string& text) {
    const ShowFolder folder;
    const auto site = readSite(folder.write("site.yaml", text));
    return site ? "" : site.error().message();
}

std::string showRefusal(const std::string& text) {
    const ShowFolder folder;
    folder.write("patterns/leaves.pattern.yaml", "");
    const auto show = Show::load(folder.write("show.yaml", text));
    return show ? "" : show.error().message();
}

TEST(Docs, the_example_of_a_site_loads) {
    const auto examples = examplesIn(documentOf("site-format.md"));
    ASSERT_THAT(examples, SizeIs(1));
    EXPECT_THAT(siteRefusal(examples[0]), IsEmpty());
}

TEST(Docs, the_example_of_a_show_loads_and_plays_on_the_example_of_a_site) {
    const auto examples = examplesIn(documentOf("show-format.md"));
    ASSERT_THAT(examples, SizeIs(1));
    ASSERT_THAT(showRefusal(examples[0]), IsEmpty());

    const ShowFolder folder;
    folder.write("patterns/leaves.pattern.yaml", "");
    const auto show = Show::load(folder.write("show.yaml", examples[0]));
    const auto site = readSite(folder.write("site.yaml", examplesIn(documentOf("site-format.md"))[0]));
    const auto list = show->bind(*site);
    EXPECT_TRUE(list) << list.error().message();
}

// `device` stands for the maps that only drivers read; `driver` is the one key of theirs that every reader knows.
TEST(Docs, every_key_of_a_site_is_documented_and_no_other) {
    const std::string document = documentOf("site-format.md");
    std::set<std::string> known = knownKeys(examplesIn(document)[0], siteRefusal);
    EXPECT_GT(known.size(), 30u);
    known.insert("driver");
    EXPECT_EQ(documentedKeys(document), known);
}

TEST(Docs, every_key_of_a_show_is_documented_and_no_other) {
    const std::string document = documentOf("show-format.md");
    const std::set<std::string> known = knownKeys(examplesIn(document)[0], showRefusal);
    EXPECT_GT(known.size(), 15u);
    EXPECT_EQ(documentedKeys(document), known);
}

}  // namespace
}  // namespace fantascope::show
