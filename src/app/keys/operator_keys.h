#pragma once

#include "app/base/terminal_keys.h"
#include "app/keys/edit_keys.h"
#include "app/keys/go_schedule.h"
#include "app/keys/lateness.h"
#include "app/keys/run_keys.h"

#include "show/play/event.h"
#include "show/play/input_log.h"
#include "show/play/playback_replica.h"
#include "show/play/show_clock.h"

#include "device/screen_event.h"

#include "core/append_log.h"
#include "core/clock.h"

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::app {

// The keys that control a running show, at the terminal and at the displays' windows; and the
// schedule that presses GO until a person takes over, by a key or at the page.
// Thread: the input thread, except where a function says otherwise.
class OperatorKeys {
public:
    // What keys and schedule do besides inputs. Called on the input thread.
    struct Actions {
        std::function<bool(const Key&)> setUp;  // true: setting up has taken the key
        std::function<bool()> pressGo;          // presses the simulated controller's GO; false: there is none
        std::function<void()> takePictures;
        std::function<void()> end;
        std::function<std::string()> nextDay;  // what the show's schedule brings, in lines; empty: there is none
        std::function<std::string(const show::ShowState&)> howItIs;  // in lines
        std::vector<std::string> relays{};                           // their names, in the site's order
    };
    // The logs outlive this. `terminal`: null if nobody can press a key there.
    OperatorKeys(show::InputLog& inputs, show::EventLog& events, const show::ShowClock& showClock,
                 std::unique_ptr<TerminalKeys> terminal, GoSchedule schedule, QuitKey quitKey, Actions actions);

    void tick(Time moment);  // as often as Hand::tick()
    // Takes a key that was pressed at a window at `moment`. Thread: any.
    void pressedAtScreen(const Key& key, Time moment) { screenKeys_.append({key, moment}); }

    // The list that the keys for cues go to, as Input::list. Thread: any.
    int list() const { return list_; }
    // The run time of the schedule's next press; Time::max() if there is none. Thread: any.
    Time nextGo() const { return nextGo_; }
    // Restores the terminal's settings. Call it after the last tick.
    void close() { terminal_.reset(); }

private:
    struct Press {
        Key key{};
        Time moment{};
    };
    void press(const Key& key, show::Input::Source source, Time moment);
    void takeOver(const show::Input& input);
    void endSchedule(Time at);
    void load(show::Input input, int step);
    void chooseList(Time at);
    void tellAll(Time at);
    void dim(show::Input input, int step);
    void light(show::Input input, RunKey::Action action);
    void chooseRelay(Time at);
    void switchRelay(show::Input input);

    show::InputLog& inputs_;
    show::PlaybackReplica replica_;
    show::ShowState state_;
    show::InputLog::Reader others_;  // for what somebody asks at the page
    show::EventLog& events_;
    const show::ShowClock showClock_;
    std::unique_ptr<TerminalKeys> terminal_;
    TerminalKeyParser parser_;
    AppendLog<Press> screenKeys_;
    AppendLog<Press>::Reader pressedAtScreens_ = screenKeys_.reader();
    Lateness lateness_;
    GoSchedule schedule_;
    std::atomic<Time> nextGo_ = Time::max();
    std::atomic<int> list_ = 0;
    int relay_ = -1;  // that the key switches; -1: none yet
    QuitKey quitKey_;
    const Actions actions_;
};

}  // namespace fantascope::app
