#pragma once
// The command line. CLI11 reads it, and command_line.cpp alone knows CLI11, whose headers take
// seconds to compile.

#include "core/result.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace fantascope::app {

// What an option's text has to be.
struct ValueCheck {
    std::function<std::string(const std::string& given)> refuse;  // why not, or ""
    std::string type;                                             // in the help; may be empty
};

// A handle on an option or a positional argument. Its functions may be chained.
class Option {
public:
    explicit Option(CLI::Option* option) : option_(option) {}

    Option required();
    Option check(const ValueCheck& check);
    // Both bounds are allowed.
    Option range(int least, int most);
    Option range(double least, double most);
    Option range(std::uint64_t least, std::uint64_t most);
    Option positive();
    Option nonNegative();
    // The option may stand without a text; then the text is empty. Only of addParsed().
    Option orNothing();
    // Of lists:
    Option delimiter(char between);
    Option noExtraArguments();  // the argument after the list is no part of it
    Option expected(int count);
    // Of two options:
    Option needs(Option other);
    Option excludes(Option other);
    // In the help:
    Option typeName(const std::string& name);
    Option defaultText(const std::string& text);
    Option showDefault();  // the field's present value
    Option hidden();

private:
    CLI::Option* option_;
};

// A handle on a subcommand. The fields must live as long as the program.
class Command {
public:
    explicit Command(CLI::App* command) : command_(command) {}

    // An option that sets a field. `names`: "-o,--out", or "GUIDE" for a positional argument.
    // The types of fields are listed at the end of command_line.cpp.
    template <class Field>
    Option add(const std::string& names, Field& field, const std::string& help);
    Option addFlag(const std::string& names, bool& field, const std::string& help);
    // An option whose text is handed to `take`, which returns why it refuses the text, or "".
    Option addParsed(const std::string& names, std::function<std::string(const std::string& given)> take,
                     const std::string& help);
    // An option whose value is one of these names; --help lists them in this order.
    template <class Value, class Field>
    Option addChoice(const std::string& names, Field& field, const std::vector<std::pair<std::string, Value>>& choices,
                     const std::string& help) {
        std::vector<std::string> all;
        for (const auto& choice : choices) all.push_back(choice.first);
        return addChoice(
            names, all, [choices, &field](std::size_t chosen) { field = choices[chosen].second; }, help);
    }

    bool has(const std::string& name) const;
    void footer(const std::string& text);
    void hidden();

private:
    Option addChoice(const std::string& names, const std::vector<std::string>& choices,
                     const std::function<void(std::size_t chosen)>& choose, const std::string& help);

    CLI::App* command_;
};

// The chosen subcommand's work, to be done once the whole command line is parsed. Error: main
// prints it and exits with 1.
using Action = std::function<Result<void>()>;

// What a command line asks for.
enum class Parsed {
    Action,
    Help,  // or the version; it has been printed
    Wrong  // not a command line of this program; the reason has been printed
};

class Program {
public:
    Program(const std::string& name, const std::string& description, const std::string& version);
    ~Program();

    Command add(const std::string& name, const std::string& description, Action action);
    Parsed parse(int argc, const char* const* argv);
    // The action of the subcommand that parse() found.
    const Action& action() const { return action_; }

private:
    std::unique_ptr<CLI::App> program_;
    Action action_;
};

// `text` as an option with a whole number reads it.
std::optional<int> wholeNumber(const std::string& text);

}  // namespace fantascope::app
