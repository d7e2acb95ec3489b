#pragma once

#include "drivers/common/service.h"
#include "drivers/common/usb_identity.h"

#include "device/byte_stream.h"

#include "core/result.h"

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace fantascope::drivers {

enum class Parity { None, Even, Odd };

// How a byte stands on a serial line: always with eight bits.
struct SerialSettings {
    int rate = 9600;  // bits a second; any that the adapter can make to 3 %
    Parity parity = Parity::None;
    int stopBits = 1;           // 1 or 2
    bool requestToSend = true;  // the RTS line; some adapters drive theirs only while it is off
};

// Which serial line: a file, or the USB adapter behind it, whatever file it is given today. What is
// empty fits every adapter.
struct SerialIdentity {
    std::filesystem::path file;           // "/dev/ttyS0"; where it is given nothing else is looked at
    std::string vendor, product, serial;  // as in UsbIdentity
};

// The lines on USB adapters that fit, sorted by where they are plugged in.
std::vector<UsbFile> serialLines(const SerialIdentity& which);

// The one line that fits; a file as it is. Error: none fits, or several do: which they are.
Result<std::filesystem::path> findSerialLine(const SerialIdentity& which);

// A serial line of this machine, for this program alone while it is open. It is looked for again
// whenever it is lost, so that an adapter is found under whatever name it comes back. Everything
// that arrives is read at once: what the kernel holds is gone with the adapter. What has not left
// when the line closes is dropped: a far end that takes nothing would hold the program for half a
// minute.
// Thread: as ByteStream; the further methods as read() and write().
class SerialStream final : public ByteStream {
public:
    // The line's file as of now. Called on the stream's own thread before each attempt. Error:
    // Absent, and why.
    using Find = std::function<Result<std::filesystem::path>()>;
    SerialStream(std::string name, Find find, SerialSettings settings);

    DeviceStatus status() const override;
    Result<std::size_t> write(std::span<const std::uint8_t> bytes) override;
    Result<std::size_t> read(std::span<std::uint8_t> bytes, Time patience) override;

    // Holds the line in the break state, or ends it. Takes as long as the adapter does: about a
    // millisecond on USB. A pseudo-terminal knows no break and says nothing. Error: not Running, or
    // it has no break.
    Result<void> setBreak(bool on);
    // How many bytes the kernel has not handed to the adapter yet. Error: not Running.
    Result<std::size_t> waiting();
    // Whether the adapter says that its own store is empty; some never do. Error: not Running.
    Result<bool> isDrained();

    // For the service of the driver that owns the line. Returns once the line runs or the service
    // is ending: nothing; or once there is something new to tell of a line that does not run.
    std::optional<Outage> await(Service& driver);
    // What ended a life of the driver: the line's own loss, or else `why`, which names the file and
    // is what the line says from then on, given back and looked for again; so that what broke off,
    // and what is not what it should be, begins anew.
    Outage end(const Error& why, DeviceState state);

private:
    Outage attend(Service& service);
    bool fill(int file);             // with what has arrived; whether there is room for more
    void lose(Outage why);           // with mutex_ held
    Error refusal() const;           // with mutex_ held
    Error failed(const char* what);  // with mutex_ held; from errno

    const Find find_;
    const SerialSettings settings_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    FileHandle file_;
    std::filesystem::path path_;
    std::optional<Outage> outage_;      // nothing while the line can be used
    std::deque<std::uint8_t> arrived_;  // and not read yet
    std::string told_;                  // why the line does not run, as the driver knows it
    Service service_;
};

}  // namespace fantascope::drivers
