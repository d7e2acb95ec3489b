#include "drivers/byte_stream/simulated.h"

#include "drivers/site/plug.h"

#include "core/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <utility>

namespace fantascope::drivers {
namespace {

// How often a waiting reader checks: far finer than any protocol's timeout, far coarser than a busy
// loop.
constexpr Time kLookAgain = std::chrono::milliseconds(1);

// More than any script replies before its driver reads.
constexpr std::size_t kScriptCapacity = std::size_t{1} << 20;

struct Line {
    std::size_t capacity;
    std::mutex mutex;
    std::array<std::deque<std::uint8_t>, 2> arrived;  // at each end, not read yet
};

class LoopbackEnd final : public ByteStream {
public:
    LoopbackEnd(std::shared_ptr<Line> line, std::size_t side, site::Plug plug, Clock& clock)
        : line_(std::move(line)), side_(side), plug_(std::move(plug)), clock_(clock) {}

    DeviceStatus status() const override { return plug_.status(); }

    Result<std::size_t> write(std::span<const std::uint8_t> bytes) override {
        if (!plug_.in()) return plug_.absent();
        const std::lock_guard lock(line_->mutex);
        std::deque<std::uint8_t>& far = line_->arrived[1 - side_];
        const std::size_t count = std::min(bytes.size(), line_->capacity - far.size());
        far.insert(far.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(count));
        return count;
    }

    Result<std::size_t> read(std::span<std::uint8_t> bytes, Time timeout) override {
        const Time deadline = clock_.now() + timeout;
        for (;;) {
            if (const std::size_t count = take(bytes)) return count;
            if (!plug_.in()) return plug_.absent();
            const Time now = clock_.now();
            if (now >= deadline) return std::size_t{0};
            clock_.sleepUntil(std::min(deadline, now + kLookAgain));
        }
    }

private:
    std::size_t take(std::span<std::uint8_t> bytes) {
        const std::lock_guard lock(line_->mutex);
        std::deque<std::uint8_t>& arrived = line_->arrived[side_];
        const std::size_t count = std::min(bytes.size(), arrived.size());
        const auto end = arrived.begin() + static_cast<std::ptrdiff_t>(count);
        std::copy(arrived.begin(), end, bytes.begin());
        arrived.erase(arrived.begin(), end);
        return count;
    }

    std::shared_ptr<Line> line_;
    std::size_t side_;
    site::Plug plug_;
    Clock& clock_;
};

}  // namespace

std::array<std::unique_ptr<ByteStream>, 2> openLoopback(const DriverContext& context, const std::string& device,
                                                        std::size_t capacity) {
    FANTASCOPE_CHECK(context.world != nullptr, "a loopback needs a simulated world");
    const auto line = std::make_shared<Line>();
    line->capacity = capacity;
    const auto end = [&](std::size_t side) {
        return std::make_unique<LoopbackEnd>(line, side, site::Plug(*context.world, device, LossAction::Hold), context.clock);
    };
    return {end(0), end(1)};
}

ScriptedStream::ScriptedStream(const DriverContext& context, const std::string& device) {
    auto ends = openLoopback(context, device, kScriptCapacity);
    nearEnd_ = std::move(ends[0]);
    farEnd_ = std::move(ends[1]);
}

ScriptedStream& ScriptedStream::expect(Bytes expected, Bytes reply) {
    const std::lock_guard lock(mutex_);
    script_.push_back({std::move(expected), std::move(reply)});
    play();
    return *this;
}

std::string ScriptedStream::deviation() const {
    const std::lock_guard lock(mutex_);
    if (deviation_.empty() && exchange_ == script_.size() && played_ < received_.size())
        return fmt::format("after the script's end: {:#04x} came", received_[played_]);
    return deviation_;
}

bool ScriptedStream::finished() const {
    const std::lock_guard lock(mutex_);
    return exchange_ == script_.size() && played_ == received_.size();
}

Bytes ScriptedStream::received() const {
    const std::lock_guard lock(mutex_);
    return received_;
}

Result<std::size_t> ScriptedStream::write(std::span<const std::uint8_t> bytes) {
    const std::size_t taken = TRY(nearEnd_->write(bytes));
    const std::lock_guard lock(mutex_);
    Bytes arrived(taken);
    const auto read = farEnd_->read(arrived, Time::zero());
    FANTASCOPE_CHECK(!read || *read == taken, "the far end of a line in memory reads what was just written");
    received_.insert(received_.end(), arrived.begin(), arrived.end());
    play();
    return taken;
}

void ScriptedStream::play() {
    for (; exchange_ < script_.size() && deviation_.empty(); ++exchange_, matched_ = 0) {
        const auto& [expected, reply] = script_[exchange_];
        for (; matched_ < expected.size(); ++matched_, ++played_) {
            if (played_ == received_.size()) return;
            if (received_[played_] == expected[matched_]) continue;
            deviation_ = fmt::format("exchange {}, byte {}: {:#04x} was expected, {:#04x} came", exchange_ + 1, matched_ + 1,
                                     expected[matched_], received_[played_]);
            return;
        }
        const auto sent = farEnd_->write(reply);  // fails on an unplugged line, like a real one
        FANTASCOPE_CHECK(!sent || *sent == reply.size(), "a script's replies fit into the line");
    }
}

}  // namespace fantascope::drivers
