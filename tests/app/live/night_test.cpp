// A whole night on the stepped clock in which everything that can fail does so in turn, while the
// rest plays on.

#include "app/parts/fault_log.h"
#include "app/live/frame_loop.h"
#include "app/live/frame_recorder.h"
#include "app/live/hand.h"
#include "app/live/lighting.h"
#include "app/parts/part_guard.h"
#include "app/live/recording.h"
#include "app/live/screenshots.h"
#include "app/live/watch.h"
#include "app/passing_display.h"
#include "app/running_show.h"

#include "scratch_folder.h"
#include "source_folder.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

// What fails now, and how often each thing has been done.
struct Ledger {
    std::string broken;
    std::map<std::string, std::int64_t> done, tried;
    void work(const std::string& what) {
        ++tried[what];
        if (what == broken) throw std::runtime_error("it is out of order");
        ++done[what];
    }
};

template <class Port>
class Breakable : public Port {
public:
    Breakable(std::unique_ptr<Port> good, std::string name, Ledger& ledger)
        : good_(std::move(good)), name_(std::move(name)), ledger_(ledger) {}
    DeviceStatus status() const override { return good_->status(); }

protected:
    void work() { ledger_.work(name_); }
    const std::unique_ptr<Port> good_;

private:
    const std::string name_;
    Ledger& ledger_;
};

class BreakableDisplay final : public PassingDisplay {
public:
    BreakableDisplay(std::unique_ptr<DisplaySink> good, std::string name, Ledger& ledger)
        : PassingDisplay(std::move(good)), name_(std::move(name)), ledger_(ledger) {}
    Result<void> finish() override {
        ledger_.work(name_);
        return PassingDisplay::finish();
    }

private:
    const std::string name_;
    Ledger& ledger_;
};

class BreakableLine final : public Breakable<DmxPort> {
public:
    using Breakable::Breakable;
    Result<void> send(std::span<const std::uint8_t, kDmxSlots> slots) override {
        work();
        return good_->send(slots);
    }
};

class BreakableBank final : public Breakable<RelayBank> {
public:
    using Breakable::Breakable;
    std::size_t size() const override { return good_->size(); }
    Result<std::vector<bool>> read() override { return good_->read(); }
    Result<void> write(const std::vector<bool>& states) override {
        work();
        return good_->write(states);
    }
};

class BreakableController final : public Breakable<CueController> {
public:
    using Breakable::Breakable;
    std::optional<ButtonEvent> poll() override {
        work();
        return good_->poll();
    }
    void light(int button, const ButtonLight& light) override { good_->light(button, light); }
};

class BreakableCamera final : public Breakable<CameraSource> {
public:
    using Breakable::Breakable;
    std::shared_ptr<const CameraFrame> newest() override {
        work();
        return good_->newest();
    }
    CameraDescription description() const override { return good_->description(); }
};

// The simulated default site, with outputs of few pixels: the recording of a minute would take the
// test's time.
show::Site aSmallSite() {
    show::Site site = valueOf(show::readSite(sourceFolder() + "/config/simulated/site.yaml"));
    for (show::Output& output : site.outputs) output.projection.size = {160, 90};
    return site;
}

