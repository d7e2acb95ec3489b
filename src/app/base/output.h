#pragma once
// The files that a command writes, and the files that they refer to.

#include "app/base/command_line.h"

#include "core/result.h"

#include <filesystem>
#include <string>

namespace fantascope::app {

// Requires a name that ends in .yaml, such as `example`, so that a typing mistake cannot overwrite
// a picture.
ValueCheck onlyYaml(const std::string& example);
// The same for another extension, such as ".mp4". `type`: its name in the help.
ValueCheck onlyEnding(const std::string& ending, const std::string& type);

// Checks before the work whether `file` can be written. Its folder need not exist yet.
Result<void> checkWritable(const std::filesystem::path& file);

// A file that an output refers to: where it is, and its name beside the output.
struct Material {
    std::filesystem::path source;
    std::string name;  // relative to the output's folder
    bool copied;       // it must be copied there
};

// A source in the output's folder or below stays where it is. Any other is to be copied there as
// STEM.`suffix`; STEM is the P of P.pattern.yaml.
Material materialFor(const std::filesystem::path& output, const std::filesystem::path& source, const std::string& suffix);

Result<void> copyTo(const std::filesystem::path& folder, const Material& material);

}  // namespace fantascope::app
