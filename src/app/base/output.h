#pragma once
// What a command leaves behind, and what that refers to.

#include "core/result.h"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <string>

namespace fantascope::app {

// Keeps a slip of the finger from writing over a picture: a name that ends in .yaml, such as
// `example`.
CLI::Validator onlyYaml(const std::string& example);
// The same of one ending, such as ".mp4"; `type`: how the help calls it.
CLI::Validator onlyEnding(const std::string& ending, const std::string& type);

// Whether `file` could be written, as far as can be told before the work; its folder need not be
// there yet.
Result<void> checkWritable(const std::filesystem::path& file);

// A file that an output refers to: where it is, and its name beside the output.
struct Material {
    std::filesystem::path source;
    std::string name;  // relative to the output's folder
    bool copied;       // it has to be put there
};

// What lies in the output's folder or below stays where it is; anything else becomes STEM.`suffix`
// there, with the P of P.pattern.yaml for STEM.
Material materialFor(const std::filesystem::path& output, const std::filesystem::path& source, const std::string& suffix);

Result<void> copyTo(const std::filesystem::path& folder, const Material& material);

}  // namespace fantascope::app
