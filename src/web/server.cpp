#include "web/server.h"

#include "web/uri.h"

#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <fmt/format.h>

#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <thread>
#include <utility>
#include <vector>

namespace fantascope::web {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::system::error_code;
using tcp = asio::ip::tcp;
using asio::use_awaitable;

namespace {

using Event = std::shared_ptr<const std::string>;

// The newest event of a channel, and how many there were.
struct Channel {
    Event newest;  // as it is sent; null: there is none yet
    std::uint64_t count = 0;
};

// An event as it is sent: each line has its field name.
std::string framed(std::string_view event) {
    std::string text;
    while (true) {
        const std::size_t end = std::min(event.find('\n'), event.size());
        text += fmt::format("data: {}\n", event.substr(0, end));
        if (end == event.size()) return text + "\n";
        event.remove_prefix(end + 1);
    }
}

const Event kAlive = std::make_shared<const std::string>("event: alive\ndata: .\n\n");  // says nothing more

// Counts something as long as it lives.
template <class Count>
class Counted {
public:
    explicit Counted(Count& count) : count_(count) { ++count_; }
    ~Counted() { --count_; }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;

private:
    Count& count_;
};

std::string textOf(beast::string_view text) { return std::string(text.data(), text.size()); }

}  // namespace

class Server::Implementation {
public:
    Implementation(Options options, Handler handler) : options_(std::move(options)), handler_(std::move(handler)) {}

    Result<void> listen() {
        error_code failed;
        const auto address = asio::ip::make_address(options_.address, failed);
        if (failed) return Error(fmt::format("'{}' is no address of this machine: write one like 127.0.0.1", options_.address));
        const tcp::endpoint place(address, static_cast<unsigned short>(options_.port));
        acceptor_.open(place.protocol(), failed);
        if (!failed) acceptor_.set_option(tcp::acceptor::reuse_address(true), failed);
        if (!failed) acceptor_.bind(place, failed);
        if (!failed) acceptor_.listen(asio::socket_base::max_listen_connections, failed);
        if (failed)
            return Error(fmt::format("the page cannot be at {}:{}: {}", options_.address, options_.port, failed.message()));
        port_ = acceptor_.local_endpoint().port();
        return {};
    }
    void start(const std::function<void()>& begins) {
        asio::co_spawn(io_, accept(), asio::detached);
        thread_ = std::jthread([this, begins] {
            if (begins) begins();
            io_.run();
        });
    }
    void stop() {
        io_.stop();
        if (thread_.joinable()) thread_.join();
    }

    int port() const { return port_; }
    std::size_t connections() const { return connections_; }
    std::size_t listeners() const { return listeners_; }

    void publish(const std::string& channel, std::string event) {
        auto sent = std::make_shared<const std::string>(framed(event));
        {
            const std::lock_guard lock(mutex_);
            Channel& to = channels_[channel];
            to.newest = std::move(sent);
            ++to.count;
        }
        asio::post(io_, [this] {  // whoever waits for it looks
            for (asio::steady_timer* const waits : waiting_) waits->cancel();
        });
    }

private:
    asio::awaitable<void> accept() {
        for (;;) {
            error_code failed;
            tcp::socket socket = co_await acceptor_.async_accept(asio::redirect_error(use_awaitable, failed));
            if (failed == asio::error::no_descriptors) {
                asio::steady_timer pause(io_, std::chrono::milliseconds(100));
                co_await pause.async_wait(asio::redirect_error(use_awaitable, failed));
                continue;
            }
            if (failed) continue;
            const auto end = socket.remote_endpoint(failed);
            if (failed) continue;
            const std::string peer = end.address().to_string();
            std::erase_if(ofOne_, [](const auto& each) { return each.second == 0; });
            if (connections_ >= options_.connections || ofOne_[peer] >= options_.connectionsOfOne) continue;  // closes it
            socket.set_option(tcp::no_delay(true), failed);
            asio::co_spawn(io_, serve(beast::tcp_stream(std::move(socket)), peer, end.address().is_loopback()), asio::detached);
        }
    }

    // Serves one connection until it ends.
    asio::awaitable<void> serve(beast::tcp_stream stream, std::string peer, bool isLocal) {
        const Counted counted(connections_);
        const Counted ofThisOne(ofOne_[peer]);
        beast::flat_buffer buffer;
        for (bool goesOn = true; goesOn;) {
            http::request_parser<http::string_body> parser;
            parser.header_limit(static_cast<std::uint32_t>(options_.headerBytes));
            parser.body_limit(options_.bodyBytes);
            error_code failed;
            stream.expires_after(options_.patience);
            co_await http::async_read(stream, buffer, parser, asio::redirect_error(use_awaitable, failed));
            const std::optional<int> refused = refusalOf(failed);
            if (failed && !refused) break;
            const auto& message = parser.get();
            const unsigned version = message.version() == 10 ? 10 : 11;
            goesOn = !refused && message.keep_alive();
            Response response = refused ? Response::of(*refused, "text/plain", "") : answer(message, isLocal);
            const bool isHead = !refused && message.method() == http::verb::head;
            if (!response.channel.empty() && !isHead) {
                co_await push(stream, response);
                break;
            }
            stream.expires_after(options_.patience);
            if (!co_await write(stream, response, version, goesOn, isHead)) break;
        }
        error_code ignored;
        stream.socket().shutdown(tcp::socket::shutdown_both, ignored);
    }

