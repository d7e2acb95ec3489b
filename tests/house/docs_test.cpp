// Holds what the documents say of the repository: links lead somewhere, files that they name are
// there, and so are the functions that a tour leads to.

#include "house/repository.h"
#include "source_folder.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string_view>

namespace fantascope::house {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

// What a heading is linked by: "What `is` this?" is "what-is-this".
std::string anchorOf(std::string_view heading) {
    std::string anchor;
    for (const char c : heading) {
        if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_')
            anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        else if (c == ' ')
            anchor += '-';
    }
    return anchor;
}

// What stands between each `open` and the next `close` of a line.
std::vector<std::string> between(const std::string& line, std::string_view open, std::string_view close) {
    std::vector<std::string> found;
    for (std::size_t at = 0; (at = line.find(open, at)) != std::string::npos;) {
        at += open.size();
        const std::size_t end = line.find(close, at);
        if (end == std::string::npos) break;
        found.push_back(line.substr(at, end - at));
        at = end + close.size();
    }
    return found;
}

// Calls `read` for each line outside of blocks of code.
void forEachLine(const TextFile& file, const std::function<void(std::size_t, const std::string&)>& read) {
    bool inBlock = false;
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
        if (file.lines[i].starts_with("```"))
            inBlock = !inBlock;
        else if (!inBlock)
            read(i, file.lines[i]);
    }
}

// The anchors of each document, by its path.
using Anchors = std::map<std::string, std::set<std::string>>;

Anchors anchorsOf(const std::vector<TextFile>& files) {
    Anchors anchors;
    for (const TextFile& file : files) {
        std::set<std::string>& here = anchors[file.path];
        forEachLine(file, [&](std::size_t, const std::string& line) {
            const std::size_t text = line.find_first_not_of('#');
            if (text != 0 && text != std::string::npos && line[text] == ' ') here.insert(anchorOf(line.substr(text + 1)));
        });
    }
    return anchors;
}

std::vector<std::string> brokenLinks(const TextFile& file, const Anchors& anchors, const auto& exists) {
    std::vector<std::string> broken;
    forEachLine(file, [&](std::size_t i, const std::string& line) {
        for (const std::string& link : between(line, "](", ")")) {
            if (link.find("://") != std::string::npos) continue;
            const std::size_t hash = link.find('#');
            const std::string name = link.substr(0, hash), anchor = hash == std::string::npos ? "" : link.substr(hash + 1);
            const std::string target =
                name.empty() ? file.path : (fs::path(file.path).parent_path() / name).lexically_normal().string();
            const auto document = anchors.find(target);
            const bool isThere = anchor.empty() ? exists(target) : document != anchors.end() && document->second.contains(anchor);
            if (!isThere) broken.push_back(fmt::format("{}: {}", place(file, i), link));
        }
    });
    return broken;
}

// Whether a word between back quotes names a file of the repository from its root, and no pattern
// of names.
bool namesFile(const std::string& word) {
    static const std::set<std::string> kFolders = {"src",   "drivers", "tests", "docs",    "assets",
                                                   "tools", "config",  "shows", "systemd", "bench"};
    const std::size_t slash = word.find('/');
    return slash != std::string::npos && kFolders.contains(word.substr(0, slash)) &&
           word.find_first_of(" *{}[]<>|:=") == std::string::npos;
}

std::vector<std::string> missingFiles(const TextFile& file, const auto& exists) {
    std::vector<std::string> missing;
    forEachLine(file, [&](std::size_t i, const std::string& line) {
        for (const std::string& word : between(line, "`", "`"))
            if (namesFile(word) && !exists(word)) missing.push_back(fmt::format("{}: {}", place(file, i), word));
    });
    return missing;
}

