#include "app/base/command_line.h"

#include "core/text.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace fantascope::app {
namespace {

std::string failureMessage(const CLI::App* program, const CLI::Error& error) {
    const auto chosen = program->get_subcommands();
    const std::string command = chosen.empty() ? "" : " " + chosen.front()->get_name();
    return fmt::format("{}: error: {}\nSee '{}{} --help'.\n", program->get_name(), printableLines(error.what()),
                       program->get_name(), command);
}

}  // namespace

Option Option::required() { return Option(option_->required()); }

Option Option::check(const ValueCheck& check) { return Option(option_->check(check.refuse, check.type)); }

Option Option::range(int least, int most) { return Option(option_->check(CLI::Range(least, most))); }

Option Option::range(double least, double most) { return Option(option_->check(CLI::Range(least, most))); }

Option Option::range(std::uint64_t least, std::uint64_t most) { return Option(option_->check(CLI::Range(least, most))); }

Option Option::positive() { return Option(option_->check(CLI::PositiveNumber)); }

Option Option::nonNegative() { return Option(option_->check(CLI::NonNegativeNumber)); }

Option Option::delimiter(char between) { return Option(option_->delimiter(between)); }

Option Option::noExtraArguments() { return Option(option_->allow_extra_args(false)); }

Option Option::orNothing() { return Option(option_->expected(0, 1)); }

Option Option::expected(int count) { return Option(option_->expected(count)); }

Option Option::needs(Option other) { return Option(option_->needs(other.option_)); }

Option Option::excludes(Option other) { return Option(option_->excludes(other.option_)); }

Option Option::typeName(const std::string& name) { return Option(option_->type_name(name)); }

Option Option::defaultText(const std::string& text) { return Option(option_->default_str(text)); }

Option Option::showDefault() { return Option(option_->capture_default_str()); }

Option Option::hidden() { return Option(option_->group("")); }

template <class Field>
Option Command::add(const std::string& names, Field& field, const std::string& help) {
    return Option(command_->add_option(names, field, help));
}

Option Command::addFlag(const std::string& names, bool& field, const std::string& help) {
    return Option(command_->add_flag(names, field, help));
}

Option Command::addParsed(const std::string& names, std::function<std::string(const std::string&)> take,
                          const std::string& help) {
    const auto takeOrThrow = [names, take = std::move(take)](const std::string& given) {
        if (const std::string why = take(given); !why.empty()) throw CLI::ValidationError(names, why);
    };
    return Option(command_->add_option_function<std::string>(names, takeOrThrow, help));
}

Option Command::addChoice(const std::string& names, const std::vector<std::string>& choices,
                          const std::function<void(std::size_t)>& choose, const std::string& help) {
    const std::string all = fmt::format("{{{}}}", fmt::join(choices, ","));
    const auto refuse = [choices, all](const std::string& given) {
        return std::ranges::count(choices, given) > 0 ? "" : fmt::format("'{}' is none of {}", given, all);
    };
    const auto take = [choices, choose](const std::string& given) {
        choose(static_cast<std::size_t>(std::ranges::find(choices, given) - choices.begin()));
    };
    return Option(command_->add_option_function<std::string>(names, take, help)->check(refuse)->type_name(all));
}

bool Command::has(const std::string& name) const { return command_->get_option_no_throw(name) != nullptr; }

void Command::footer(const std::string& text) { command_->footer(text); }

void Command::hidden() { command_->group(""); }

Program::Program(const std::string& name, const std::string& description, const std::string& version)
    : program_(std::make_unique<CLI::App>(description, name)) {
    program_->set_version_flag("--version", version);
    program_->require_subcommand(1);
    program_->failure_message(failureMessage);
}

Program::~Program() = default;

Command Program::add(const std::string& name, const std::string& description, Action action) {
    CLI::App* command = program_->add_subcommand(name, description);
    command->callback([this, action = std::move(action)] { action_ = action; });
    return Command(command);
}

Parsed Program::parse(int argc, const char* const* argv) {
    try {
        program_->parse(argc, argv);
        return Parsed::Action;
    } catch (const CLI::ParseError& error) {  // also thrown for --help, with exit code 0
        return program_->exit(error) == 0 ? Parsed::Help : Parsed::Wrong;
    }
}

std::optional<int> wholeNumber(const std::string& text) {
    int number = 0;
    return CLI::detail::lexical_cast(text, number) ? std::optional(number) : std::nullopt;
}

// The types of fields. Another one is added here.
template Option Command::add(const std::string&, std::string&, const std::string&);
template Option Command::add(const std::string&, std::filesystem::path&, const std::string&);
template Option Command::add(const std::string&, int&, const std::string&);
template Option Command::add(const std::string&, std::uint64_t&, const std::string&);
template Option Command::add(const std::string&, double&, const std::string&);
template Option Command::add(const std::string&, std::optional<std::string>&, const std::string&);
template Option Command::add(const std::string&, std::optional<std::filesystem::path>&, const std::string&);
template Option Command::add(const std::string&, std::optional<int>&, const std::string&);
template Option Command::add(const std::string&, std::optional<std::uint32_t>&, const std::string&);
template Option Command::add(const std::string&, std::optional<std::int64_t>&, const std::string&);
template Option Command::add(const std::string&, std::optional<std::uint64_t>&, const std::string&);
template Option Command::add(const std::string&, std::optional<double>&, const std::string&);
template Option Command::add(const std::string&, std::vector<std::string>&, const std::string&);
template Option Command::add(const std::string&, std::vector<std::filesystem::path>&, const std::string&);
template Option Command::add(const std::string&, std::vector<double>&, const std::string&);
template Option Command::add(const std::string&, std::vector<int>&, const std::string&);

}  // namespace fantascope::app
