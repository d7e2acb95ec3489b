#pragma once

#include "core/result.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <memory>
#include <string>

namespace fantascope::app {

// What the chosen subcommand does, once the whole line has been understood. Error: the world refused; main prints it and exits
// with 1.
using Action = std::function<Result<void>()>;

// Every subcommand is one file with one function of this kind, listed in main.cpp: it declares the subcommand on the program and,
// when the line chooses it, sets the action.
using AddCommand = void (*)(CLI::App& program, Action& action);

// The common body of those functions: `declare` binds the subcommand's options to the fields of one struct, `run` is handed the
// filled struct.
template <class Options>
void addCommand(CLI::App& program, Action& action, const std::string& name, const std::string& description,
                void (*declare)(CLI::App& command, Options& options), Result<void> (*run)(const Options& options)) {
    CLI::App* command = program.add_subcommand(name, description);
    auto options = std::make_shared<Options>();
    declare(*command, *options);
    command->callback([options, run, &action] { action = [options, run] { return run(*options); }; });
}

}  // namespace fantascope::app
