#pragma once

#include "app/base/report.h"
#include "app/console/press_book.h"

#include "show/play/event.h"
#include "show/play/input_log.h"
#include "show/play/playback_replica.h"
#include "show/play/show_clock.h"
#include "show/played_show.h"
#include "show/show_state.h"

#include "core/clock.h"
#include "core/result.h"
#include "web/server.h"

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

namespace fantascope::app {

// The page of a running show, and all that it does as HTTP with JSON (docs/api.md). It is served to
// this machine alone.
//
// A press counts once, however often a browser sends it, and only for half a second: what was
// pressed while the page had no connection is ignored, and the page is told so.
//
// Thread: tick() from one thread; requests come on the server's. The show waits for neither.
class Console {
public:
    static constexpr double kRate = 20;  // Hz; of tick()

    // What the page shows and moves. All of it outlives the console.
    struct Run {
        const show::PlayedShow& show;
        show::InputLog& inputs;
        const show::EventLog& events;
        const show::ShowClock showClock;
        const Clock& clock;
        std::function<Report()> health;  // what is not well; called by tick()
    };
    // `files`: the folder with the page's own. `begins`: as of web::Server. Error: a file cannot be
    // read; the address cannot be used.
    static Result<std::unique_ptr<Console>> open(const web::Server::Options& place, Run run, const std::filesystem::path& files,
                                                 const std::function<void()>& begins);

    // Tells all pages what has changed.
    void tick(Time moment);
    // "http://localhost:8080/"
    std::string address() const;

private:
    using Files = std::map<std::string, web::Response>;
    Console(Run run, Files files);

    web::Response answer(const web::Request& request);
    web::Response answerForApi(const web::Request& request);
    web::Response press(const web::Request& request);
    web::Response news(const web::Request& request);
    Report at(Time moment);  // the clock and the state
    Report lights();

    const Run run_;
    const Files files_;
    std::mutex mutex_;  // of what follows:
    show::PlaybackReplica replica_;
    show::ShowState state_;
    Report health_;
    show::EventLog::Reader events_;
    struct News {
        std::uint64_t number = 0;
        Time at{};
        std::string text;
    };
    std::deque<News> news_;
    std::uint64_t newsCount_ = 0;
    // Of tick() alone: the state that it has told last, and when. Of the server's thread alone: the
    // presses.
    std::string told_;
    Time toldAt_{};
    PressBook presses_;
    std::unique_ptr<web::Server> server_;  // last: its thread uses all others
};

}  // namespace fantascope::app
