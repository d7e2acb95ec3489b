#pragma once

#include "core/result.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {

// The chosen subcommand's work, to be done once the whole command line is parsed. Error: main
// prints it and exits with 1.
using Action = std::function<Result<void>()>;

// Every subcommand is one file with one function of this type, listed in main.cpp. It declares the
// subcommand on the program and sets the action if the command line chooses it.
using AddCommand = void (*)(CLI::App& program, Action& action);

// The common body of those functions: `declare` binds the subcommand's options to the fields of one
// struct, and `run` gets the filled struct.
template <class Options>
void addCommand(CLI::App& program, Action& action, const std::string& name, const std::string& description,
                void (*declare)(CLI::App& command, Options& options), Result<void> (*run)(const Options& options)) {
    CLI::App* command = program.add_subcommand(name, description);
    auto options = std::make_shared<Options>();
    declare(*command, *options);
    command->callback([options, run, &action] { action = [options, run] { return run(*options); }; });
}

// An option whose value is one of these names; --help lists them in this order.
template <class Value, class Field>
CLI::Option* addChoice(CLI::App& command, const std::string& name, Field& field,
                       const std::vector<std::pair<std::string, Value>>& choices, const std::string& description) {
    std::vector<std::string> names;
    for (const auto& choice : choices) names.push_back(choice.first);
    const std::string all = "{" + CLI::detail::join(names) + "}";
    const auto valueOf = [choices, all](std::string& given) {
        for (const auto& [choice, value] : choices)
            if (choice == given) {
                given = std::to_string(static_cast<int>(value));  // as the option reads an enumeration
                return std::string();
            }
        return "'" + given + "' is none of " + all;
    };
    return command.add_option(name, field, description)->transform(CLI::Validator(valueOf, ""))->type_name(all);
}

// `--output NAME`: an output, by its name in the site. It refuses a file's name.
CLI::Option* addProjectorOption(CLI::App& command, std::string& projector, const std::string& description);

// Makes a command without outputs answer `--output FILE` with the right option, -o.
void refuseProjectorOption(CLI::App& command);

// `-o, --out`: the file or folder that a command writes. Call it after addProjectorOption(), if the
// command has that.
template <class File>
CLI::Option* addOutOption(CLI::App& command, File& file, const std::string& description) {
    if (command.get_option_no_throw("--output") == nullptr) refuseProjectorOption(command);
    return command.add_option("-o,--out", file, description);
}

}  // namespace fantascope::app
