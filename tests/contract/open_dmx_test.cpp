// Over a pseudo-terminal, which has no break and no rate: this tests the bytes between the breaks,
// and the driver's lives.

#include "contract/serial_dmx_rig.h"

#include <gmock/gmock.h>
#include <poll.h>

#include <atomic>
#include <mutex>
#include <thread>
#include <vector>

namespace fantascope::contract {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// Takes every 513 bytes as a packet, because there are no breaks.
class Lamps {
public:
    explicit Lamps(int line) : line_(line), thread_([this] { run(); }) {}
    ~Lamps() {
        ending_ = true;
        thread_.join();
    }
    std::optional<DmxFrame> out() const {
        const std::lock_guard lock(mutex_);
        return out_;
    }
    std::optional<DmxFrame> lastOut() const { return out(); }
    int framesOut() const {
        const std::lock_guard lock(mutex_);
        return frames_;
    }

private:
    void run() {
        std::vector<std::uint8_t> arrived(1 + kDmxSlots);
        for (std::size_t have = 0; !ending_;) {
            pollfd waited{line_, POLLIN, 0};
            if (poll(&waited, 1, 10) <= 0) continue;
            const std::lock_guard lock(mutex_);  // once the line is empty, the bytes have taken effect
            const ssize_t count = read(line_, arrived.data() + have, arrived.size() - have);
            if (count <= 0 || (have += static_cast<std::size_t>(count)) < arrived.size()) continue;
            have = 0;
            ++frames_;
            if (arrived[0] == 0) std::copy(arrived.begin() + 1, arrived.end(), out_.emplace().begin());
        }
    }

    const int line_;
    mutable std::mutex mutex_;
    std::optional<DmxFrame> out_;
    int frames_ = 0;
    std::atomic<bool> ending_ = false;
    std::thread thread_;
};

TEST(DmxPortContract, is_kept_by_a_bare_adapter) {
    const auto socket = [] { return std::make_unique<Socket<Lamps>>([](int line) { return std::make_unique<Lamps>(line); }); };
    EXPECT_THAT(violations(dmxPortSuite(),
                           [&] { return std::make_unique<SerialDmxPortRig<Socket<Lamps>>>("open_dmx", socket(), socket()); }),
                IsEmpty());
}

TEST(OpenDmx, has_to_be_told_which_adapter_it_is) {
    SteadyClock clock;
    const auto open = [&](const std::string& keys) {
        const auto node = ConfigNode::parse("driver: open_dmx\n" + keys, "site.yaml").value();
        const auto port = drivers::openDmxPort(node, 1, {clock});
        return port ? "accepted" : port.error().message();
    };
    EXPECT_THAT(open(""), HasSubstr("'serial' or 'port' is needed"));
    EXPECT_THAT(open("serial: AB12\nbreak: 50\n"), HasSubstr("break"));
    EXPECT_EQ(open("serial: AB12\nbreak: 100\nmark_after_break: 12\nrate: 20\n"), "accepted");
}

// A pseudo-terminal accepts any rate, so the file must be refused.
TEST(OpenDmx, on_what_is_no_serial_line_is_faulted) {
    SteadyClock clock;
    const drivers::DriverContext context{clock};
    const auto port = drivers::openDmxPort(serialOptions("open_dmx", "/dev/null"), 1, context).value();
    eventually("fault", [&] { return port->status().state == DeviceState::Faulted; });
    EXPECT_EQ(port->status().detail, "/dev/null is no serial line");
}

}  // namespace
}  // namespace fantascope::contract