    // The status for what was wrong with a request; nothing: there is nobody to tell.
    static std::optional<int> refusalOf(const error_code& failed) {
        if (!failed || failed.category() != http::make_error_code(http::error::end_of_stream).category()) return std::nullopt;
        if (failed == http::error::end_of_stream || failed == http::error::partial_message) return std::nullopt;
        if (failed == http::error::body_limit) return 413;
        if (failed == http::error::header_limit) return 431;
        return 400;
    }

    Response answer(const http::request<http::string_body>& message, bool isLocal) {
        Request request;
        request.method = textOf(message.method_string());
        const auto target = splitTarget(std::string_view(message.target().data(), message.target().size()));
        if (!target) return Response::of(400, "text/plain", "");
        request.path = target->path;
        request.query = target->query;
        request.body = message.body();
        const auto field = [&](http::field name) { return textOf(message[name]); };
        request.contentType = field(http::field::content_type);
        request.host = field(http::field::host);
        request.origin = field(http::field::origin);
        request.fetchSite = textOf(message["Sec-Fetch-Site"]);
        request.isLocal = isLocal;
        return handler_(request);
    }

    template <class Body>
    static http::response<Body> headOf(const Response& response, unsigned version, bool goesOn) {
        http::response<Body> head;
        head.version(version);
        head.result(static_cast<unsigned>(response.status));
        head.set(http::field::content_type, response.type);
        for (const auto& [name, value] : response.more) head.set(name, value);
        head.keep_alive(goesOn);
        return head;
    }

    static asio::awaitable<bool> write(beast::tcp_stream& stream, const Response& response, unsigned version, bool goesOn,
                                       bool isHead) {
        using View = http::span_body<const char>;
        auto message = headOf<View>(response, version, goesOn);
        if (response.body) message.body() = beast::span<const char>(response.body->data(), response.body->size());
        message.content_length(response.body ? response.body->size() : 0);
        http::response_serializer<View> serializer(message);
        error_code failed;
        if (isHead)
            co_await http::async_write_header(stream, serializer, asio::redirect_error(use_awaitable, failed));
        else
            co_await http::async_write(stream, serializer, asio::redirect_error(use_awaitable, failed));
        co_return !failed;
    }

    // Sends what is published on the channel until the client is gone.
    asio::awaitable<void> push(beast::tcp_stream& stream, const Response& response) {
        const Counted counted(listeners_);
        auto head = headOf<http::empty_body>(response, 11, false);
        http::response_serializer<http::empty_body> serializer(head);
        error_code failed;
        stream.expires_after(options_.patience);
        co_await http::async_write_header(stream, serializer, asio::redirect_error(use_awaitable, failed));
        asio::steady_timer waits(io_);
        waiting_.insert(&waits);
        for (std::uint64_t sent = 0; !failed;) {
            Event next = newest(response.channel, sent);
            if (!next) {
                error_code woken;
                waits.expires_after(options_.keepAlive);
                co_await waits.async_wait(asio::redirect_error(use_awaitable, woken));
                if (woken) continue;
                next = kAlive;
            }
            stream.expires_after(options_.patience);
            co_await asio::async_write(stream, asio::buffer(*next), asio::redirect_error(use_awaitable, failed));
        }
        waiting_.erase(&waits);
    }
    // The channel's newest event if it is newer than what was sent.
    Event newest(const std::string& channel, std::uint64_t& sent) {
        const std::lock_guard lock(mutex_);
        const auto found = channels_.find(channel);
        if (found == channels_.end() || found->second.count == sent) return nullptr;
        sent = found->second.count;
        return found->second.newest;
    }

    const Options options_;
    const Handler handler_;
    int port_ = 0;
    std::atomic<std::size_t> connections_ = 0, listeners_ = 0;
    std::map<std::string, std::size_t> ofOne_;  // connections of each address
    std::set<asio::steady_timer*> waiting_;     // a timer of each stream
    std::mutex mutex_;                          // of:
    std::map<std::string, Channel> channels_;
    asio::io_context io_{1};  // after all that its connections use
    tcp::acceptor acceptor_{io_};
    std::jthread thread_;
};

Server::Server(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Server::~Server() { implementation_->stop(); }

Result<std::unique_ptr<Server>> Server::open(const Options& options, Handler handler, const std::function<void()>& begins) {
    auto implementation = std::make_unique<Implementation>(options, std::move(handler));
    TRY(implementation->listen());
    implementation->start(begins);
    return std::unique_ptr<Server>(new Server(std::move(implementation)));
}

int Server::port() const { return implementation_->port(); }
void Server::publish(const std::string& channel, std::string event) { implementation_->publish(channel, std::move(event)); }
std::size_t Server::connections() const { return implementation_->connections(); }
std::size_t Server::listeners() const { return implementation_->listeners(); }

}  // namespace fantascope::web
