#pragma once

#include "app/base/report.h"

#include "core/result.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace fantascope::app {

// Reads a file; what comes of it is ignored.
using ReadFile = std::function<void(const std::filesystem::path&)>;

// A JSON schema (draft 07) of a kind of file, for editors. It is made from the tables that read the
// file: `read` reads one small file after another, and ConfigTrace tells what it asks for. Each key
// that it knows is tried with a word, a map and a list, and so are the keys below. So nothing of
// the schema is written by hand.
// `examples`: files of this kind that are good, as JSON; all that is only read in a good file must
// be in one of them. Error: the temporary folder cannot be written to.
Result<Report> schemaOf(const std::string& kind, const std::vector<Report>& examples, const ReadFile& read);

// The same of a show file and of a site file.
Result<Report> showSchema();
Result<Report> siteSchema();

}  // namespace fantascope::app
