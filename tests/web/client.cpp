#include "web/client.h"

#include "core/check.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace fantascope::web {

Client::Client(int port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(static_cast<std::uint16_t>(port));
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    closed_ = connect(socket_, reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0;
}

Client::~Client() { close(socket_); }

void Client::send(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
        if (sent <= 0) return;
        bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
}

std::string Client::receiveUntil(std::string_view wanted) {
    std::string text;
    while (wanted.empty() || text.find(wanted) == std::string::npos) {
        pollfd waits{socket_, POLLIN, 0};
        constexpr int kPatience = 30000;  // ms
        if (poll(&waits, 1, kPatience) <= 0) break;
        char bytes[4096];
        const ssize_t read = recv(socket_, bytes, sizeof bytes, 0);
        if (read <= 0) {
            closed_ = true;
            break;
        }
        text.append(bytes, static_cast<std::size_t>(read));
    }
    return text;
}

std::string ask(int port, std::string_view request) {
    Client client(port);
    client.send(request);
    return client.receiveAll();
}

std::string get(int port, std::string_view path) {
    return ask(port, fmt::format("GET {} HTTP/1.1\r\nHost: localhost:{}\r\nConnection: close\r\n\r\n", path, port));
}

}  // namespace fantascope::web
