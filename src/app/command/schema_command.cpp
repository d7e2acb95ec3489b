#include "app/base/report.h"
#include "app/command/commands.h"
#include "app/schema/file_schema.h"

#include <fmt/format.h>

#include <filesystem>
#include <string>

namespace fantascope::app {
namespace {

struct Options {
    std::string kind;
    std::filesystem::path output;
};

void declare(Command& command, Options& options) {
    command.add("kind", options.kind, "the kind of file: show or site").required();
    command.add("-o,--out", options.output, "write the schema to this JSON file (default: print it)");
}

Result<void> schema(const Options& options) {
    if (options.kind != "show" && options.kind != "site")
        return Error(fmt::format("there is no schema of '{}'; there is one of 'show' and one of 'site'", options.kind));
    const Report schema = TRY(options.kind == "show" ? showSchema() : siteSchema());
    if (!options.output.empty()) return writeReport(options.output, schema);
    fmt::print("{}\n", jsonText(schema));
    return {};
}

}  // namespace

void addSchemaCommand(Program& program) {
    addCommand<Options>(program, "schema", "Print a JSON schema of show or site files, for editors", declare, schema);
}

}  // namespace fantascope::app
