#include "app/base/report.h"

#include "core/file.h"

namespace fantascope::app {

std::string jsonText(const Report& report) { return report.dump(-1, ' ', false, Report::error_handler_t::replace); }

Report parseJson(const std::string& text) { return Report::parse(text, nullptr, false); }

Result<void> writeReport(const std::filesystem::path& file, const Report& report) {
    return writeFile(file, report.dump(2, ' ', false, Report::error_handler_t::replace) + "\n");
}

}  // namespace fantascope::app
