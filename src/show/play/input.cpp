#include "show/play/input.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <vector>

namespace fantascope::show {
namespace {

constexpr std::array<std::string_view, 25> kKinds = {
    "go",          "back", "jump",  "blackout", "dark",  "light",  "revise", "correct", "exchange",
    "corrections", "trim", "lock",  "load",     "pause", "freeze", "panic",  "restore", "master",
    "highlight",   "solo", "level", "park",     "raise", "switch", "release"};
constexpr std::array<std::string_view, 10> kSources = {"start",    "controller", "contact", "terminal", "screen",
                                                       "schedule", "camera",     "journal", "file",     "page"};
static_assert(kKinds.size() == static_cast<std::size_t>(Input::Kind::Release) + 1);
static_assert(kSources.size() == static_cast<std::size_t>(Input::Source::Page) + 1);

constexpr std::string_view kList = "list", kLate = "late";

// The number that says what an input is about.
template <class AnyInput>
auto& subjectOf(AnyInput& input) {
    using Kind = Input::Kind;
    if (input.kind == Kind::Highlight || input.kind == Kind::Park || input.kind == Kind::Raise) return input.fixture;
    if (input.kind == Kind::Switch) return input.relay;
    const bool hasRevision = input.kind == Kind::Revise || input.kind == Kind::Exchange;
    return hasRevision ? input.revision : input.cue;
}

bool hasLevel(Input::Kind kind) {
    return kind == Input::Kind::Master || kind == Input::Kind::Level || kind == Input::Kind::Raise;
}

// How many words come after the usual ones. `more`: those that are there.
std::size_t moreWordsOf(Input::Kind kind, std::size_t more) {
    switch (kind) {
        case Input::Kind::Correct:
            return 2 * std::tuple_size_v<PictureShift>;
        case Input::Kind::Trim:
            return 2;
        case Input::Kind::Switch:
            return 1;
        case Input::Kind::Jump:
            return std::min<std::size_t>(more, 1);
        default:
            return hasLevel(kind) ? 1 : 0;
    }
}

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
    bool isNumber = error == std::errc() && end == word.data() + word.size();
    if constexpr (std::is_floating_point_v<Number>) isNumber = isNumber && std::isfinite(number);
    if (!isNumber) return Error(fmt::format("'{}' is no {}number in range", word, std::is_integral_v<Number> ? "whole " : ""));
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
        case Outcome::NoSuchOutput:
            return "ignored: there is no such output";
        case Outcome::NoSuchPattern:
            return "ignored: there is no such pattern";
        case Outcome::TooFar:
            return "ignored: the site file allows no correction that far";
        case Outcome::CorrectionsOff:
            return "ignored: corrections are off";
        case Outcome::RelaysHeld:
            return "ignored: the relays stay as they are for now";
        case Outcome::Locked:
            return "ignored: it is locked";
        case Outcome::Panicked:
            return "ignored: all is dark after a panic; restore comes first";
        case Outcome::NothingToRestore:
            return "ignored: there was no panic";
        case Outcome::TooLate:
            return "ignored: it was pressed while the machine was busy; press it again";
        case Outcome::NoSuchLevel:
            return "ignored: a level is 0 to 1";
        case Outcome::NoSuchList:
            return "ignored: there is no such cue list";
        case Outcome::OtherLists:
            return "ignored: it has other cue lists; end the show and begin it anew";
        case Outcome::NoSuchFixture:
            return "ignored: there is no such lamp, or none is highlighted";
        case Outcome::NoSuchRelay:
            return "ignored: there is no such relay";
    }
    return "unknown";
}

std::string_view nameOf(Input::Kind kind) { return kKinds[static_cast<std::size_t>(kind)]; }
std::string_view nameOf(Input::Source source) { return kSources[static_cast<std::size_t>(source)]; }

std::string lineOf(const Input& input) {
    std::string line =
        fmt::format("{} {} {} {} {}", input.at.count(), nameOf(input.kind), subjectOf(input), nameOf(input.source), input.which);
    if (input.kind == Input::Kind::Correct)
        for (const glm::vec2 corner : input.shift) line += fmt::format(" {} {}", corner.x, corner.y);
    if (input.kind == Input::Kind::Jump && input.ago != Time{}) line += fmt::format(" {}", input.ago.count());
    if (hasLevel(input.kind)) line += fmt::format(" {}", input.level);
    if (input.kind == Input::Kind::Switch) line += fmt::format(" {:d}", input.on);
    if (input.kind == Input::Kind::Trim) line += fmt::format(" {} {}", input.trim.share, input.trim.relaysOff);
    if (input.list != 0) line += fmt::format(" {} {}", kList, input.list);
    if (input.late) line += fmt::format(" {}", kLate);
    return line;
}

Result<Input> inputOf(std::string_view line) {
    std::vector<std::string_view> words = wordsOf(line);
    constexpr std::size_t kWords = 5;
    Input input{.late = words.back() == kLate};
    if (input.late) words.pop_back();
    if (words.size() > kWords && words[words.size() - 2] == kList) {
        input.list = TRY(numberOf<int>(words.back()));
        words.resize(words.size() - 2);
    }
    if (words.size() < kWords) return Error(fmt::format("an input has at least {} words, here are {}", kWords, words.size()));
    input.kind = TRY(choiceOf<Input::Kind>(words[1], kKinds));
    const std::size_t wanted = kWords + moreWordsOf(input.kind, words.size() - kWords);
    if (words.size() != wanted) return Error(fmt::format("'{}' has {} words, here are {}", words[1], wanted, words.size()));
    input.at = Time(TRY(numberOf<Time::rep>(words[0])));
    subjectOf(input) = TRY(numberOf<int>(words[2]));
    input.source = TRY(choiceOf<Input::Source>(words[3], kSources));
    input.which = TRY(numberOf<int>(words[4]));
    if (input.kind == Input::Kind::Correct)
        for (std::size_t i = 0; i < 2 * input.shift.size(); ++i)
            input.shift[i / 2][static_cast<int>(i % 2)] = TRY(numberOf<float>(words[kWords + i]));
    if (input.kind == Input::Kind::Jump && words.size() > kWords) input.ago = Time(TRY(numberOf<Time::rep>(words[kWords])));
    if (hasLevel(input.kind)) input.level = TRY(numberOf<float>(words[kWords]));
    if (input.kind == Input::Kind::Switch) {
        const int on = TRY(numberOf<int>(words[kWords]));
        if (on != 0 && on != 1) return Error(fmt::format("'{}' is neither 0 nor 1", on));
        input.on = on == 1;
    }
    if (input.kind == Input::Kind::Trim) {
        input.trim.share = TRY(numberOf<float>(words[kWords]));
        input.trim.relaysOff = TRY(numberOf<int>(words[kWords + 1]));
    }
    return input;
}

}  // namespace fantascope::show
