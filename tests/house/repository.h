#pragma once
// The repository's text files, for the tests that read them.

#include <string>
#include <vector>

namespace fantascope::house {

struct TextFile {
    std::string path;  // from the repository's root: "src/core/clock.h"
    std::vector<std::string> lines;
};

// All text files except git's own and those in .gitignore, sorted by path.
std::vector<TextFile> repositoryFiles();

// "src/core/clock.h:12"
std::string place(const TextFile& file, std::size_t line);

}  // namespace fantascope::house
