// One way in for everybody: inputs of many producers have one order, and whoever plays them sees
// the same show.

#include "show/play/input_log.h"

#include "core/random.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <atomic>
#include <map>
#include <string>
#include <thread>
#include <vector>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

CueList fourCues() {
    CueList list;
    for (int cue = 0; cue < 4; ++cue)
        list.cues.push_back({{{{{{static_cast<std::uint32_t>(cue % 2), 0.25f * static_cast<float>(cue + 1)}}}},
                              {0.2f * static_cast<float>(cue)},
                              {static_cast<std::uint8_t>(cue % 2)}},
                             Time(cue * 700ms),
                             std::nullopt});
    list.dark = {{{}}, {0.0f}, {1}};
    list.goInterval = 20ms;
    list.blackoutFade = 300ms;
    return list;
}

Input someInput(Rng& rng, Time at) {
    return {.at = at,
            .kind = static_cast<Input::Kind>(rng.below(6)),
            .cue = static_cast<int>(rng.below(5)),
            .source = static_cast<Input::Source>(rng.below(6)),
            .which = static_cast<int>(rng.below(300))};
}

// Somebody who plays along, and what is seen whenever another hundred inputs have come.
struct Replica {
    explicit Replica(const InputLog& log) : reader(log.reader()), playback(fourCues()) {}
    bool take() {
        const LoggedInput* const logged = reader.next();
        if (logged == nullptr) return false;
        isInOrder = isInOrder && logged->number == count;
        agrees = agrees && playback.apply(logged->input) == logged->outcome;
        newest = std::max(newest, logged->input.at);
        if (++count % 100 != 0) return true;
        seen.emplace_back();
        playback.stateAt(newest + 150ms, seen.back());
        return true;
    }

    InputLog::Reader reader;
    Playback playback;
    std::uint64_t count = 0;
    Time newest = Time::min();
    bool isInOrder = true, agrees = true;
    std::vector<ShowState> seen;
};

// Example failures: a replica whose thread stood still for a while misses inputs and plays another
// show from then on; two producers get one number.
TEST(InputLog, fifty_producers_and_every_replica_agree_on_one_sequence) {
    constexpr int kProducers = 50, kEach = 2000;
    InputLog log(fourCues());
    std::vector<Input> written;
    log.writeTo([&](const LoggedInput& logged) { written.push_back(logged.input); });
    std::atomic<int> working = kProducers;
    std::vector<std::jthread> threads;
    for (int producer = 0; producer < kProducers; ++producer)
        threads.emplace_back([&, producer] {
            Rng rng(static_cast<std::uint64_t>(producer));
            for (int i = 0; i < kEach; ++i) {
                Input input = someInput(rng, Time(i * 10ms));
                input.which = producer;
                log.submit(input);
            }
            --working;
        });
    Replica beside(log), late(log);
    std::jthread reading([&] {
        while (working > 0 || beside.take())
            while (beside.take()) continue;
    });
    threads.clear();
    reading.join();
    while (beside.take()) continue;
    while (late.take()) continue;  // it has not looked until now
    EXPECT_EQ(beside.count, kProducers * kEach);
    EXPECT_EQ(late.count, kProducers * kEach);
    EXPECT_TRUE(beside.isInOrder && beside.agrees && late.isInOrder && late.agrees);
    ASSERT_EQ(beside.seen.size(), kProducers * kEach / 100);
    EXPECT_TRUE(beside.seen == late.seen);

    // Written down as they came.
    ASSERT_EQ(written.size(), kProducers * kEach);
    InputLog::Reader reader = log.reader();
    std::map<int, Time> ofProducer;
    bool isWhatCame = true;
    for (const Input& input : written) {
        isWhatCame = isWhatCame && input == reader.next()->input;
        EXPECT_GE(input.at, ofProducer[input.which]) << "a producer's own inputs keep their order";
        ofProducer[input.which] = input.at;
    }
    EXPECT_TRUE(isWhatCame);
    InputLog again(fourCues());
    Replica replayed(again);
    for (const Input& input : written) again.submit(input);
    while (replayed.take()) continue;
    EXPECT_TRUE(replayed.seen == late.seen);
}

