#pragma once

#include "drivers/common/file_handle.h"

#include "core/check.h"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <termios.h>
#include <unistd.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace fantascope::contract {

// A kernel line with a file at one end, as an adapter gives one, and the far end in the test's
// hands. Destroying it unplugs it: whoever has the file open is hung up, and the name disappears.
class PseudoTerminal {
public:
    PseudoTerminal() {
        int master = -1, slave = -1;
        termios raw{};
        cfmakeraw(&raw);
        raw.c_cflag |= CS8 | CREAD;
        FANTASCOPE_CHECK(openpty(&master, &slave, nullptr, &raw, nullptr) == 0, "the kernel has pseudo-terminals");
        far_ = drivers::FileHandle(master);
        near_ = drivers::FileHandle(slave);
        fcntl(master, F_SETFL, O_NONBLOCK);
        name_ = ttyname(slave);
    }

    const std::string& name() const { return name_; }
    int far() const { return far_.get(); }
    int near() const { return near_.get(); }

    // What has arrived at the far end.
    std::vector<std::uint8_t> receive() {
        std::vector<std::uint8_t> all;
        std::uint8_t bytes[4096];
        for (ssize_t count = 0; (count = ::read(far_.get(), bytes, sizeof bytes)) > 0;)
            all.insert(all.end(), bytes, bytes + count);
        return all;
    }
    void send(std::span<const std::uint8_t> bytes) {
        FANTASCOPE_CHECK(::write(far_.get(), bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()),
                         "the line has room for what a test sends");
    }
    // Whether everything that was sent has been read at the near end, or taken at the far one. The
    // question itself moves pending bytes to that end.
    bool hasBeenRead() const { return isEmpty(near_); }
    bool isTaken() const { return isEmpty(far_); }

private:
    static bool isEmpty(const drivers::FileHandle& end) {
        pollfd line{end.get(), POLLIN, 0};
        return poll(&line, 1, 0) == 0;
    }

    drivers::FileHandle far_;
    drivers::FileHandle near_;  // kept open, so that the far end is not hung up while the program has the file closed
    std::string name_;
};

}  // namespace fantascope::contract
