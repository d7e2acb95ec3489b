#pragma once

#include "core/result.h"

#include <filesystem>
#include <string>

namespace fantascope {

// Where something stands in a file that was read, for whoever refuses it later. Value type.
struct FilePlace {
    std::filesystem::path file;
    int line = 1, column = 1;  // in characters, from 1
    std::string key;           // the keys that lead there: "outputs[1].warp"; "": the whole file

    std::string text() const;                       // "file:line:column"
    Error error(const std::string& message) const;  // "file:line:column: path.to.key: message", control characters escaped
    Error error(const Error& cause) const;          // the same of a file that is named there: the file's own error, as it is
};

}  // namespace fantascope