TEST(InputLog, numbers_inputs_and_says_what_becomes_of_each) {
    InputLog log(fourCues());
    EXPECT_EQ(log.submit({.at = 1s, .kind = Input::Kind::Back}).outcome, Outcome::AtFirstCue);
    EXPECT_EQ(log.submit({.at = 1s, .kind = Input::Kind::Go}).outcome, Outcome::Taken);
    const LoggedInput third = log.submit({.at = 1s, .kind = Input::Kind::Go});
    EXPECT_EQ(third.outcome, Outcome::TooSoonAfterCue);
    EXPECT_EQ(third.number, 2u);
    InputLog::Reader reader = log.reader();
    EXPECT_EQ(reader.next()->outcome, Outcome::AtFirstCue) << "what is ignored has its place, too";
    EXPECT_EQ(reader.next()->number, 1u);
    EXPECT_EQ(reader.next()->input.kind, Input::Kind::Go);
    EXPECT_EQ(reader.next(), nullptr);
}

// Of every kind, with all that the kind has.
Input anyInput(Rng& rng, Time at) {
    using Kind = Input::Kind;
    const int subject = static_cast<int>(rng.below(9)) - 1;
    const auto number = [&] { return static_cast<float>(rng.uniform(-1, 1)); };
    Input input{.at = at,
                .kind = static_cast<Kind>(rng.below(static_cast<std::uint32_t>(Kind::Release) + 1)),
                .source = static_cast<Input::Source>(rng.below(static_cast<std::uint32_t>(Input::Source::Page) + 1)),
                .which = static_cast<int>(rng.below(300)),
                .list = static_cast<int>(rng.below(3)) - 1,
                .late = rng.below(2) == 0};
    if (input.kind == Kind::Highlight || input.kind == Kind::Park || input.kind == Kind::Raise)
        input.fixture = subject;
    else if (input.kind == Kind::Switch)
        input.relay = subject;
    else if (input.kind == Kind::Revise || input.kind == Kind::Exchange)
        input.revision = subject;
    else
        input.cue = subject;
    if (input.kind == Kind::Correct)
        for (glm::vec2& corner : input.shift) corner = {number(), number()};
    if (input.kind == Kind::Trim) input.trim = {number(), subject};
    if (input.kind == Kind::Master || input.kind == Kind::Level || input.kind == Kind::Raise) input.level = number();
    if (input.kind == Kind::Switch) input.on = rng.below(2) == 0;
    if (input.kind == Kind::Jump && subject > 0) input.ago = std::chrono::seconds(subject);
    return input;
}

TEST(Input, is_written_down_and_read_back) {
    EXPECT_EQ(lineOf({12500ms, Input::Kind::Jump, 3, Input::Source::Terminal}), "12500000000 jump 3 terminal 0");
    Rng rng(1);
    for (int i = 0; i < 1000; ++i) {
        const Input input = anyInput(rng, Time(static_cast<Time::rep>(rng.uniform(-1e18, 1e18))));
        const auto read = inputOf(lineOf(input));
        ASSERT_TRUE(read) << read.error().message();
        EXPECT_EQ(*read, input);
    }
}

TEST(Input, that_is_damaged_is_refused_with_what_is_wrong) {
    const auto refusal = [](std::string_view line) {
        const auto input = inputOf(line);
        return input ? "read" : input.error().message();
    };
    EXPECT_THAT(refusal("12 go 0 start"), HasSubstr("5 words, here are 4"));
    EXPECT_THAT(refusal("12 go 0 start 0 "), HasSubstr("here are 6"));
    EXPECT_THAT(refusal("12s go 0 start 0"), HasSubstr("'12s' is no whole number"));
    EXPECT_THAT(refusal("99999999999999999999 go 0 start 0"), HasSubstr("no whole number in range"));
    EXPECT_THAT(refusal("12 og 0 start 0"), HasSubstr("'og' is none of go, back"));
    EXPECT_THAT(refusal("12 go 0 hand 0"), HasSubstr("'hand' is none of start"));
    EXPECT_THAT(refusal("12 switch 0 terminal 0 2"), HasSubstr("'2' is neither 0 nor 1"));
    EXPECT_THAT(refusal("12 raise 0 terminal 0"), HasSubstr("'raise' has 6 words, here are 5"));
    EXPECT_THAT(refusal(""), HasSubstr("here are 1"));
}

}  // namespace
}  // namespace fantascope::show
