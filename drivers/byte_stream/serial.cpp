#include "drivers/byte_stream/serial.h"

#include <asm/termbits.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/serial.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <utility>

namespace fantascope::drivers {
namespace {

// More than any protocol here leaves unread. The rest waits in the kernel.
constexpr std::size_t kCapacity = std::size_t{1} << 16;

// How often a full line is checked for room and for a loss.
constexpr Time kLookAgain = std::chrono::milliseconds(20);
constexpr Time kUntilSomethingHappens = std::chrono::hours(1);

// How long the last bytes may take to leave when the line closes.
constexpr Time kDrainTimeout = std::chrono::milliseconds(250);

std::string described(const UsbFile& line) {
    return fmt::format("{} ({} {}, serial {})", line.file.string(), line.usb.manufacturer, line.usb.name,
                       line.usb.serial.empty() ? "none" : line.usb.serial);
}

std::string described(const std::vector<UsbFile>& lines) {
    std::vector<std::string> all;
    for (const UsbFile& line : lines) all.push_back(described(line));
    return fmt::format("{}", fmt::join(all, ", "));
}

bool fits(const std::string& wanted, const std::string& is) { return wanted.empty() || wanted == is; }

// Sets raw mode and the rate. Returns whether the line runs at that rate now: the kernel does not
// report what an adapter cannot do.
bool arrange(int file, const SerialSettings& settings) {
    termios2 line{};
    if (ioctl(file, TCGETS2, &line) != 0) return false;
    line.c_iflag = IGNBRK;
    line.c_oflag = line.c_lflag = 0;
    line.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | (BOTHER << IBSHIFT);
    if (settings.parity != Parity::None) line.c_cflag |= PARENB | (settings.parity == Parity::Odd ? PARODD : 0u);
    if (settings.stopBits == 2) line.c_cflag |= CSTOPB;
    line.c_ispeed = line.c_ospeed = static_cast<speed_t>(settings.rate);
    line.c_cc[VMIN] = 1;  // so a read of 0 bytes means that the line is lost
    line.c_cc[VTIME] = 0;
    if (ioctl(file, TCSETS2, &line) != 0 || ioctl(file, TCGETS2, &line) != 0) return false;
    const int rate = static_cast<int>(line.c_ospeed);
    return std::abs(rate - settings.rate) <= settings.rate * 3 / 100;  // within 3 %, all bits of a byte are sampled correctly
}

FileHandle opened(const std::filesystem::path& path, const SerialSettings& settings, Outage& why) {
    FileHandle file(open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    // Exclusive mode keeps out ordinary programs; the lock keeps out privileged ones.
    const bool free =
        file.isOpen() ? flock(file.get(), LOCK_EX | LOCK_NB) == 0 && ioctl(file.get(), TIOCEXCL) == 0 : errno != EBUSY;
    if (!free && (!file.isOpen() || errno == EWOULDBLOCK)) {
        why = {DeviceState::Faulted,
               fmt::format("{} is in use, by another device of this site or by another program", path.string())};
        return {};
    }
    if (!free || !file.isOpen()) {
        why = errno == ENOTTY ? Outage{DeviceState::Faulted, fmt::format("{} is no serial line", path.string())}
                              : whyNotOpened(path, errno);
        return {};
    }
    if (!arrange(file.get(), settings)) {
        why = {DeviceState::Faulted, fmt::format("{} cannot do {} bits a second", path.string(), settings.rate)};
        return {};
    }
    // Failures are ignored: without these an adapter is only a little slower, and one without a
    // modem has no RTS.
    serial_struct speed{};
    if (ioctl(file.get(), TIOCGSERIAL, &speed) == 0) {
        speed.flags |= ASYNC_LOW_LATENCY;
        ioctl(file.get(), TIOCSSERIAL, &speed);
    }
    const int rts = TIOCM_RTS;
    ioctl(file.get(), settings.requestToSend ? TIOCMBIS : TIOCMBIC, &rts);
    ioctl(file.get(), TCFLSH, TCIFLUSH);  // bytes from before this life
    return file;
}

// How many bytes the kernel still holds back from the adapter. Nothing: the line is lost.
std::optional<int> heldBack(int file) {
    int count = 0;
    return ioctl(file, TIOCOUTQ, &count) == 0 ? std::optional(count) : std::nullopt;
}

// Lets the last bytes leave. Only what the adapter does not take in time is dropped: a
// pseudo-terminal would lose bytes that it has already taken.
void drain(int file) {
    SteadyClock clock;
    const Time end = clock.now() + kDrainTimeout;
    while (heldBack(file).value_or(0) > 0 && clock.now() < end) clock.sleepUntil(clock.now() + std::chrono::milliseconds(1));
    if (heldBack(file).value_or(0) > 0) ioctl(file, TCFLSH, TCOFLUSH);
}

}  // namespace

std::vector<UsbFile> serialLines(const SerialIdentity& which) {
    std::vector<UsbFile> lines = usbFilesOf("tty");
    std::erase_if(lines, [&](const UsbFile& line) {
        return !fits(which.vendor, line.usb.vendor) || !fits(which.product, line.usb.product) ||
               !fits(which.serial, line.usb.serial);
    });
    return lines;
}

Result<std::filesystem::path> findSerialLine(const SerialIdentity& which) {
    if (!which.file.empty()) return which.file;
    const std::vector<UsbFile> lines = serialLines(which);
    if (lines.size() == 1) return lines[0].file;
    if (lines.size() > 1)
        return Error(fmt::format("several serial adapters match; choose one by its serial number: {}", described(lines)));
    const std::vector<UsbFile> others = serialLines({});
    const std::string wanted = which.serial.empty() ? "no such serial adapter is" : "no serial adapter " + which.serial + " is";
    return Error(others.empty() ? wanted + " plugged in" : wanted + " plugged in; there is " + described(others));
}

SerialStream::SerialStream(std::string name, Find find, SerialSettings settings)
    : find_(std::move(find)),
      settings_(settings),
      outage_({DeviceState::Starting, "looking for it"}),
      service_(std::move(name), "serial", LossAction::Hold, [this](Service& service) { return runOnce(service); }) {}

DeviceStatus SerialStream::status() const {
    DeviceStatus status = service_.status();
    const std::lock_guard lock(mutex_);
    if (outage_ && status.state == DeviceState::Running) {  // its thread has not reported it yet
        status.state = outage_->state;
        status.detail = outage_->why;
        ++status.losses;
    }
    return status;
}

Result<std::size_t> SerialStream::write(std::span<const std::uint8_t> bytes) {
    const std::lock_guard lock(mutex_);
    if (outage_) return refusal();
    const ssize_t count = ::write(file_.get(), bytes.data(), bytes.size());
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno == EAGAIN || errno == EINTR) return std::size_t{0};
    return failed("write");
}

Result<std::size_t> SerialStream::read(std::span<std::uint8_t> bytes, Time timeout) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, timeout, [&] { return !arrived_.empty() || outage_; });
    if (arrived_.empty() && outage_) return refusal();
    const std::size_t count = std::min(bytes.size(), arrived_.size());
    const auto end = arrived_.begin() + static_cast<std::ptrdiff_t>(count);
    std::copy(arrived_.begin(), end, bytes.begin());
    arrived_.erase(arrived_.begin(), end);
    return count;
}

