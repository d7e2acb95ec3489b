// The page's server with a show behind it: what it tells, and what it lets a person do.

#include "app/console/console.h"

#include "app/running_show.h"

#include "program.h"
#include "source_folder.h"
#include "web/client.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <set>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

Report bodyOf(const std::string& answer) { return parseJson(answer.substr(answer.find("\r\n\r\n") + 4)); }

// Why a value is not as a schema of the OpenAPI file says: "lists[0].cue: ...". Only what that file
// uses.
std::vector<std::string> faultsOf(const Report& value, const Report& schema, const Report& all, const std::string& at) {
    if (schema.contains("$ref")) {
        const std::string name = schema["$ref"].get<std::string>();
        return faultsOf(value, all.at(name.substr(name.rfind('/') + 1)), all, at);
    }
    if (schema.contains("anyOf")) {
        for (const Report& one : schema["anyOf"])
            if (faultsOf(value, one, all, at).empty()) return {};
        return {at + ": none of anyOf"};
    }
    std::vector<std::string> faults;
    const auto isOf = [&](const std::string& type) {
        return type == "object"    ? value.is_object()
               : type == "array"   ? value.is_array()
               : type == "string"  ? value.is_string()
               : type == "boolean" ? value.is_boolean()
               : type == "null"    ? value.is_null()
               : type == "integer" ? value.is_number_integer()
                                   : value.is_number();
    };
    const Report type = schema.value("type", Report::array());
    const bool fits =
        type.is_string()
            ? isOf(type.get<std::string>())
            : type.empty() || std::ranges::any_of(type, [&](const Report& one) { return isOf(one.get<std::string>()); });
    if (!fits) return {fmt::format("{}: {} is no {}", at, value.dump(), type.dump())};
    for (const Report& key : schema.value("required", Report::array()))
        if (!value.contains(key.get<std::string>()))
            faults.push_back(fmt::format("{}: '{}' is missing", at, key.get<std::string>()));
    if (value.is_object() && schema.contains("properties"))
        for (const auto& [key, below] : value.items()) {
            if (!schema["properties"].contains(key)) {
                faults.push_back(fmt::format("{}: '{}' is not told of", at, key));
                continue;
            }
            for (std::string& fault : faultsOf(below, schema["properties"][key], all, at + "." + key))
                faults.push_back(std::move(fault));
        }
    if (value.is_array() && schema.contains("items"))
        for (const Report& below : value)
            for (std::string& fault : faultsOf(below, schema["items"], all, at + "[]")) faults.push_back(std::move(fault));
    return faults;
}

class Page : public testing::Test {
protected:
    Page() {
        const Console::Run run{run_.played, run_.inputs, run_.events, show::ShowClock(), run_.clock, [this] { return health_; }};
        auto opened = Console::open({}, run, std::filesystem::path(sourceFolder()) / "assets/page", {});
        FANTASCOPE_CHECK(opened.has_value(), opened ? "" : opened.error().message());
        console_ = std::move(opened).value();
        const std::string address = console_->address();
        port_ = std::stoi(address.substr(address.rfind(':') + 1));
        run_.clock.advance(10s);
        console_->tick(run_.clock.now());
    }
    std::string get(const std::string& path) const { return web::get(port_, path); }
    std::string post(const std::string& body, const std::string& more = "Content-Type: application/json\r\n") const {
        return web::ask(
            port_,
            fmt::format("POST /api/v1/inputs HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n{}Content-Length: {}\r\n\r\n{}",
                        more, body.size(), body));
    }
    Report press(const Report& wish) const { return bodyOf(post(wish.dump())); }
    Report state() const { return bodyOf(get("/api/v1/state"))["state"]; }

    RunningShow run_;
    Report health_{{"unwell", Report::array()}, {"late", 0}};
    std::unique_ptr<Console> console_;
    int port_ = 0;
};

TEST_F(Page, tells_what_plays_what_comes_and_when) {
    const Report before = state()["lists"][0];
    EXPECT_EQ(before["cue"], Report());
    EXPECT_EQ(before["go"]["name"], run_.show.cues[0].name);
    EXPECT_EQ(press({{"do", "go"}}), (Report{{"taken", true}, {"outcome", "taken"}, {"at", 10.0}}));
    const Report moment = bodyOf(get("/api/v1/state")), now = moment["state"]["lists"][0];
    EXPECT_EQ(now["cue"]["name"], run_.show.cues[0].name);
    EXPECT_EQ(now["go"]["number"], "2");
    EXPECT_EQ(now["fades_until"], 10 + seconds(run_.cues.cues[0].length())) << "in cue time";
    EXPECT_EQ(moment["clock"], (Report{{"show", 10.0}, {"cue", 10.0}, {"moves", true}}));
    press({{"do", "pause"}});
    run_.clock.advance(5s);
    EXPECT_EQ(bodyOf(get("/api/v1/state"))["clock"], (Report{{"show", 15.0}, {"cue", 10.0}, {"moves", false}}));
}