// The default show on that site. Each of the things below can be made to throw.
class Night : public testing::Test {
protected:
    Night() {
        for (const std::size_t output : {0u, 1u}) wrap<BreakableDisplay>(devices_.displays[output], site_.outputs[output].name);
        wrap<BreakableLine>(devices_.lines[0].port, "lighting");
        wrap<BreakableBank>(devices_.relayBanks[0], "relays");
        wrap<BreakableController>(devices_.cueController, "input");
        wrap<BreakableCamera>(devices_.camera, "watch");
        const auto sources = render::PictureSources::numbered({show_.sources.size(), render::SolidSource{}});
        frames_.emplace(site_, inputs_, sources, sourceFolder() + "/assets", devices_, clock_);
        std::vector<Recording::Output> outputs;
        std::vector<std::string> names;
        std::vector<render::NewestFrame*> pictured;
        for (std::size_t output = 0; output < site_.outputs.size(); ++output) {
            names.push_back(site_.outputs[output].name);
            outputs.push_back({names.back(), site_.outputs[output].size(), site_.outputs[output].refreshRate});
            pictured.push_back(&frames_->tap(output).addNewest(0));
        }
        recording_ = valueOf(Recording::open(folder_ / "recording", outputs));
        recorder_.emplace(*recording_, site_, *frames_, clock_, faults_, [this] { ledger_.work("recording"); });
        EXPECT_TRUE(frames_->prepare());
        start_ = frames_->refreshFrom(1s);
        const show::ShowClock showClock(start_);
        lighting_.emplace(site_, inputs_, devices_, clock_, showClock, recording_.get(), faults_, events_);
        hand_.emplace(played_, inputs_, site_, devices_, showClock, events_);
        const std::vector<Watch::Comparisons> nothing(names.size(), Watch::Comparisons());
        watch_.emplace(played_, names, nothing, devices_.camera.get(), nullptr, showClock, recording_.get());
        screenshots_.emplace(folder_ / "pictures", played_, inputs_, names, pictured, showClock, events_);
        deviceWatch_.emplace(faults_, std::vector<std::string>{site_.relayBanks[0].name}, start_);
        faults_.begin(showClock);
        frames_->begin(showClock);
        recorder_->begin(start_);
        clock_.setParts(parts());
        clock_.sleepUntil(start_);
    }
    // In the order in which a run has them.
    std::vector<Part> parts() {
        std::vector<Part> parts;
        parts.push_back({"input", Hand::kRate, start_, [this](Time moment) { hand_->tick(moment); }, Rank::Input});
        parts.push_back({"lighting", Lighting::kRate, start_, [this](Time moment) { lighting_->tick(moment); }, Rank::Lighting});
        for (Part& relays : lighting_->relayParts()) parts.push_back(std::move(relays));
        parts.push_back({"watch", Watch::kRate, start_, [this](Time moment) { watch_->tick(moment); }, Rank::Watch});
        for (Part& video : recorder_->parts()) parts.push_back(std::move(video));
        parts.push_back(recorder_->tables());
        parts.push_back({"pictures", Screenshots::kRate, start_,
                         [this, happened = events_.reader()](Time moment) mutable {
                             screenshots_->tick(moment);
                             while (const show::Event* const event = happened.next())
                                 if (std::holds_alternative<show::event::PictureTaken>(event->what)) ledger_.work("pictures");
                         },
                         Rank::Watch});
        parts.push_back({"devices", DeviceWatch::kRate, start_,
                         [this](Time moment) {
                             deviceWatch_->look(moment, frames_->withFaults(devices_.statuses()));
                             ledger_.work("devices");
                         },
                         Rank::Input});
        parts.push_back({"progress", 2, start_, [this](Time) { ledger_.work("progress"); }, Rank::Input});
        for (Part& part : parts) part = guarded(std::move(part), faults_);
        return parts;
    }
    template <class Wrapped, class Port>
    void wrap(std::unique_ptr<Port>& port, const std::string& name) {
        port = std::make_unique<Wrapped>(std::move(port), name, ledger_);
    }
    // Some seconds of the show, in each of which a picture is asked for and a cue comes that moves
    // the relays. What was done in it.
    std::map<std::string, std::int64_t> play(int seconds) {
        const auto before = ledger_.done;
        for (int second = 0; second < seconds; ++second) {
            screenshots_->take();
            const bool street = std::exchange(street_, !street_);
            inputs_.submit({clock_.now() - start_, show::Input::Kind::Jump,
                            static_cast<int>(valueOf(show_.cueNamed(street ? "Dusk" : "Full")))});
            for (const Time end = clock_.now() + 1s; clock_.now() < end;) frames_->step();
        }
        auto done = ledger_.done;
        for (auto& [what, count] : done)
            if (const auto earlier = before.find(what); earlier != before.end()) count -= earlier->second;
        return done;
    }

