#pragma once

#include "app/console/console.h"
#include "app/journal/journal_keeper.h"
#include "app/keys/operator_keys.h"
#include "app/live/frame_loop.h"
#include "app/live/frame_recorder.h"
#include "app/live/hand.h"
#include "app/live/lighting.h"
#include "app/live/programme.h"
#include "app/live/recording.h"
#include "app/live/run_lights.h"
#include "app/live/run_view.h"
#include "app/live/screenshots.h"
#include "app/live/setting_up.h"
#include "app/live/show_run.h"
#include "app/live/watch.h"
#include "app/parts/fault_log.h"
#include "app/parts/part.h"
#include "app/parts/supervisor.h"
#include "app/parts/yardstick.h"
#include "app/reload/show_reload.h"
#include "app/schedule/outlook.h"
#include "app/schedule/show_caller.h"
#include "app/site/open_site.h"
#include "app/site/relay_guard.h"
#include "app/site/site_models.h"

#include "show/play/event.h"
#include "show/play/show_clock.h"

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

namespace fantascope::app {

// A running show: its parts, and what they pass to each other.
// Thread: the render thread, except where a function says otherwise.
class RunParts {
public:
    // All arguments outlive this. `recording`, `guard` and `journal` may be null.
    RunParts(const RunOptions& options, const Programme& programme, OpenSite& openSite, Recording* recording, Clock& clock,
             const std::filesystem::path& assets, Supervisor& supervisor, RelayGuard* guard, NightJournal* journal,
             const WallClock& wall);
    ~RunParts();

    // Opens the run's page, if it is to have one. `files`: the page's. Error: as Console::open().
    Result<void> openPage(const std::filesystem::path& files);
    // The parts that go on until fixtures and relays are closed. None of them waits for a display,
    // a file or a terminal.
    std::vector<Part> lightParts();
    std::vector<Part> otherParts(const std::function<void(const RunStatus&)>& progress);

    // Starts the lights' parts in real time. The stepped clock runs them together with the others.
    void startLights() { lights_.start(lightParts()); }

    // The render thread's loop. When it returns, the lights have begun to end.
    Result<void> draw();

    // Ends the show's control: relays go to their safe states, fixtures to their end levels. Never
    // waits. Thread: any.
    void endLights();
    // The functions that the supervisor needs to end the run while the render thread hangs.
    Supervisor::Run supervised();
    void awaitLights() { lights_.await(); }
    // Thread: any.
    void closeLights();
    // Tells which lights are not as they should be, and any other news. Call it once they are
    // closed.
    void tellTheRest(const std::function<void(const RunStatus&)>& progress);

    // Finishes the recording and makes the report. Call it once all parts have ended.
    RunReport report();

    const std::vector<UnsafeBank>& unsafe() const { return lights_.unsafe(); }  // once the lights are closed

private:
    void tellGuardDied(const Result<void>& another);
    RunReport reportOfLights() const;
    void tellHung(const std::string& why);
    GoSchedule schedule() const;
    void keepJournal(Time moment);
    std::unique_ptr<FrameRecorder> recorderOf(Recording* recording);
    // A reader for each output's frames; none unless `wanted`.
    template <class Add>
    std::vector<std::invoke_result_t<Add, render::FrameTap&>> readers(bool wanted, const Add& add) {
        std::vector<std::invoke_result_t<Add, render::FrameTap&>> readers;
        for (std::size_t output = 0; wanted && output < programme_.site.outputs.size(); ++output)
            readers.push_back(add(frames_.tap(output)));
        return readers;
    }
    OperatorKeys::Actions keyActions();
    Part simulatedSite();
    RunStatus statusAt(Time moment);
    show::journal::Figures figuresAt(Time moment) const;

    const RunOptions& options_;
    const Programme& programme_;
    OpenSite& openSite_;
    Clock& clock_;
    Supervisor& supervisor_;
    const WallClock& wall_;
    show::EventLog events_;
    FaultLog faults_;
    show::PlayedShow played_;
    show::InputLog inputs_;
    JournalKeeper journal_;
    FrameLoop frames_;
    std::unique_ptr<TerminalKeys> terminal_;      // null: as fast as possible, nobody presses keys
    const bool attended_;                         // somebody at the terminal can press keys
    std::vector<render::NewestFrame*> thrown_;    // what simulated projectors throw; empty if they are real
    std::unique_ptr<FrameRecorder> recorder_;     // null: nothing is recorded
    std::atomic<bool> recordingIsOpen_;           // its files are not finished yet
    std::vector<ShownLight::Frames> watched_;     // empty unless the camera watches where the pictures stand
    std::vector<render::NewestFrame*> pictured_;  // empty unless somebody at the terminal can press keys
    Result<void> prepared_;
    const show::ShowClock showClock_;  // starts with a refresh, after everything slow
    DeviceWatch deviceWatch_;          // belongs to the devices part
    Lighting lighting_;
    ShowCaller caller_;
    Outlook outlook_{played_};  // belongs to the progress part
    Hand hand_;
    Watch watch_;
    std::optional<DriftWatch> driftWatch_;
    SettingUp settingUp_;
    OperatorKeys keys_;
    RunView view_;  // belongs to the progress part
    std::optional<Screenshots> screenshots_;
    Time length_{};
    bool guardIsAway_ = false;  // belongs to the supervisor's thread
    std::int64_t framesBefore_ = 0;
    ShowReload reload_;
    Yardstick yardstick_;
    std::unique_ptr<Console> console_;  // null: there is no page
    RunLights lights_;                  // last, so that its threads end before the other members are destroyed
};

}  // namespace fantascope::app