TEST_F(Page, pushes_a_state_only_when_something_has_happened) {
    web::Client client(port_);
    client.send("GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_THAT(client.receiveUntil("\n\n"), HasSubstr("text/event-stream"));
    for (int tick = 0; tick < 20; ++tick) {
        run_.clock.advance(50ms);
        console_->tick(run_.clock.now());
    }
    press({{"do", "blackout"}, {"on", true}});
    console_->tick(run_.clock.now());
    const std::string pushed = client.receiveUntil("\"blackout\":true");
    EXPECT_EQ(pushed.find("\"blackout\":false", pushed.find("\"blackout\":false") + 1), std::string::npos)
        << "a second without news is told at most once, as the first state: " << pushed;
}

// Example failure: the phone sends a press again because the answer was lost, and two cues are
// entered.
TEST_F(Page, counts_a_press_once_however_often_it_comes) {
    const Report first = press({{"do", "go"}, {"press", "a-1"}});
    run_.clock.advance(5s);
    EXPECT_EQ(press({{"do", "go"}, {"press", "a-1"}}), first);
    EXPECT_EQ(state()["lists"][0]["cue"]["index"], 0);
    EXPECT_EQ(press({{"do", "go"}, {"press", "a-2"}})["taken"], true);
    EXPECT_EQ(state()["lists"][0]["cue"]["index"], 1);
}

TEST_F(Page, never_fires_what_was_pressed_while_it_had_no_connection) {
    const Report late = press({{"do", "go"}, {"at", 9.4}});
    EXPECT_EQ(late["taken"], false);
    EXPECT_THAT(late["outcome"].get<std::string>(), HasSubstr("pressed while the machine was busy"));
    EXPECT_EQ(state()["lists"][0]["cue"], Report());
    EXPECT_EQ(press({{"do", "go"}, {"at", 9.6}})["taken"], true);
    EXPECT_EQ(press({{"do", "blackout"}, {"on", true}, {"at", 1}})["taken"], true) << "darkness comes however late it is";
}

TEST_F(Page, lets_nobody_else_in) {
    const auto asked = [&](const std::string& header) {
        return web::ask(port_, "GET / HTTP/1.1\r\nConnection: close\r\n" + header + "\r\n");
    };
    EXPECT_THAT(asked("Host: localhost\r\n"), StartsWith("HTTP/1.1 200"));
    EXPECT_THAT(asked("Host: evil.example\r\n"), StartsWith("HTTP/1.1 421")) << "a name that leads here for a moment";
    const std::string json = "Content-Type: application/json\r\n";
    EXPECT_THAT(post("{\"do\":\"go\"}", json + "Origin: http://evil.example\r\n"), StartsWith("HTTP/1.1 403"));
    EXPECT_THAT(post("{\"do\":\"go\"}", json + "Sec-Fetch-Site: cross-site\r\n"), StartsWith("HTTP/1.1 403"));
    EXPECT_THAT(post("{\"do\":\"go\"}", "Content-Type: text/plain\r\n"), StartsWith("HTTP/1.1 415")) << "a form of another site";
    EXPECT_EQ(state()["inputs"], 0);
}

TEST_F(Page, may_load_nothing_from_elsewhere) {
    EXPECT_THAT(get("/"), AllOf(HasSubstr("default-src 'none'"), HasSubstr("frame-ancestors 'none'"), HasSubstr("nosniff")));
    EXPECT_THAT(get("/page.js"), HasSubstr("text/javascript"));
    EXPECT_THAT(get("/../../etc/passwd"), StartsWith("HTTP/1.1 404"));
    EXPECT_THAT(get("/%2e%2e/%2e%2e/etc/passwd"), StartsWith("HTTP/1.1 404"));
}

TEST_F(Page, says_what_is_wrong_with_a_wish) {
    const auto refusal = [&](const std::string& body) {
        return post(body).substr(9, 3) + " " + bodyOf(post(body)).value("error", "");
    };
    EXPECT_THAT(refusal("{"), StartsWith("400"));
    EXPECT_THAT(refusal("[1]"), StartsWith("400"));
    EXPECT_THAT(refusal(std::string(20000, '[')), StartsWith("400"));
    EXPECT_THAT(refusal(R"({"do":"og"})"), HasSubstr("422 'do' is one of go, back"));
    EXPECT_THAT(refusal(R"({"do":7})"), HasSubstr("422 'do' is one of"));
    EXPECT_THAT(refusal(R"({"do":"jump"})"), HasSubstr("'cue' is missing"));
    EXPECT_THAT(refusal(R"({"do":"jump","cue":3})"), HasSubstr("'cue' is a text"));
    EXPECT_THAT(refusal(R"({"do":"jump","cue":"99"})"), HasSubstr("no cue is called '99'"));
    EXPECT_THAT(refusal(R"({"do":"master","level":1.5})"), HasSubstr("'level' is a number from 0 to 1"));
    EXPECT_THAT(refusal(R"({"do":"blackout","on":1})"), HasSubstr("'on' is true or false"));
    EXPECT_THAT(refusal(R"({"do":"go","lamp":"gate"})"), HasSubstr("'lamp' is not known here"));
    EXPECT_THAT(refusal(R"({"do":"go","press":"" })"), StartsWith("200")) << "an empty one is none";
    EXPECT_THAT(refusal(R"({"do":"go","at":"now"})"), StartsWith("400"));
}

TEST_F(Page, tells_the_news_since_the_last) {
    run_.events.append({1s, show::event::HoldChanged{show::Hold::Blackout, true}});
    run_.events.append({2s, show::event::HoldChanged{show::Hold::Blackout, false}});
    console_->tick(run_.clock.now());
    EXPECT_EQ(state()["news"], 2);
    const Report news = bodyOf(get("/api/v1/news?after=1"))["news"];
    ASSERT_EQ(news.size(), 1u);
    EXPECT_EQ(news[0], (Report{{"number", 2}, {"at", 2.0}, {"text", "light: the blackout is over"}}));
}

// A name that a stranger sends over the network need not be text.
TEST_F(Page, lives_through_what_is_no_text) {
    health_["unwell"].push_back({{"device", "dmx"}, {"what", "sent by '\xff\xfe'"}});
    run_.clock.advance(1s);
    console_->tick(run_.clock.now());
    EXPECT_THAT(state()["health"]["unwell"][0]["what"].get<std::string>(), StartsWith("sent by '"));
}

// The OpenAPI file says all that there is, and all that it says is there.
TEST_F(Page, is_as_its_openapi_file_says) {
    const Report file = bodyOf(get("/api/v1/openapi.json"));
    const Report& schemas = file["components"]["schemas"];
    press({{"do", "go"}});
    press({{"do", "highlight"}, {"lamp", run_.site.fixtures[0].name}});
    press({{"do", "raise"}, {"lamp", run_.site.fixtures[0].name}, {"level", 0.5}});
    press({{"do", "park"}, {"lamp", run_.site.fixtures[0].name}});
    press({{"do", "switch"}, {"relay", run_.site.relays[0].name}, {"on", true}});
    health_["unwell"].push_back({{"device", "dmx"}, {"what", "lost"}});
    run_.events.append({1s, show::event::ScheduleEnded{}});
    console_->tick(run_.clock.now());
    for (const auto& [path, methods] : file["paths"].items()) {
        if (path == "/api/v1/events") continue;  // it never ends
        for (const auto& [method, told] : methods.items()) {
            const std::string answer = method == "get" ? get(path) : post(R"({"do":"master","level":1})");
            EXPECT_THAT(answer, StartsWith("HTTP/1.1 200")) << path;
            const Report& schema = told["responses"]["200"]["content"]["application/json"]["schema"];
            EXPECT_THAT(faultsOf(bodyOf(answer), schema, schemas, path), IsEmpty());
        }
    }
    // Each wish that it lists is known, and no other.
    std::set<std::string> listed;
    for (const Report& wish : schemas["Wish"]["properties"]["do"]["enum"]) listed.insert(wish.get<std::string>());
    std::string known = press({{"do", "?"}})["error"].get<std::string>();
    known.erase(0, known.find("of ") + 3);
    for (std::size_t comma; !known.empty(); known.erase(0, comma == std::string::npos ? known.size() : comma + 2)) {
        comma = known.find(", ");
        EXPECT_EQ(listed.erase(known.substr(0, comma)), 1u) << known;
    }
    EXPECT_THAT(listed, IsEmpty());
}

// Example failure: a page that was to be on another machine is at 127.0.0.1, and nobody is told.
TEST(PlaceOfThePage, that_it_cannot_have_is_refused_with_what_to_write) {
    const ScratchFolder folder;
    const auto refusal = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words{"rehearse"};
        words.insert(words.end(), more.begin(), more.end());
        const Outcome outcome = runProgram(words, folder.path());
        EXPECT_NE(outcome.status, 0);
        return outcome.errors;
    };
    EXPECT_THAT(refusal({"--console", "0.0.0.0:8080"}), HasSubstr("for this machine alone: write localhost:8080"));
    EXPECT_THAT(refusal({"--console", "wall.example:8080"}), HasSubstr("for this machine alone"));
    EXPECT_THAT(refusal({"--console", "localhost:99999"}), HasSubstr("has no port: write localhost:8080"));
    EXPECT_THAT(refusal({"--console", "localhost:"}), HasSubstr("has no port"));
    EXPECT_THAT(refusal({"--console", "shows"}), HasSubstr("has no port"));
    EXPECT_THAT(refusal({"--as-fast-as-possible", "--console"}), HasSubstr("--console needs real time"));
}

}  // namespace
}  // namespace fantascope::app
