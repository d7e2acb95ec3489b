#pragma once

#include "core/clock.h"
#include "core/result.h"
#include "web/request.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace fantascope::web {

// An HTTP/1.1 server (RFC 9110, 9112) that answers requests and pushes events (text/event-stream,
// HTML Living Standard 9.2). It reads no file.
//
// Whoever calls it never waits for a client: a client that reads slowly gets the newest event of
// its channel and misses those before. A client that sends nothing, or a byte now and then, is
// dropped after `patience`; one that asks for too much is refused with the status that says so.
//
// Thread: a thread of its own, on which it calls the handler. Its functions from any thread.
class Server {
public:
    struct Options {
        std::string address = "127.0.0.1";
        int port = 0;  // 0: any that is free
        // Bounds, beyond which a client is refused.
        std::size_t connections = 512, connectionsOfOne = 256;  // at once, of all and of one address
        std::size_t headerBytes = 8192, bodyBytes = 65536;
        Time patience = std::chrono::seconds(10);  // for a whole request, and for a write
        Time keepAlive = std::chrono::seconds(5);  // a stream without events says so often that it lives
    };
    // Answers a request. It must not wait.
    using Handler = std::function<Response(const Request&)>;

    // `begins`: called first on the server's thread. Error: the address cannot be used.
    static Result<std::unique_ptr<Server>> open(const Options& options, Handler handler,
                                                const std::function<void()>& begins = {});
    ~Server();
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    int port() const;
    // Sends an event, one or several lines, to all who listen to a channel, now or later: who
    // begins to listen gets the newest one at once.
    void publish(const std::string& channel, std::string event);
    // How many connections there are, and how many of them listen to a channel.
    std::size_t connections() const;
    std::size_t listeners() const;

private:
    class Implementation;
    explicit Server(std::unique_ptr<Implementation> implementation);
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace fantascope::web