Result<void> SerialStream::setBreak(bool on) {
    const std::lock_guard lock(mutex_);
    if (outage_) return refusal();
    if (ioctl(file_.get(), on ? TIOCSBRK : TIOCCBRK) != 0) return failed("break");
    return {};
}

Result<std::size_t> SerialStream::unsent() {
    const std::lock_guard lock(mutex_);
    if (outage_) return refusal();
    const auto count = heldBack(file_.get());
    if (!count) return failed("ask");
    return static_cast<std::size_t>(*count);
}

Result<bool> SerialStream::isDrained() {
    const std::lock_guard lock(mutex_);
    if (outage_) return refusal();
    unsigned state = 0;
    return ioctl(file_.get(), TIOCSERGETLSR, &state) == 0 && (state & TIOCSER_TEMT) != 0;
}

std::optional<Outage> SerialStream::awaitRunning(Service& driver) {
    for (DeviceStatus line = status(); line.state != DeviceState::Running; line = status()) {
        if (line.detail != std::exchange(reported_, line.detail)) return Outage{line.state, line.detail};
        driver.wait(kLookAgain);
        if (driver.ending()) break;
    }
    return std::nullopt;
}

Outage SerialStream::drop(const Error& why, DeviceState state) {
    const std::lock_guard lock(mutex_);
    lose({state, fmt::format("{}: {}", path_.string(), why.message())});
    arrived_.clear();
    reported_ = outage_->why;
    return *outage_;
}

void SerialStream::lose(Outage why) {
    if (outage_) return;
    outage_ = std::move(why);
    changed_.notify_all();
    service_.wake();
}

Error SerialStream::refusal() const { return Error(outage_->why); }

Error SerialStream::failed(const char* what) {
    const int error = errno;
    const bool gone = error == EIO || error == ENODEV || error == ENXIO || error == EPIPE;  // kernel drivers differ
    lose(gone ? Outage{DeviceState::Absent, fmt::format("{} was unplugged", path_.string())}
              : Outage{DeviceState::Faulted, fmt::format("{}: {}: {}", path_.string(), what, systemMessage(error))});
    return refusal();
}

Outage SerialStream::runOnce(Service& service) {
    const auto path = find_();
    Outage why{DeviceState::Absent, path ? "" : path.error().message()};
    FileHandle file = path ? opened(*path, settings_, why) : FileHandle();
    if (!file.isOpen()) {
        const std::lock_guard lock(mutex_);
        outage_ = why;
        return why;
    }
    const int number = file.get();
    {
        const std::lock_guard lock(mutex_);
        file_ = std::move(file);
        path_ = *path;
        arrived_.clear();
        outage_.reset();
    }
    service.setRunning();
    for (bool room = true; !service.ending(); room = fill(number)) {
        {
            const std::lock_guard lock(mutex_);
            if (outage_) break;
        }
        if (room)
            service.wait(kUntilSomethingHappens, {number});
        else
            service.wait(kLookAgain);
    }
    drain(number);
    const std::lock_guard lock(mutex_);
    file_ = FileHandle();
    return outage_.value_or(Outage{});
}

bool SerialStream::fill(int file) {
    std::array<std::uint8_t, 4096> bytes;
    const std::lock_guard lock(mutex_);
    if (outage_) return false;
    if (arrived_.size() + bytes.size() > kCapacity) {
        pollfd line{file, 0, 0};
        errno = EIO;
        if (poll(&line, 1, 0) > 0) failed("read");
        return false;
    }
    const ssize_t count = ::read(file, bytes.data(), bytes.size());
    if (count > 0) {
        arrived_.insert(arrived_.end(), bytes.begin(), bytes.begin() + count);
        changed_.notify_all();
    } else if (count == 0 || (errno != EAGAIN && errno != EINTR)) {
        if (count == 0) errno = EIO;  // hung up
        failed("read");
    }
    return true;
}

}  // namespace fantascope::drivers
