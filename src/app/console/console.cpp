#include "app/console/console.h"

#include "app/console/input_json.h"
#include "app/console/show_json.h"
#include "app/keys/lateness.h"

#include "core/file.h"
#include "web/same_site.h"

#include <fmt/format.h>

#include <charconv>
#include <utility>

namespace fantascope::app {

namespace {

constexpr std::size_t kNewsKept = 200;
constexpr const char* kEvents = "state";            // the channel
constexpr Time kRepeat = std::chrono::seconds(15);  // a page's clock may drift so long

// Everything that the page may load comes from here, and nobody else may show it.
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; manifest-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

constexpr struct {
    const char *path, *file, *type;
} kPage[] = {{"/", "index.html", "text/html; charset=utf-8"},
             {"/page.css", "page.css", "text/css; charset=utf-8"},
             {"/page.js", "page.js", "text/javascript; charset=utf-8"},
             {"/icon.svg", "icon.svg", "image/svg+xml"},
             {"/page.webmanifest", "page.webmanifest", "application/manifest+json"},
             {"/api/v1/openapi.json", "openapi.json", "application/json"}};

web::Response json(int status, const Report& report) {
    web::Response response = web::Response::of(status, "application/json", jsonText(report));
    response.more.emplace_back("Cache-Control", "no-store");
    return response;
}
web::Response refused(int status, const std::string& why) { return json(status, {{"error", why}}); }

}  // namespace

Console::Console(Run run, Files files)
    : run_(std::move(run)), files_(std::move(files)), replica_(run_.inputs), events_(run_.events.reader()) {}

Result<std::unique_ptr<Console>> Console::open(const web::Server::Options& place, Run run, const std::filesystem::path& files,
                                               const std::function<void()>& begins) {
    Files page;
    for (const auto& [path, file, type] : kPage) {
        web::Response response = web::Response::of(200, type, TRY(readFile(files / file, kMaxFileBytes)));
        response.more = {{"Cache-Control", "no-cache"},
                         {"Content-Security-Policy", kPolicy},
                         {"X-Content-Type-Options", "nosniff"},
                         {"Referrer-Policy", "no-referrer"}};
        page.emplace(path, std::move(response));
    }
    std::unique_ptr<Console> console(new Console(std::move(run), std::move(page)));
    console->server_ = TRY(web::Server::open(
        place, [self = console.get()](const web::Request& request) { return self->answer(request); }, begins));
    return console;
}

std::string Console::address() const { return fmt::format("http://localhost:{}/", server_->port()); }

web::Response Console::answer(const web::Request& request) {
    if (!web::isForThisMachine(request)) return refused(421, "this page is at localhost");
    const bool reads = request.method == "GET" || request.method == "HEAD";
    if (!reads && !web::isFromOwnPage(request)) return refused(403, "this comes from another site");
    if (const auto file = files_.find(request.path); file != files_.end())
        return reads ? file->second : refused(405, "this can only be read");
    return answerForApi(request);
}

web::Response Console::answerForApi(const web::Request& request) {
    const bool reads = request.method == "GET" || request.method == "HEAD";
    const auto only = [&](bool isIt, auto&& answer) { return isIt ? answer() : refused(405, "this path takes another method"); };
    if (request.path == "/api/v1/inputs") return only(request.method == "POST", [&] { return press(request); });
    if (request.path == "/api/v1/state") return only(reads, [&] { return json(200, at(run_.clock.now())); });
    if (request.path == "/api/v1/cues") return only(reads, [&] { return json(200, cuesJson(run_.show.newest())); });
    if (request.path == "/api/v1/lights") return only(reads, [&] { return json(200, lights()); });
    if (request.path == "/api/v1/news") return only(reads, [&] { return news(request); });
    if (request.path == "/api/v1/events")
        return only(reads, [&] {
            web::Response response{.type = "text/event-stream", .more = {{"Cache-Control", "no-store"}}};
            response.channel = kEvents;
            return response;
        });
    return refused(404, "there is no such path; /api/v1/openapi.json has all of them");
}

web::Response Console::press(const web::Request& request) {
    if (!request.contentType.starts_with("application/json")) return refused(415, "the body is application/json");
    const Report wish = parseJson(request.body);
    if (!wish.is_object()) return refused(400, "the body is an object: {\"do\": \"go\"}");
    const auto valueOf = [&](const char* key) { return wish.contains(key) ? wish.at(key) : Report(); };
    const Report id = valueOf("press"), at = valueOf("at");
    if (!(id.is_null() || id.is_string()) || !(at.is_null() || at.is_number()))
        return refused(400, "'press' is a text, and 'at' a show time in seconds");
    const std::string press = id.is_null() ? "" : id.get<std::string>();
    if (press.size() > 64) return refused(400, "'press' has at most 64 characters");
    if (const std::string* const before = presses_.answerTo(press)) return web::Response::of(200, "application/json", *before);

    const auto still = run_.show.still();
    auto input = inputFrom(wish, run_.show.newest());
    if (!input) return refused(422, input.error().message());
    input->at = run_.showClock.showTime(run_.clock.now());
    input->source = show::Input::Source::Page;
    input->late = !at.is_null() && seconds(input->at) - at.get<double>() > seconds(Lateness::kTooLate);
    const show::Outcome outcome = run_.inputs.submit(*input).outcome;
    const Report answer{
        {"taken", outcome == show::Outcome::Taken}, {"outcome", show::nameOf(outcome)}, {"at", seconds(input->at)}};
    presses_.note(press, jsonText(answer));
    return json(200, answer);
}

web::Response Console::news(const web::Request& request) {
    std::uint64_t after = 0;
    const std::string_view asked = request.part("after");
    std::from_chars(asked.data(), asked.data() + asked.size(), after);
    Report list = Report::array();
    const std::lock_guard lock(mutex_);
    for (const auto& [number, at, text] : news_)
        if (number > after) list.push_back({{"number", number}, {"at", seconds(at)}, {"text", text}});
    return json(200, {{"news", std::move(list)}});
}

Report Console::at(Time moment) {
    const std::lock_guard lock(mutex_);
    replica_.stateAt(run_.showClock.showTime(moment), state_);
    Report state = stateJson(state_, replica_.playback(), run_.show.at(state_.revision));
    state["health"] = health_;
    state["news"] = newsCount_;
    return {{"clock", clockJson(state_, replica_.playback())}, {"state", std::move(state)}};
}

Report Console::lights() {
    const std::lock_guard lock(mutex_);
    replica_.stateAt(run_.showClock.showTime(run_.clock.now()), state_);
    return lightsJson(state_, run_.show.at(state_.revision));
}

void Console::tick(Time moment) {
    Report health = run_.health();
    {
        const std::lock_guard lock(mutex_);
        health_ = std::move(health);
        while (const show::Event* const event = events_.next()) {
            std::string text = show::sentenceOf(*event);
            if (text.empty()) continue;
            news_.push_back({++newsCount_, event->at, std::move(text)});
            if (news_.size() > kNewsKept) news_.pop_front();
        }
    }
    const Report now = at(moment);
    std::string state = jsonText(now["state"]);
    if (state == told_ && moment - toldAt_ < kRepeat) return;
    told_ = std::move(state);
    toldAt_ = moment;
    server_->publish(kEvents, jsonText(now));
}

}  // namespace fantascope::app
