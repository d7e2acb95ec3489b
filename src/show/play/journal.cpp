#include "show/play/journal.h"

#include "core/file.h"
#include "core/hash.h"
#include "core/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <optional>
#include <string_view>

namespace fantascope::show {

namespace {

constexpr std::size_t kCheckDigits = 8;

// Letters for what is on: those of kHolds, in their order, and of corrections.
constexpr std::string_view kHoldLetters = "bxpfl";
constexpr char kCorrects = 'c';
constexpr char kRaised = 'r', kSwitched = 's';
static_assert(kHoldLetters.size() == std::size(kHolds));

std::string checkOf(std::string_view text) { return fmt::format("{:08x}", static_cast<std::uint32_t>(fnv1a(text))); }

// Takes words off a line, from the left.
class Words {
public:
    explicit Words(std::string_view line) : rest_(line) {}
    std::string_view word() {
        const std::size_t end = std::min(rest_.find(' '), rest_.size());
        const std::string_view word = rest_.substr(0, end);
        rest_.remove_prefix(std::min(end + 1, rest_.size()));
        return word;
    }
    template <class Number>
    Number number(int base = 10) {
        const std::string_view text = word();
        Number number{};
        std::from_chars_result read{};
        if constexpr (std::is_integral_v<Number>)
            read = std::from_chars(text.data(), text.data() + text.size(), number, base);
        else
            read = std::from_chars(text.data(), text.data() + text.size(), number);
        if (read.ec != std::errc() || read.ptr != text.data() + text.size()) isGood_ = false;
        return number;
    }
    Time time() { return Time(number<Time::rep>()); }
    std::string rest() { return std::string(std::exchange(rest_, {})); }
    bool isGood() const { return isGood_; }

private:
    std::string_view rest_;
    bool isGood_ = true;
};

struct Writer {
    std::string operator()(const journal::Run& run) const {
        return fmt::format("run {} {} {} {:016x} {}", run.at.count(), run.utc.count(), run.goesOn ? "goes-on" : "begins",
                           run.list, printable(run.show, 1000));
    }
    std::string operator()(const Input& input) const { return "input " + lineOf(input); }
    std::string operator()(const journal::State& state) const {
        std::string flags;
        for (std::size_t i = 0; i < kHoldLetters.size(); ++i)
            if (state.controls.*kHolds[i].on) flags += kHoldLetters[i];
        if (state.corrects) flags += kCorrects;
        if (flags.empty()) flags = '-';
        for (const ListPlace& side : state.controls.sides) flags += fmt::format(":{},{}", side.cue, side.loaded);
        for (const RaisedLamp& lamp : state.controls.raised) flags += fmt::format(":{}{},{}", kRaised, lamp.fixture, lamp.level);
        for (const SwitchedRelay& relay : state.controls.switched)
            flags += fmt::format(":{}{},{:d}", kSwitched, relay.relay, relay.on);
        return fmt::format("state {} {} {} {} {} {}", state.at.count(), state.controls.cue, state.controls.loaded,
                           state.controls.master, flags, printable(state.cue, 1000));
    }
    std::string operator()(const journal::Told& told) const {
        return fmt::format("event {} {}", told.at.count(), printable(told.text, 1000));
    }
    std::string operator()(const journal::Figures& figures) const {
        std::string text = fmt::format("figures {} {} {} ", figures.at.count(), figures.frames, figures.lateFrames);
        for (const auto& [output, z] : figures.z) text += fmt::format("{} {}/", z, printable(output));
        return text;
    }
    std::string operator()(const journal::Clock& clock) const {
        return fmt::format("clock {} {}", clock.at.count(), clock.utc.count());
    }
    std::string operator()(const journal::Gap& gap) const { return fmt::format("gap {}", gap.at.count()); }
    std::string operator()(const journal::End& end) const {
        return fmt::format("end {} {}", end.at.count(), printable(end.why, 1000));
    }
};

// Where a side list is: "3,-1"; a raised lamp: "r2,0.5"; a switched relay: "s1,1". Returns whether
// it is one of them.
bool readInto(Controls& controls, std::string_view text) {
    const char kind = text.starts_with(kRaised) || text.starts_with(kSwitched) ? text.front() : '\0';
    std::string words(text.substr(kind == '\0' ? 0 : 1));
    std::ranges::replace(words, ',', ' ');
    Words numbers(words);
    const int first = numbers.number<int>();
    if (kind == kRaised)
        controls.raised.insert(controls.raised.begin(), {first, numbers.number<float>()});
    else if (const int second = numbers.number<int>(); kind == kSwitched)
        controls.switched.insert(controls.switched.begin(), {first, second == 1});
    else
        controls.sides.insert(controls.sides.begin(), {first, second, {}});
    return numbers.isGood() && numbers.rest().empty();
}

// Nothing: it is no line of a journal.
std::optional<journal::Line> lineFrom(std::string_view text) {
    Words words(text);
    const std::string_view kind = words.word();
    std::optional<journal::Line> line;
    if (kind == "run") {
        journal::Run run;
        run.at = words.time();
        run.utc = words.time();
        run.goesOn = words.word() == "goes-on";
        run.list = words.number<std::uint64_t>(16);
        run.show = words.rest();
        line = run;
    } else if (kind == "input") {
        const auto input = inputOf(words.rest());
        if (input) line = *input;
    } else if (kind == "state") {
        journal::State state;
        state.at = words.time();
        state.controls.cue = words.number<int>();
        state.controls.loaded = words.number<int>();
        state.controls.master = words.number<float>();
        std::string_view flags = words.word();
        while (const std::size_t colon = flags.rfind(':') + 1) {
            if (!readInto(state.controls, flags.substr(colon))) return std::nullopt;
            flags.remove_suffix(flags.size() - colon + 1);
        }
        const auto isOn = [&](char letter) { return flags.find(letter) != std::string_view::npos; };
        for (std::size_t i = 0; i < kHoldLetters.size(); ++i) state.controls.*kHolds[i].on = isOn(kHoldLetters[i]);
        state.corrects = isOn(kCorrects);
        state.cue = words.rest();
        line = state;
    } else if (kind == "event") {
        const Time at = words.time();
        line = journal::Told{at, words.rest()};
    } else if (kind == "figures") {
        journal::Figures figures;
        figures.at = words.time();
        figures.frames = words.number<std::int64_t>();
        figures.lateFrames = words.number<std::int64_t>();
        for (std::string rest = words.rest(); !rest.empty(); rest.erase(0, rest.find('/') + 1)) {
            if (rest.find('/') == std::string::npos) return std::nullopt;
            Words score(std::string_view(rest).substr(0, rest.find('/')));
            const double z = score.number<double>();
            if (!score.isGood()) return std::nullopt;
            figures.z.emplace_back(score.rest(), z);
        }
        line = figures;
    } else if (kind == "clock") {
        const Time at = words.time();
        line = journal::Clock{at, words.time()};
    } else if (kind == "gap") {
        line = journal::Gap{words.time()};
    } else if (kind == "end") {
        const Time at = words.time();
        line = journal::End{at, words.rest()};
    }
    return words.isGood() ? line : std::nullopt;
}

Time timeOf(const journal::Line& line) {
    return std::visit([](const auto& one) { return one.at; }, line);
}

}  // namespace

std::string lineOf(const journal::Line& line) {
    const std::string text = std::visit(Writer(), line);
    return checkOf(text) + ' ' + text + '\n';
}

Time Journal::newest() const {
    Time newest{};
    for (const Entry& entry : entries) {
        const auto* const run = std::get_if<journal::Run>(&entry.line);
        newest = run != nullptr && !run->goesOn ? run->at : std::max(newest, timeOf(entry.line));
    }
    return newest;
}

std::optional<journal::Clock> Journal::clock() const {
    std::optional<journal::Clock> newest;
    for (const Entry& entry : entries) {
        if (const auto* const run = std::get_if<journal::Run>(&entry.line)) newest = journal::Clock{run->at, run->utc};
        if (const auto* const clock = std::get_if<journal::Clock>(&entry.line)) newest = *clock;
    }
    return newest;
}

Result<Journal> readJournal(const std::filesystem::path& file) {
    return journalOf(TRY(readFile(file, kMaxFileBytes))).in(file.string());
}

Result<Journal> journalOf(std::string_view text) {
    Journal journal;
    if (text.size() < kJournalHead.size() && kJournalHead.starts_with(text)) {
        journal.isTorn = !text.empty();
        return journal;
    }
    const bool hasHead = text.starts_with(kJournalHead);
    if (hasHead) journal.bytes = kJournalHead.size();
    std::size_t damaged = 0;  // since the last good line
    for (std::size_t begin = journal.bytes, end = 0; begin < text.size(); begin = end + 1) {
        end = std::min(text.find('\n', begin), text.size());
        const std::string_view line = text.substr(begin, end - begin);
        std::optional<journal::Line> read;
        if (end < text.size() && line.size() > kCheckDigits &&
            line.substr(0, kCheckDigits) == checkOf(line.substr(kCheckDigits + 1)))
            read = lineFrom(line.substr(kCheckDigits + 1));
        if (!read) {
            ++damaged;
            continue;
        }
        journal.entries.push_back({*std::move(read), damaged > 0});
        journal.damaged += std::exchange(damaged, 0);
        journal.bytes = end + 1;
    }
    if (!hasHead && journal.entries.empty())
        return Error(fmt::format("this is no journal of a night: it does not begin with '{}'",
                                 kJournalHead.substr(0, kJournalHead.size() - 1)));
    journal.isTorn = journal.bytes < text.size();
    return journal;
}

std::uint64_t hashOf(const CueList& list) {
    std::string text = fmt::format("{} {}", list.loops, list.goInterval.count());
    for (const CueList::Cue& cue : list.cues) {
        text += fmt::format("\n{} {}", cue.follow ? cue.follow->count() : -1, cue.name);
        if (!cue.followers.empty()) text += fmt::format(" {} {} {}", fmt::join(cue.followers, ","), cue.times, list.seed);
        for (const CueList::Cue::SideCue& with : cue.with) text += fmt::format(" with {} {}", with.list, with.cue);
        if (!cue.endings.empty()) text += fmt::format(" media {}", cue.length().count());
        for (const CueList::Cue::Ending& ending : cue.endings)
            text += fmt::format(" {} {}", ending.source.value, ending.length.count());
        for (const CueList::Cue::Speed& speed : cue.speeds) text += fmt::format(" speed {} {}", speed.source.value, speed.speed);
        for (const SourceId source : cue.restarts) text += fmt::format(" restart {}", source.value);
    }
    for (const auto& side : list.sides)
        text += fmt::format("\nlist {} {} {}", side->name, side->start.value_or(-1), hashOf(*side));
    return fnv1a(text);
}

}  // namespace fantascope::show
