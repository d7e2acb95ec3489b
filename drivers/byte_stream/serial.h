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

// The format of bytes on a serial line; always eight data bits.
struct SerialSettings {
    int rate = 9600;  // bits a second; the adapter must achieve it within 3 %
    Parity parity = Parity::None;
    int stopBits = 1;           // 1 or 2
    bool requestToSend = true;  // the RTS line; some RS-485 adapters drive the line only while RTS is off
};

// Identifies a serial line: by its file, or by its USB adapter under whatever file it has today.
// Empty fields match any adapter.
struct SerialIdentity {
    std::filesystem::path file;           // "/dev/ttyS0"; if given, the other fields are ignored
    std::string vendor, product, serial;  // as in UsbIdentity
};

// The matching lines on USB adapters, sorted by USB path.
std::vector<UsbFile> serialLines(const SerialIdentity& which);

// The only matching line; a given file as it is. Error: none matches, or several do; it lists them.
Result<std::filesystem::path> findSerialLine(const SerialIdentity& which);

// A serial line of this machine, exclusive to this program while open. When it is lost, it is
// searched again, so an adapter is found under whatever name it comes back. Everything that arrives
// is read at once, because what the kernel holds is lost with the adapter. When the line closes,
// the last bytes have a quarter of a second to leave; then they are dropped. Otherwise an adapter
// that takes nothing would block the program for half a minute.
// Thread: as ByteStream; the other methods as read() and write().
class SerialStream final : public ByteStream {
public:
    // Finds the line's file. Called on the stream's own thread before each attempt. Error: the line
    // is Absent, and why.
    using Find = std::function<Result<std::filesystem::path>()>;
    SerialStream(std::string name, Find find, SerialSettings settings);

    DeviceStatus status() const override;
    Result<std::size_t> write(std::span<const std::uint8_t> bytes) override;
    Result<std::size_t> read(std::span<std::uint8_t> bytes, Time timeout) override;

    // Starts or ends the break state. On USB this takes about a millisecond. A pseudo-terminal
    // ignores it. Error: not Running, or the line cannot send a break.
    Result<void> setBreak(bool on);
    // How many bytes the kernel still holds back from the adapter. Error: not Running.
    Result<std::size_t> unsent();
    // Whether the adapter reports an empty buffer; some never do. Error: not Running.
    Result<bool> isDrained();

    // For the service of the driver that owns the line. Returns nothing once the line is Running or
    // the service is ending. Returns an outage whenever the reason why the line is not Running has
    // changed.
    std::optional<Outage> awaitRunning(Service& driver);
    // Closes the line after a failure of its driver, and searches it again. Discards what has
    // arrived, so the next life starts clean. Returns the line's own outage if it was lost, else
    // `state` and `why`, led by the file's name; this becomes the line's status.
    Outage drop(const Error& why, DeviceState state);

private:
    Outage runOnce(Service& service);
    bool fill(int file);             // arrived_; returns whether there is room for more
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
    std::deque<std::uint8_t> arrived_;  // but not read yet
    std::string reported_;              // the outage that awaitRunning() returned last
    Service service_;
};

}  // namespace fantascope::drivers