    const ScratchFolder folder_;
    show::Site site_ = aSmallSite();
    show::Show show_ = valueOf(show::Show::load(sourceFolder() + "/shows/light-movement"));
    show::CueList cues_ = valueOf(show_.bind(site_));
    show::PlayedShow played_{std::make_shared<const show::Revision>(show::Revision{show_, site_, cues_, {}})};
    show::InputLog inputs_{cues_};
    SteppedClock clock_;
    site::World world_{clock_};
    Ledger ledger_;
    Devices devices_ = valueOf(openDevices(site_, Backends::SimulatedHeadless, {clock_, &world_}));
    show::EventLog events_;
    FaultLog faults_{events_};
    std::optional<DeviceWatch> deviceWatch_;
    std::optional<FrameLoop> frames_;
    std::unique_ptr<Recording> recording_;
    std::optional<FrameRecorder> recorder_;
    Time start_{};
    std::optional<Lighting> lighting_;
    std::optional<Hand> hand_;
    std::optional<Watch> watch_;
    std::optional<Screenshots> screenshots_;
    bool street_ = false;
};

// Example failures: a camera driver that throws ends the program; lamps stand still while the
// recording's disk is full; an output that failed once stays dark.
TEST_F(Night, each_part_fails_in_turn_while_the_others_play_on) {
    constexpr int kSeconds = 2;
    play(kSeconds);
    const auto undisturbed = play(kSeconds);
    const std::vector<std::string> things = {"left",  "right",    "lighting", "relays",   "input",
                                             "watch", "pictures", "devices",  "progress", "recording"};
    for (const std::string& broken : things) {
        SCOPED_TRACE(broken + " is out of order");
        ASSERT_GT(undisturbed.at(broken), 0) << "it was never done";
        const std::size_t faultsBefore = faults_.faults().size();
        const std::int64_t triedBefore = ledger_.tried[broken];
        ledger_.broken = broken;
        const auto meanwhile = play(kSeconds);
        EXPECT_EQ(meanwhile.at(broken), 0);
        EXPECT_GT(ledger_.tried[broken], triedBefore) << "it is tried";
        for (const std::string& other : things) {
            // A dark output has no frames to record and no picture to take.
            const bool needsOutput = (broken == "left" || broken == "right") && (other == "recording" || other == "pictures");
            // Another display leads while the first one is dark, and a window of time may hold one
            // refresh less.
            const double least = 0.9 * static_cast<double>(undisturbed.at(other)) / (needsOutput ? 2 : 1) - 1;
            if (other == broken) continue;
            EXPECT_GE(static_cast<double>(meanwhile.at(other)), least) << other;
        }
        ledger_.broken.clear();
        const auto afterwards = play(4);
        EXPECT_GT(afterwards.at(broken), 0) << "it works again";
        const auto faults = faults_.faults();
        ASSERT_GT(faults.size(), faultsBefore);
        const auto named =
            std::find_if(faults.begin() + static_cast<std::ptrdiff_t>(faultsBefore), faults.end(),
                         [](const FaultReport& fault) { return fault.what.find("out of order") != std::string::npos; });
        ASSERT_NE(named, faults.end()) << "the report says it";
        EXPECT_TRUE(named->until) << "and when it was over";
    }
    EXPECT_EQ(frames_->framesLate(), 0);
    std::vector<OutputReport> outputs = frames_->outputs();
    frames_->finish(clock_.now());
    recorder_->finish(clock_.now(), outputs);
    EXPECT_EQ(*outputs[1].recorded, outputs[1].frames) << "a recording that was held up has every frame";
}

}  // namespace
}  // namespace fantascope::app
