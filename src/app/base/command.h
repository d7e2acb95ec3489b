#pragma once

#include "core/result.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {

// What the chosen subcommand does, once the whole line has been understood. Error: the world
// refused; main prints it and exits with 1.
using Action = std::function<Result<void>()>;

// Every subcommand is one file with one function of this kind, listed in main.cpp: it declares the
// subcommand on the program and, when the line chooses it, sets the action.
using AddCommand = void (*)(CLI::App& program, Action& action);

// The common body of those functions: `declare` binds the subcommand's options to the fields of one
// struct, `run` is handed the filled struct.
template <class Options>
void addCommand(CLI::App& program, Action& action, const std::string& name, const std::string& description,
                void (*declare)(CLI::App& command, Options& options), Result<void> (*run)(const Options& options)) {
    CLI::App* command = program.add_subcommand(name, description);
    auto options = std::make_shared<Options>();
    declare(*command, *options);
    command->callback([options, run, &action] { action = [options, run] { return run(*options); }; });
}

// An option whose value is one of some names, in the order in which --help lists them.
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

// `--output NAME`: the projector that is meant, by its name in the site. It refuses what is a
// file's name.
CLI::Option* addProjectorOption(CLI::App& command, std::string& projector, const std::string& description);

// Lets a command that knows no projector tell whoever writes `--output FILE` what was meant.
void refuseProjectorOption(CLI::App& command);

// `-o, --out`: the file or folder that a command writes. After addProjectorOption, where the
// command has that.
template <class File>
CLI::Option* addOutOption(CLI::App& command, File& file, const std::string& description) {
    if (command.get_option_no_throw("--output") == nullptr) refuseProjectorOption(command);
    return command.add_option("-o,--out", file, description);
}

}  // namespace fantascope::app
