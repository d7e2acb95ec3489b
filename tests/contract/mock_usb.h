#pragma once
// USB devices that are not there: umockdev shows libusb their entries under /sys, their files and
// their coming and going; what the kernel's usbfs would do with them is done here.

#include "mock_machine.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace fantascope {

struct MockUsbDevice {
    std::string path = "1-1";  // the port of the root hub that it is plugged into
    std::uint16_t vendor = 0x16c0, product = 0x27d9;
    std::string serial = "CUE-7", name = "Hand Cue Controller";
    // A HID interface with an interrupt endpoint for each, and the kernel's driver on it.
    std::vector<std::vector<std::uint8_t>> reportDescriptors;
    bool tellsState = true;  // false: GET_REPORT stalls
    // Each interface has an interrupt endpoint for reports to it too; else they come over the
    // control pipe.
    bool hasOutEndpoints = false;
};

// A report that the device was sent.
struct MockUsbReport {
    int interface = 0;
    bool feature = false;     // else an output report
    bool byEndpoint = false;  // else over the control pipe
    int id = 0;               // that the control pipe says
    std::vector<std::uint8_t> bytes;
};

// The program must run under umockdev's preloaded library, see mock_machine.h. One on a machine.
// Thread: thread-safe.
class MockUsb {
public:
    explicit MockUsb(MockMachine& machine);  // which outlives it
    ~MockUsb();
    MockUsb(const MockUsb&) = delete;
    MockUsb& operator=(const MockUsb&) = delete;

    void plug(const MockUsbDevice& device);
    void unplug(const std::string& path);

    // The device has a report to tell; it waits for who listens. Nothing where nothing is plugged
    // in.
    void report(const std::string& path, int interface, const std::vector<std::uint8_t>& bytes);
    // The same, in the moment in which the next transfer that waits for one is cancelled: too late
    // for that.
    void reportAtCancel(const std::string& path, int interface, const std::vector<std::uint8_t>& bytes);
    // What GET_REPORT answers from now on, also after it is plugged in again; with its id, if it
    // has one.
    void setState(const std::string& path, int interface, const std::vector<std::uint8_t>& bytes);
    // The next reports of the interface stall its endpoint, or come with an error.
    void stall(const std::string& path, int interface);
    void fail(const std::string& path, int interface);

    // What the device was sent since it was last plugged in, also after it was unplugged; oldest
    // first.
    std::vector<MockUsbReport> sent(const std::string& path) const;
    // What it is sent waits from now on, or is answered: taken, or with a stall.
    enum class Taking { All, Nothing, Stalls };
    void take(const std::string& path, Taking taking);

    // Its file may be opened by nobody but root.
    void forbid(const std::string& path);

    // Whether all reports were heard, and are listened for again.
    bool isHeard(const std::string& path) const;
    // Whether the kernel's own driver has the interface.
    bool kernelHas(const std::string& path, int interface) const;
    // How many transfers wait for a report.
    std::size_t waiting(const std::string& path, int interface) const;

private:
    class Plugged;
    struct Bed;
    Plugged* at(const std::string& path) const;

    const std::unique_ptr<Bed> bed_;
};

}  // namespace fantascope
