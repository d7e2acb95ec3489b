// A show goes on with what a journal has left.

#include "show/play/resumption.h"

#include "show/play/playback_replica.h"

#include "core/random.h"

#include <gmock/gmock.h>

namespace fantascope::show {
namespace {

using namespace std::chrono_literals;
using Kind = Input::Kind;

// Four cues, the first of which follows into the second.
CueList fourCues() {
    CueList list;
    for (int i = 0; i < 4; ++i) {
        const float level = static_cast<float>(i + 1) / 4;
        list.cues.push_back(
            {.look = {{{}}, {level}, {i % 2 == 0}}, .fade = 2s, .follow = {}, .name = std::string(1, char('A' + i))});
    }
    list.cues[0].follow = 5s;
    list.dark = {{{}}, {0.f}, {1}};
    list.fixtures = {{0, 1}};
    list.goInterval = 300ms;
    list.blackoutFade = 500ms;
    list.panicFade = 1s;
    return list;
}

// A run that writes its journal as the program does: inputs as they come, its state a little later.
class Night {
public:
    explicit Night(const CueList& list = fourCues()) : list_(list), inputs_(list) {
        write(journal::Run{.list = hashOf(list), .show = {}});
        inputs_.writeTo([this](const LoggedInput& logged) { write(logged.input); });
    }
    void submit(const Input& input) {
        noteUntil(input.at);
        inputs_.submit(input);
        noteUntil(input.at);
    }
    void noteUntil(Time time) {
        for (; tick_ <= time; tick_ += 50ms) {
            const ShowState state = stateAt(tick_);
            journal::State now{.at = written_.at, .controls = state, .corrects = state.corrects, .cue = {}};
            now.controls.next = {};
            if (state.cue >= 0) now.cue = list_.cues[static_cast<std::size_t>(state.cue)].name;
            if (now == written_ && tick_ - written_.at < 5s) continue;
            now.at = tick_;
            written_ = now;
            write(now);
        }
    }
    ShowState stateAt(Time time) {
        ShowState state;
        replica_.stateAt(time, state);
        return state;
    }
    std::vector<std::string> lines;

private:
    void write(const journal::Line& line) { lines.push_back(lineOf(line)); }
    const CueList list_;
    InputLog inputs_;
    PlaybackReplica replica_{inputs_};
    journal::State written_;
    Time tick_{};
};

Journal journalWith(const std::vector<std::string>& lines) {
    std::string text(kJournalHead);
    for (const std::string& line : lines) text += line;
    return journalOf(text).value();
}

struct GoneOn {
    explicit GoneOn(const std::vector<std::string>& lines, Time at, const CueList& list = fourCues())
        : inputs(list), resumption(resume(journalWith(lines), at, inputs)) {}
    ShowState stateAt(Time time) {
        ShowState state;
        PlaybackReplica(inputs).stateAt(time, state);
        return state;
    }
    InputLog inputs;
    std::optional<Resumption> resumption;
};

Input anyInput(Rng& rng, Time at) {
    constexpr Kind kKinds[] = {Kind::Go,    Kind::Go,          Kind::Back,   Kind::Jump,   Kind::Load,    Kind::Blackout,
                               Kind::Pause, Kind::Panic,       Kind::Freeze, Kind::Light,  Kind::Restore, Kind::Master,
                               Kind::Lock,  Kind::Corrections, Kind::Raise,  Kind::Switch, Kind::Switch,  Kind::Release};
    Input input{.at = at, .kind = kKinds[rng.below(std::size(kKinds))], .cue = static_cast<int>(rng.below(4))};
    input.level = static_cast<float>(rng.below(5)) / 4;
    input.fixture = input.relay = 0;
    input.on = rng.below(2) == 0;
    return input;
}

// Example failures: a fade begins again; a follow comes five seconds after the crash.
TEST(Resumption, is_in_the_same_fade_wait_and_follow_and_goes_on_the_same) {
    Rng rng(3);
    for (int i = 0; i < 500; ++i) {
        Night night;
        Time at{};
        for (int input = 0; input < 20; ++input) night.submit(anyInput(rng, at += rng.below(2000) * 1ms));
        const Time died = at + rng.below(3000) * 1ms;
        GoneOn goneOn(night.lines, died);
        ASSERT_TRUE(goneOn.resumption);
        EXPECT_TRUE(goneOn.resumption->isExact);
        for (const Time time : {died, died + 700ms, died + 10s}) ASSERT_EQ(goneOn.stateAt(time), night.stateAt(time)) << i;
        EXPECT_EQ(goneOn.resumption->cue, night.stateAt(died).cue);
    }
}

// Example failure: a line in the middle is damaged, a GO is missing, and from then on every cue is
// the one before.
TEST(Resumption, comes_to_the_same_controls_whatever_lines_are_lost) {
    Rng rng(5);
    for (int i = 0; i < 500; ++i) {
        Night night;
        Time at = 1s;
        for (int input = 0; input < 20; ++input) night.submit(anyInput(rng, at += 100ms + rng.below(2000) * 1ms));
        night.noteUntil(at + 6s);  // and the state after the last
        for (int lost = 0; lost < 3; ++lost) {
            std::string& line = night.lines[1 + rng.below(night.lines.size() - 2)];
            line[rng.below(line.size() - 1)] ^= 1;
        }
        GoneOn goneOn(night.lines, at + 6s);
        ASSERT_TRUE(goneOn.resumption);
        Controls now = goneOn.stateAt(at + 6s), wanted = night.stateAt(at + 6s);
        ASSERT_EQ(now.cue, wanted.cue) << i;
        ASSERT_EQ(now, wanted) << i;
        EXPECT_EQ(goneOn.stateAt(at + 6s).corrects, night.stateAt(at + 6s).corrects);
    }
}

TEST(Resumption, of_another_list_enters_the_cue_of_the_same_name_again) {
    Night night;
    night.submit({0s, Kind::Go});
    night.submit({2s, Kind::Dark});
    night.noteUntil(8s);
    ASSERT_EQ(night.stateAt(8s).cue, 1);
    CueList list = fourCues();
    std::swap(list.cues[0], list.cues[1]);
    GoneOn goneOn(night.lines, 8s, list);
    ASSERT_TRUE(goneOn.resumption);
    EXPECT_FALSE(goneOn.resumption->isExact);
    EXPECT_EQ(goneOn.resumption->cue, 0);
    EXPECT_TRUE(goneOn.stateAt(8s).blackout);
    list.cues.erase(list.cues.begin());
    EXPECT_EQ(GoneOn(night.lines, 8s, list).resumption->cue, -1) << "no cue has that name, but the blackout is still there";
}

// What a run brings that nobody can bring again is left out, and what follows fits all the same.
TEST(Resumption, leaves_out_what_belongs_to_a_run) {
    Night night;
    night.submit({0s, Kind::Go});
    Input exchange{.at = 1s, .kind = Kind::Exchange};
    exchange.revision = 1;
    night.submit(exchange);
    GoneOn goneOn(night.lines, 2s);
    InputLog::Reader reader = goneOn.inputs.reader();
    EXPECT_EQ(reader.next()->input.kind, Kind::Go);
    EXPECT_EQ(reader.next(), nullptr);
}

TEST(Resumption, begins_where_no_input_is_left_and_counts_only_the_newest_beginning) {
    Night first;
    EXPECT_EQ(GoneOn(first.lines, 5s).resumption, std::nullopt);
    first.submit({0s, Kind::Jump, 3});
    Night second;
    second.submit({0s, Kind::Jump, 1});
    std::vector<std::string> lines = first.lines;
    lines.insert(lines.end(), second.lines.begin(), second.lines.end());
    EXPECT_EQ(GoneOn(lines, 9s).resumption->cue, 1);
}

}  // namespace
}  // namespace fantascope::show
