#pragma once
// A client that sends bytes as they are, for tests.

#include "core/clock.h"

#include <string>
#include <string_view>

namespace fantascope::web {

class Client {
public:
    explicit Client(int port);
    ~Client();
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    void send(std::string_view bytes);
    // What comes until it holds `wanted`, the server closes, or half a minute is over.
    std::string receiveUntil(std::string_view wanted);
    // All that comes until the server closes.
    std::string receiveAll() { return receiveUntil({}); }
    bool isClosed() const { return closed_; }

private:
    int socket_;
    bool closed_ = false;
};

// The answer to one request on a connection of its own: status line, header and body.
std::string ask(int port, std::string_view request);
// A GET of a path.
std::string get(int port, std::string_view path);

}  // namespace fantascope::web
