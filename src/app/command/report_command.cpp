#include "app/base/geometry_options.h"
#include "app/command/commands.h"
#include "app/journal/night.h"

#include "core/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace fantascope::app {
namespace {

namespace fs = std::filesystem;

struct Options {
    std::vector<fs::path> journals;
    fs::path page;
};

void declare(Command& command, Options& options) {
    command.add("JOURNAL", options.journals, "A folder of --journal, for all its nights; or single journals of it").required();
    addOutOption(command, options.page, "The page to write: FILE.html").required();
}

// The journals of a folder, oldest first: the names of old ones tell when they began, and the one
// without is the newest.
std::vector<fs::path> journalsIn(const fs::path& folder) {
    std::vector<fs::path> files;
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
        if (entry.path().filename().string().starts_with("journal-")) files.push_back(entry.path());
    std::ranges::sort(files);
    if (fs::exists(folder / "journal", ignored)) files.push_back(folder / "journal");
    return files;
}

Result<void> report(const Options& options) {
    if (options.page.extension() != ".html")
        return Error(fmt::format("{}: the page is a file that ends in .html", options.page.string()));
    std::vector<std::pair<std::string, Night>> nights;
    for (const fs::path& path : options.journals) {
        std::error_code ignored;
        const std::vector<fs::path> files = fs::is_directory(path, ignored) ? journalsIn(path) : std::vector{path};
        if (files.empty())
            return Error(fmt::format("{}: it holds no journal; 'run' and 'rehearse' write one with --journal", path.string()));
        for (const fs::path& file : files) nights.emplace_back(file.string(), nightOf(TRY(show::readJournal(file))));
    }
    TRY(writeFile(options.page, pageOf(nights)));
    std::size_t deaths = 0, lost = 0;
    for (const auto& [file, night] : nights) deaths += night.deaths(), lost += night.damaged + night.gaps;
    fmt::print("{}: {} night{}, {} of the runs died, {} lines are lost\n", options.page.string(), nights.size(),
               nights.size() == 1 ? "" : "s", deaths, lost);
    return {};
}

}  // namespace

void addReportCommand(Program& program) {
    addCommand<Options>(program, "report", "Tell of nights from their journals, as a page", declare, report);
}

}  // namespace fantascope::app
