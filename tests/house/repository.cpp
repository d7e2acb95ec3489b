#include "house/repository.h"

#include "core/file.h"
#include "source_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>

namespace fantascope::house {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> linesOf(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

// Entries at the root that nobody wrote: git's own, and folders such as "/build/" in .gitignore.
std::set<std::string> ignoredAt(const fs::path& root) {
    std::set<std::string> ignored = {".git"};
    for (const std::string& line : linesOf(readFile(root / ".gitignore").value()))
        if (line.size() > 2 && line.front() == '/' && line.back() == '/') ignored.insert(line.substr(1, line.size() - 2));
    return ignored;
}

}  // namespace

std::vector<TextFile> repositoryFiles() {
    const fs::path root = sourceFolder();
    const std::set<std::string> ignored = ignoredAt(root);
    std::vector<TextFile> files;
    for (auto entry = fs::recursive_directory_iterator(root); entry != fs::recursive_directory_iterator(); ++entry) {
        if (entry.depth() == 0 && ignored.contains(entry->path().filename())) {
            entry.disable_recursion_pending();
            continue;
        }
        if (!entry->is_regular_file()) continue;
        const std::string text = readFile(entry->path()).value();
        if (text.find('\0') == std::string::npos) files.push_back({entry->path().lexically_relative(root), linesOf(text)});
    }
    std::sort(files.begin(), files.end(), [](const TextFile& a, const TextFile& b) { return a.path < b.path; });
    return files;
}

std::string place(const TextFile& file, std::size_t line) { return fmt::format("{}:{}", file.path, line + 1); }

}  // namespace fantascope::house
