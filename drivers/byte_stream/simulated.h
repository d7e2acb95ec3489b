#pragma once

#include "drivers/common/opening.h"

#include "device/byte_stream.h"

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace fantascope::drivers {

using Bytes = std::vector<std::uint8_t>;

// The two ends of a line in memory: what is written to one is read from the other. The line holds
// `capacity` bytes in each direction. Both ends have the name `device` in the world and share one
// plug. Needs context.world.
std::array<std::unique_ptr<ByteStream>, 2> openLoopback(const DriverContext& context, const std::string& device,
                                                        std::size_t capacity = 4096);

// A line to a far end that plays a script, to test a protocol driver unchanged. When exactly the
// expected bytes have arrived, the reply is sent. The first unexpected byte ends the script:
// nothing more is sent. Thread: ByteStream's methods are bound to the driver's thread, the others
// are thread-safe.
class ScriptedStream final : public ByteStream {
public:
    ScriptedStream(const DriverContext& context, const std::string& device);

    // Appends an exchange. With nothing expected, the far end sends first, as soon as the script
    // reaches the exchange.
    ScriptedStream& expect(Bytes expected, Bytes reply = {});
    // "" while everything was as expected, else the first deviation: "exchange 2, byte 5: 0x7e was
    // expected, 0x7f came".
    std::string deviation() const;
    // Whether the whole script was played.
    bool finished() const;
    // All received bytes, scripted or not.
    Bytes received() const;

    DeviceStatus status() const override { return nearEnd_->status(); }
    Result<std::size_t> write(std::span<const std::uint8_t> bytes) override;
    Result<std::size_t> read(std::span<std::uint8_t> bytes, Time timeout) override { return nearEnd_->read(bytes, timeout); }

private:
    struct Exchange {
        Bytes expected, reply;
    };
    void play();  // with mutex_ held

    std::unique_ptr<ByteStream> nearEnd_, farEnd_;
    mutable std::mutex mutex_;
    std::vector<Exchange> script_;
    std::size_t exchange_ = 0;  // the current one
    std::size_t matched_ = 0;   // its bytes received so far
    Bytes received_;
    std::size_t played_ = 0;  // bytes of received_ that the script has seen
    std::string deviation_;
};

}  // namespace fantascope::drivers
