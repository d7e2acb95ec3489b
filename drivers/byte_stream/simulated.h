#pragma once

#include "drivers/common/surroundings.h"

#include "device/byte_stream.h"

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace fantascope::drivers {

using Bytes = std::vector<std::uint8_t>;

// Two ends of one line in memory: what is written to one is read from the other. The line holds
// `capacity` bytes in each direction. Both ends go by `device` in the world, and one plug is for
// both. Needs around.world.
std::array<std::unique_ptr<ByteStream>, 2> openLoopback(const Surroundings& around, const std::string& device,
                                                        std::size_t capacity = 4096);

// A line to a far end that plays a script, for testing a protocol driver as it is: when exactly the
// expected bytes have come, the reply is sent. The first byte that is not as expected ends the
// script: nothing more is replied. Thread: what ByteStream has is bound to the driver's thread, all
// else is thread-safe.
class ScriptedStream final : public ByteStream {
public:
    ScriptedStream(const Surroundings& around, const std::string& device);

    // Adds an exchange to the script's end. With nothing expected, the far end speaks first: as
    // soon as the script gets there.
    ScriptedStream& expect(Bytes expected, Bytes reply = {});
    // "" as long as everything was as expected, else where it went wrong: "exchange 2, byte 5: 0x7e
    // was expected, 0x7f came".
    std::string deviation() const;
    // Whether the script was played to its end.
    bool finished() const;
    // All that came, scripted or not.
    Bytes received() const;

    DeviceStatus status() const override { return nearEnd_->status(); }
    Result<std::size_t> write(std::span<const std::uint8_t> bytes) override;
    Result<std::size_t> read(std::span<std::uint8_t> bytes, Time patience) override { return nearEnd_->read(bytes, patience); }

private:
    struct Exchange {
        Bytes expected, reply;
    };
    void play();  // with mutex_ held

    std::unique_ptr<ByteStream> nearEnd_, farEnd_;
    mutable std::mutex mutex_;
    std::vector<Exchange> script_;
    std::size_t exchange_ = 0;  // the one that is being played
    std::size_t matched_ = 0;   // bytes of it that came
    Bytes received_;
    std::size_t played_ = 0;  // bytes of received_ that the script has seen
    std::string deviation_;
};

}  // namespace fantascope::drivers
