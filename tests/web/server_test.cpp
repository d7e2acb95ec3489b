// The server against clients that send what they like.

#include "web/server.h"

#include "core/random.h"
#include "web/client.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <thread>
#include <vector>

namespace fantascope::web {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

Server::Options options() {
    Server::Options options;
    options.bodyBytes = 1000;
    options.headerBytes = 2000;
    options.connections = 40;
    options.connectionsOfOne = 20;
    return options;
}

// Tells what it was asked; /events is a stream.
Response echo(const Request& request) {
    if (request.path == "/events") {
        Response response{.type = "text/event-stream"};
        response.channel = "state";
        return response;
    }
    std::string query;
    for (const auto& [key, value] : request.query) query += fmt::format("[{}={}]", key, value);
    return Response::of(200, "text/plain", fmt::format("{} {} {} {}", request.method, request.path, query, request.body));
}

class ServerPart : public testing::Test {
protected:
    void open(const Server::Options& how) {
        auto opened = Server::open(how, echo);
        ASSERT_TRUE(opened) << opened.error().message();
        server_ = std::move(opened).value();
    }
    void SetUp() override { open(options()); }
    std::string asked(const std::string& request) { return ask(server_->port(), request); }
    bool comesTrue(const auto& condition) {
        SteadyClock clock;
        for (const Time deadline = clock.now() + 30s; !condition(); clock.sleepUntil(clock.now() + 1ms))
            if (clock.now() > deadline) return false;
        return true;
    }
    std::unique_ptr<Server> server_;
};

TEST_F(ServerPart, answers_what_was_asked) {
    EXPECT_THAT(get(server_->port(), "/a%20b?c=d%26&e"), AllOf(StartsWith("HTTP/1.1 200 OK"), EndsWith("GET /a b [c=d&][e=] ")));
    EXPECT_THAT(asked("POST /x HTTP/1.1\r\nHost: a\r\nConnection: close\r\nContent-Length: 3\r\n\r\nabc"),
                EndsWith("POST /x  abc"));
    EXPECT_THAT(asked("HEAD /x HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n"),
                AllOf(HasSubstr("Content-Length: 9"), EndsWith("\r\n\r\n")))
        << "no body";
}

TEST_F(ServerPart, answers_several_requests_on_one_connection) {
    Client client(server_->port());
    client.send("GET /one HTTP/1.1\r\nHost: a\r\n\r\nGET /two HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n");
    EXPECT_THAT(client.receiveAll(), AllOf(HasSubstr("GET /one"), HasSubstr("GET /two")));
}

TEST_F(ServerPart, refuses_what_is_too_large_or_no_request) {
    EXPECT_THAT(asked("POST /x HTTP/1.1\r\nContent-Length: 1001\r\n\r\n"), StartsWith("HTTP/1.1 413"));
    EXPECT_THAT(asked("GET / HTTP/1.1\r\nA: " + std::string(3000, 'a') + "\r\n\r\n"), StartsWith("HTTP/1.1 431"));
    EXPECT_THAT(asked("nonsense\r\n\r\n"), StartsWith("HTTP/1.1 400"));
    EXPECT_THAT(get(server_->port(), "x"), StartsWith("HTTP/1.1 400")) << "no path";
    EXPECT_THAT(get(server_->port(), "/%00"), StartsWith("HTTP/1.1 400"));
    EXPECT_THAT(get(server_->port(), "/%zz"), StartsWith("HTTP/1.1 400"));
    EXPECT_THAT(get(server_->port(), "/still"), StartsWith("HTTP/1.1 200"));
}

// Example failure: a page that comes later sees nothing until something happens.
TEST_F(ServerPart, pushes_what_is_published_and_the_newest_at_once) {
    server_->publish("state", "first");
    server_->publish("state", "second");
    server_->publish("other", "not this");
    Client client(server_->port());
    client.send("GET /events HTTP/1.1\r\nHost: a\r\n\r\n");
    EXPECT_THAT(client.receiveUntil("data: second\n\n"),
                AllOf(HasSubstr("text/event-stream"), Not(HasSubstr("first")), Not(HasSubstr("not this"))));
    server_->publish("state", "two\nlines");
    EXPECT_EQ(client.receiveUntil("lines\n\n"), "data: two\ndata: lines\n\n");
}

TEST_F(ServerPart, says_that_it_lives_while_nothing_happens) {
    Server::Options quick = options();
    quick.keepAlive = 20ms;
    open(quick);
    Client client(server_->port());
    client.send("GET /events HTTP/1.1\r\nHost: a\r\n\r\n");
    EXPECT_THAT(client.receiveUntil("event: alive"), HasSubstr("event: alive"));
}

// The show must not wait for a phone that is out of reach.
TEST_F(ServerPart, waits_for_no_client_and_gives_the_newest_to_a_slow_one) {
    Client slow(server_->port());
    slow.send("GET /events HTTP/1.1\r\nHost: a\r\n\r\n");
    ASSERT_TRUE(comesTrue([&] { return server_->listeners() == 1; }));
    const std::string large(100'000, 'x');
    for (int i = 0; i < 500; ++i) server_->publish("state", fmt::format("{} {}", large, i));  // 50 MB, of which nobody reads any
    server_->publish("state", "the end");
    const std::string read = slow.receiveUntil("data: the end\n\n");
    EXPECT_THAT(read, EndsWith("data: the end\n\n"));
    EXPECT_LT(read.size(), 100 * large.size()) << "it has missed most of them";
}

TEST_F(ServerPart, drops_who_sends_a_byte_now_and_then) {
    Server::Options strict = options();
    strict.patience = 300ms;
    open(strict);
    Client loris(server_->port()), idle(server_->port());
    std::jthread drips([&](const std::stop_token& stop) {
        SteadyClock clock;
        while (!stop.stop_requested()) {
            loris.send("G");
            clock.sleepUntil(clock.now() + 20ms);
        }
    });
    EXPECT_TRUE(comesTrue([&] { return server_->connections() == 2; }));
    EXPECT_TRUE(comesTrue([&] { return server_->connections() == 0; })) << "a byte does not buy more time";
}

TEST_F(ServerPart, takes_no_more_connections_than_it_may) {
    std::vector<std::unique_ptr<Client>> many;
    for (int i = 0; i < 200; ++i) many.push_back(std::make_unique<Client>(server_->port()));
    EXPECT_TRUE(comesTrue([&] { return server_->connections() == 20; }));
    many.back()->receiveAll();
    EXPECT_TRUE(many.back()->isClosed());
    many.clear();
    EXPECT_TRUE(comesTrue([&] { return server_->connections() == 0; }));
    EXPECT_THAT(get(server_->port(), "/still"), StartsWith("HTTP/1.1 200"));
}

// Whatever comes, the next request is answered.
TEST_F(ServerPart, lives_through_random_bytes) {
    Rng rng(5);
    const std::string good =
        "POST /x?y=z HTTP/1.1\r\nHost: a\r\nContent-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n0\r\n\r\n";
    for (int i = 0; i < 3000; ++i) {
        std::string bytes = good;
        for (std::uint32_t change = 0; change < 1 + rng.below(4); ++change)
            bytes[rng.below(static_cast<std::uint32_t>(bytes.size()))] = static_cast<char>(rng.below(256));
        bytes.resize(rng.below(static_cast<std::uint32_t>(bytes.size())) + 1);
        Client(server_->port()).send(bytes);
    }
    EXPECT_THAT(get(server_->port(), "/still"), StartsWith("HTTP/1.1 200"));
    EXPECT_TRUE(comesTrue([&] { return server_->connections() == 0; }));
}

TEST_F(ServerPart, says_why_it_cannot_be_at_an_address) {
    Server::Options taken = options();
    taken.port = server_->port();
    EXPECT_THAT(Server::open(taken, echo).error().message(), HasSubstr("Address already in use"));
    Server::Options nowhere = options();
    nowhere.address = "somewhere";
    EXPECT_THAT(Server::open(nowhere, echo).error().message(), HasSubstr("'somewhere' is no address"));
}

}  // namespace
}  // namespace fantascope::web