// The steps of a tour, "`src/show/play/playback.cpp`, `Playback::apply()`", whose file lacks what
// is named.
std::vector<std::string> lostSteps(const TextFile& file, const std::map<std::string, std::string>& texts) {
    std::vector<std::string> lost;
    forEachLine(file, [&](std::size_t i, const std::string& line) {
        for (std::size_t at = 0; (at = line.find("`, `", at)) != std::string::npos; at += 4) {
            const std::size_t begin = line.rfind('`', at - 1) + 1, end = line.find("()`", at + 4);
            const std::string path = line.substr(begin, at - begin);
            if (!namesFile(path) || end == std::string::npos) continue;
            const std::string name = line.substr(at + 4, end - at - 4);
            const std::size_t colons = name.rfind("::");
            const std::string function = colons == std::string::npos ? name : name.substr(colons + 2);
            const auto text = texts.find(path);
            const bool isThere = text != texts.end() && text->second.find(function + "(") != std::string::npos &&
                                 (colons == std::string::npos || text->second.find(name.substr(0, colons)) != std::string::npos);
            if (!isThere) lost.push_back(fmt::format("{}: {} has no {}()", place(file, i), path, name));
        }
    });
    return lost;
}

class Docs : public testing::Test {
protected:
    Docs() {
        for (TextFile& file : repositoryFiles()) {
            for (const std::string& line : file.lines) texts_[file.path] += line + "\n";
            if (file.path.ends_with(".md")) documents_.push_back(std::move(file));
        }
    }
    // What `find` finds in all documents.
    std::vector<std::string> all(const std::function<std::vector<std::string>(const TextFile&)>& find) const {
        std::vector<std::string> found;
        for (const TextFile& document : documents_) std::ranges::copy(find(document), std::back_inserter(found));
        return found;
    }
    static bool exists(const std::string& path) { return fs::exists(fs::path(sourceFolder()) / path); }

    std::vector<TextFile> documents_;
    std::map<std::string, std::string> texts_;
};

TEST_F(Docs, link_to_what_is_there) {
    const Anchors anchors = anchorsOf(documents_);
    EXPECT_THAT(all([&](const TextFile& file) { return brokenLinks(file, anchors, exists); }), IsEmpty());
}

TEST_F(Docs, name_files_that_are_there) {
    EXPECT_THAT(all([](const TextFile& file) { return missingFiles(file, exists); }), IsEmpty());
}

TEST_F(Docs, lead_to_functions_that_are_there) {
    EXPECT_THAT(all([&](const TextFile& file) { return lostSteps(file, texts_); }), IsEmpty());
}

// A newcomer finds every document from the index.
TEST_F(Docs, are_all_in_the_index) {
    const std::string& index = texts_.at("docs/README.md");
    std::vector<std::string> missing;
    for (const TextFile& document : documents_) {
        const fs::path path = document.path;
        if (path.parent_path() == "docs" && path.filename() != "README.md" &&
            index.find("(" + path.filename().string() + ")") == std::string::npos)
            missing.push_back(document.path);
    }
    EXPECT_THAT(missing, IsEmpty());
}

bool isReadme(const std::string& path) { return path == "docs/a.md"; }

TEST(DocsReader, follows_links_and_anchors) {
    const TextFile a{"docs/a.md",
                     {"# What `is` it?", "```", "# no heading", "[x](nowhere.md)", "```", "[a](a.md), [b](b.md)",
                      "[c](#what-is-it) [d](#no-heading) [e](https://example.org/x)", "[f](../docs/a.md#what-is-it)"}};
    EXPECT_THAT(brokenLinks(a, anchorsOf({a}), isReadme), ElementsAre("docs/a.md:6: b.md", "docs/a.md:7: #no-heading"));
}

TEST(DocsReader, knows_a_file_from_a_pattern_of_names) {
    EXPECT_THAT(missingFiles({"x.md", {"`docs/a.md`, `docs/*.md`, `docs/b.md`, `a/b`", "`src/x y`"}}, isReadme),
                ElementsAre("x.md:1: docs/b.md"));
}

TEST(DocsReader, looks_for_the_function_of_a_step) {
    const std::map<std::string, std::string> texts = {{"src/a.cpp", "void A::run() {}"}};
    EXPECT_THAT(
        lostSteps({"x.md",
                   {"1. `src/a.cpp`, `A::run()`: it runs.", "2. `src/a.cpp`, `B::run()`", "3. `src/a.cpp`, `A::walk()`",
                    "4. `src/b.cpp`, `run()`"}},
                  texts),
        ElementsAre("x.md:2: src/a.cpp has no B::run()", "x.md:3: src/a.cpp has no A::walk()", "x.md:4: src/b.cpp has no run()"));
}

}  // namespace
}  // namespace fantascope::house
