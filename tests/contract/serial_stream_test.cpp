#include "drivers/byte_stream/serial.h"

#include "contract/byte_stream_suite.h"
#include "contract/eventually.h"
#include "contract/pseudo_terminal.h"

#include <gmock/gmock.h>

namespace fantascope::contract {
namespace {

using drivers::SerialStream;
using testing::HasSubstr;
using testing::IsEmpty;

// Counts the bytes that the line accepted, so that the rig knows what must arrive.
class Counting final : public ByteStream {
public:
    Counting(std::unique_ptr<ByteStream> line, std::size_t& taken) : line_(std::move(line)), taken_(taken) {}
    DeviceStatus status() const override { return line_->status(); }
    Result<std::size_t> write(std::span<const std::uint8_t> bytes) override {
        const std::size_t count = TRY(line_->write(bytes));
        taken_ += count;
        return count;
    }
    Result<std::size_t> read(std::span<std::uint8_t> bytes, Time timeout) override { return line_->read(bytes, timeout); }

private:
    std::unique_ptr<ByteStream> line_;
    std::size_t& taken_;
};

// An adapter that has a new name whenever it is plugged in.
class Adapter {
public:
    void plugIn() { in_ = true; }
    void unplug() {
        const std::lock_guard lock(mutex_);
        in_ = false;
        line_ = std::make_unique<PseudoTerminal>();  // made before the old one is destroyed, so its name differs
    }
    bool in() const { return in_; }
    PseudoTerminal& line() { return *line_; }
    std::unique_ptr<ByteStream> open() {
        const auto find = [this]() -> Result<std::filesystem::path> {
            const std::lock_guard lock(mutex_);
            if (!in_) return Error("no such adapter is plugged in");
            return std::filesystem::path(line_->name());
        };
        return std::make_unique<SerialStream>("line", find, drivers::SerialSettings{});
    }

private:
    std::mutex mutex_;
    std::atomic<bool> in_ = true;
    std::unique_ptr<PseudoTerminal> line_ = std::make_unique<PseudoTerminal>();
};

bool runs(const Device& device) { return device.status().state == DeviceState::Running; }

class SerialRig final : public ByteStreamRig {
public:
    SerialRig() { reopen(); }

    ByteStream& port() override { return *port_; }
    void reopen() override {
        port_.reset();
        port_ = std::make_unique<Counting>(adapter_.open(), taken_);
        letTimePass();
    }
    void unplug() override {
        // Waits until the bytes from before the loss are read: the kernel drops what nobody read in
        // time.
        eventually("what was sent is read", [&] { return !runs(*port_) || adapter_.line().hasBeenRead(); });
        adapter_.unplug();
    }
    void plugIn() override {
        adapter_.plugIn();
        taken_ = received_ = 0;
        arrived_.clear();
    }
    void letTimePass() override {
        eventually("the line is as it was plugged", [&] { return runs(*port_) == adapter_.in(); });
        if (!adapter_.in()) return;
        eventually("what was written arrives and what was sent is read", [&] {
            const Bytes more = adapter_.line().receive();
            received_ += more.size();
            arrived_.insert(arrived_.end(), more.begin(), more.end());
            return received_ >= taken_ && adapter_.line().hasBeenRead();
        });
    }
    Clock& clock() override { return clock_; }
    Device& neighbour() override {
        eventually("the neighbour runs", [&] { return runs(*neighbour_); });
        return *neighbour_;
    }

    void farSends(const Bytes& bytes) override { adapter_.line().send(bytes); }
    Bytes farReceives() override { return std::exchange(arrived_, {}); }

private:
    SteadyClock clock_;
    Adapter adapter_, next_;
    std::unique_ptr<ByteStream> neighbour_ = next_.open();
    std::size_t taken_ = 0, received_ = 0;
    Bytes arrived_;
    std::unique_ptr<ByteStream> port_;
};

TEST(SerialStreamContract, is_kept_over_a_pseudo_terminal_that_comes_back_by_another_name) {
    EXPECT_THAT(violations(byteStreamSuite(), [] { return std::make_unique<SerialRig>(); }), IsEmpty());
}

TEST(SerialStream, loses_nothing_that_it_took_when_it_closes) {
    for (int life = 0; life < 300; ++life) {
        Adapter adapter;
        auto stream = adapter.open();
        eventually("it runs", [&] { return runs(*stream); });
        const Bytes sent(600, static_cast<std::uint8_t>(life));
        ASSERT_EQ(stream->write(sent).value(), sent.size());
        stream.reset();
        Bytes arrived;
        eventually("all has arrived", [&] {
            const Bytes more = adapter.line().receive();
            arrived.insert(arrived.end(), more.begin(), more.end());
            return adapter.line().isTaken();
        });
        ASSERT_EQ(arrived, sent) << "life " << life;
    }
}

}  // namespace
}  // namespace fantascope::contract
