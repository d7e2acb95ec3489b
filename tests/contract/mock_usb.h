#pragma once
// Simulated USB devices: umockdev shows libusb their entries under /sys, their files, and their
// coming and going. The part of the kernel's usbfs is implemented here.

#include "mock_machine.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace fantascope {

struct MockUsbDevice {
    std::string path = "1-1";  // the port of the root hub
    std::uint16_t vendor = 0x16c0, product = 0x27d9;
    std::string serial = "CUE-7", name = "Hand Cue Controller";
    // One HID interface per descriptor, each with an interrupt endpoint and the kernel's driver on
    // it.
    std::vector<std::vector<std::uint8_t>> reportDescriptors;
    bool tellsState = true;  // false: GET_REPORT stalls
    // Whether each interface has an interrupt endpoint for output reports too; else they use the
    // control pipe.
    bool hasOutEndpoints = false;
};

// A report that was sent to the device.
struct MockUsbReport {
    int interface = 0;
    bool feature = false;     // else an output report
    bool byEndpoint = false;  // else over the control pipe
    int id = 0;               // as given on the control pipe
    std::vector<std::uint8_t> bytes;
};

// The program must run under umockdev's preloaded library, see mock_machine.h. One per machine.
// Thread: thread-safe.
class MockUsb {
public:
    explicit MockUsb(MockMachine& machine);  // outlives it
    ~MockUsb();
    MockUsb(const MockUsb&) = delete;
    MockUsb& operator=(const MockUsb&) = delete;

    void plug(const MockUsbDevice& device);
    void unplug(const std::string& path);

    // The device sends a report; it waits until somebody listens. Nothing happens if nothing is
    // plugged in.
    void report(const std::string& path, int interface, const std::vector<std::uint8_t>& bytes);
    // The same, at the moment when the next transfer for it is cancelled: too late for that.
    void reportAtCancel(const std::string& path, int interface, const std::vector<std::uint8_t>& bytes);
    // Sets what GET_REPORT answers from now on, even after replugging; with its id, if it has one.
    void setState(const std::string& path, int interface, const std::vector<std::uint8_t>& bytes);
    // The next reports of the interface stall its endpoint, or arrive with an error.
    void stall(const std::string& path, int interface);
    void fail(const std::string& path, int interface);

    // The reports sent to the device since it was last plugged in, even if it is unplugged now;
    // oldest first.
    std::vector<MockUsbReport> sent(const std::string& path) const;
    // From now on, reports to it are accepted, wait, or are answered with a stall.
    enum class Taking { All, Nothing, Stalls };
    void take(const std::string& path, Taking taking);

    // Only root may open its file.
    void forbid(const std::string& path);

    // Whether all reports were received, and somebody listens for more.
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
