#pragma once
// What the subcommands have in common.

#include "app/base/command_line.h"

#include <filesystem>

namespace fantascope::app {

// Every subcommand is one file with one function of this type, listed in main.cpp. It declares the
// subcommand on the program.
using AddCommand = void (*)(Program& program);

// The common body of those functions: `declare` binds the subcommand's options to the fields of one
// struct, and `run` gets the filled struct.
template <class Options>
void addCommand(Program& program, const std::string& name, const std::string& description,
                void (*declare)(Command& command, Options& options), Result<void> (*run)(const Options& options)) {
    const auto options = std::make_shared<Options>();
    Command command = program.add(name, description, [options, run] { return run(*options); });
    declare(command, *options);
}

// `--output NAME`: an output, by its name in the site. It refuses a file's name.
Option addProjectorOption(Command& command, std::string& projector, const std::string& description);

// `-o, --out`: the file or folder that a command writes. Call it after addProjectorOption(), if the
// command has that.
Option addOutOption(Command& command, std::filesystem::path& file, const std::string& description);

}  // namespace fantascope::app
