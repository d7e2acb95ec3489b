// The documents of the two formats are read as their readers read them: the examples must load, and
// the tables must list the keys that the program knows, no more and no fewer.

#include "show/show.h"
#include "show/site/site.h"

#include "scratch_folder.h"
#include "source_folder.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>
#include <set>

namespace fantascope::show {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

std::string documentOf(const std::string& name) {
    return readFile(std::filesystem::path(sourceFolder()) / "docs" / name).value();
}

// What stands between every two marks: between("`k1`, `k2`", "`", "`") is k1, k2.
std::vector<std::string> between(std::string_view text, std::string_view open, std::string_view close) {
    std::vector<std::string> found;
    for (std::size_t at = 0; (at = text.find(open, at)) != std::string_view::npos;) {
        const std::size_t begin = at + open.size(), end = std::min(text.find(close, begin), text.size());
        found.emplace_back(text.substr(begin, end - begin));
        at = std::min(end + close.size(), text.size());
    }
    return found;
}

// The fenced YAML blocks of a document.
std::vector<std::string> examplesIn(const std::string& document) { return between(document, "```yaml\n", "```"); }

// The words in code type in the first column of the tables.
std::set<std::string> documentedKeys(const std::string& document) {
    std::set<std::string> keys;
    for (const std::string& cell : between(document, "\n|", " |"))
        for (const std::string& key : between(cell, "`", "`")) keys.insert(key);
    return keys;
}

// Everything that the reader of a file knows: an unknown key is put into each map of an example in
// turn, and the refusal lists the known ones.
std::set<std::string> knownKeys(const std::string& example, const std::function<std::string(const std::string&)>& refusal) {
    static const std::string kUnknown = "unknown_to_everybody: 1";
    std::set<std::string> keys;
    const auto ask = [&](const std::string& text) {
        for (const std::string& list : between(refusal(text), "known here: ", ")"))
            for (const std::string& key : between(" " + list + ",", " ", ",")) keys.insert(key);
    };
    for (std::size_t at = 0; at < example.size(); ++at) {
        const bool atLine = at == 0 || example[at - 1] == '\n',
                   inFlowMap = at > 0 && example[at - 1] == '{' && example[at] != '}';
        std::string text = example;
        if (atLine) {  // before the line's key, at its depth; an item's first key moves to the line below
            const std::size_t key = example.find_first_not_of(" -", at);
            const std::string lead = example.substr(at, key - at);
            std::replace(text.begin() + static_cast<std::ptrdiff_t>(at), text.begin() + static_cast<std::ptrdiff_t>(key), '-',
                         ' ');
            ask(text.insert(at, lead + kUnknown + "\n"));
        } else if (inFlowMap) {
            ask(text.insert(at, kUnknown + ", "));
        }
    }
    return keys;
}

std::string siteRefusal(const std::string& text) {
    const ScratchFolder folder;
    const auto site = readSite(folder.file("site.yaml", text));
    return site ? "" : site.error().message();
}

// The files that the example of a show names; nobody looks into them here.
void layFiles(const ScratchFolder& folder) {
    for (const char* file : {"patterns/leaves.pattern.yaml", "pictures/poster.png", "clips/rain.mp4", "clips/opening.mov",
                             "casts/trumpet.cast.yaml"})
        folder.file(file, "");
}

std::string showRefusal(const std::string& text) {
    const ScratchFolder folder;
    layFiles(folder);
    const auto show = Show::load(folder.file("show.yaml", text));
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

    const ScratchFolder folder;
    layFiles(folder);
    const auto show = Show::load(folder.file("show.yaml", examples[0]));
    const auto site = readSite(folder.file("site.yaml", examplesIn(documentOf("site-format.md"))[0]));
    const auto list = show->bind(*site);
    EXPECT_TRUE(list) << list.error().message();
}

// `device` stands for the maps that only drivers read; `driver` is the one key of theirs that every
// reader knows.
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
