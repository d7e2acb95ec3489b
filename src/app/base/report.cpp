#include "app/base/report.h"

#include "core/file.h"

namespace fantascope::app {

Result<void> writeReport(const std::filesystem::path& file, const Report& report) {
    return writeFile(file, report.dump(2) + "\n");
}

}  // namespace fantascope::app
