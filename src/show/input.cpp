#include "show/input.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <vector>

namespace fantascope::show {
namespace {

constexpr std::array<std::string_view, 7> kKinds = {"go", "back", "jump", "blackout", "dark", "light", "revise"};
constexpr std::array<std::string_view, 6> kSources = {"start", "controller", "contact", "terminal", "screen", "schedule"};
static_assert(kKinds.size() == static_cast<std::size_t>(Input::Kind::Revise) + 1);
static_assert(kSources.size() == static_cast<std::size_t>(Input::Source::Schedule) + 1);

std::vector<std::string_view> wordsOf(std::string_view line) {
    std::vector<std::string_view> words;
    while (true) {
        const std::size_t end = line.find(' ');
        words.push_back(line.substr(0, end));
        if (end == std::string_view::npos) return words;
        line.remove_prefix(end + 1);
    }
}

template <class Number>
Result<Number> numberOf(std::string_view word) {
    Number number{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size())
        return Error(fmt::format("'{}' is no whole number in range", word));
    return number;
}

template <class Choice, std::size_t kCount>
Result<Choice> choiceOf(std::string_view word, const std::array<std::string_view, kCount>& names) {
    for (std::size_t i = 0; i < kCount; ++i)
        if (names[i] == word) return static_cast<Choice>(i);
    return Error(fmt::format("'{}' is none of {}", word, fmt::join(names, ", ")));
}

}  // namespace

std::string_view nameOf(Outcome outcome) {
    switch (outcome) {
        case Outcome::Taken:
            return "taken";
        case Outcome::TooSoonAfterCue:
            return "ignored: too soon after the cue began";
        case Outcome::AtLastCue:
            return "ignored: this is the last cue";
        case Outcome::AtFirstCue:
            return "ignored: there is no cue before";
        case Outcome::NoSuchCue:
            return "ignored: there is no such cue";
        case Outcome::NoSuchRevision:
            return "ignored: there is no such revision";
        case Outcome::OtherSite:
            return "ignored: it is for other outputs, lamps or relays";
    }
    return "unknown";
}

std::string lineOf(const Input& input) {
    return fmt::format("{} {} {} {} {}", input.at.count(), kKinds[static_cast<std::size_t>(input.kind)],
                       input.kind == Input::Kind::Revise ? input.revision : input.cue,
                       kSources[static_cast<std::size_t>(input.source)], input.which);
}

Result<Input> inputOf(std::string_view line) {
    const std::vector<std::string_view> words = wordsOf(line);
    if (words.size() != 5) return Error(fmt::format("an input has 5 words, here are {}", words.size()));
    Input input;
    input.at = Time(TRY(numberOf<Time::rep>(words[0])));
    input.kind = TRY(choiceOf<Input::Kind>(words[1], kKinds));
    (input.kind == Input::Kind::Revise ? input.revision : input.cue) = TRY(numberOf<int>(words[2]));
    input.source = TRY(choiceOf<Input::Source>(words[3], kSources));
    input.which = TRY(numberOf<int>(words[4]));
    return input;
}

}  // namespace fantascope::show
