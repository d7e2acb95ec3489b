#include "drivers/cue_controller/usb_bus.h"

#include <fmt/format.h>
#include <libusb.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <span>
#include <string>
#include <utility>

namespace fantascope::drivers {
namespace {

namespace fs = std::filesystem;

// HID 1.11, section 6.2.1.
constexpr std::uint8_t kHidDescriptor = 0x21, kReportDescriptor = 0x22;

// Bus and ports in the kernel's notation: "1-1.4".
std::string pathOf(libusb_device* device) {
    std::array<std::uint8_t, 8> ports{};
    const int count = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
    std::string path;
    for (int i = 0; i < count; ++i) path += fmt::format("{}{}", i == 0 ? "-" : ".", ports[static_cast<std::size_t>(i)]);
    return std::to_string(libusb_get_bus_number(device)) + path;
}

timeval timevalOf(Time time) {
    const auto micros = std::chrono::ceil<std::chrono::microseconds>(std::max(time, Time::zero())).count();
    return {static_cast<time_t>(micros / 1'000'000), static_cast<suseconds_t>(micros % 1'000'000)};
}

}  // namespace

UsbBus::~UsbBus() {
    if (libusb_context* const context = context_) libusb_exit(context);
}

Result<void> UsbBus::start() {
    if (context_ != nullptr) return {};
    libusb_context* context = nullptr;
    if (const int error = libusb_init(&context); error != 0)
        return Error(fmt::format("this machine has no USB: {}", libusb_strerror(error)));
    // A new device ends a wait(). Without hot-plug support, the devices are listed again and again.
    if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) != 0)
        libusb_hotplug_register_callback(
            context, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED, 0, LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY,
            LIBUSB_HOTPLUG_MATCH_ANY, [](libusb_context*, libusb_device*, libusb_hotplug_event, void*) { return 0; }, nullptr,
            nullptr);
    context_ = context;
    return {};
}

void UsbBus::wait(Time timeout) {
    timeval limit = timevalOf(timeout);
    libusb_handle_events_timeout_completed(context_, &limit, nullptr);
}

void UsbBus::interrupt() {
    if (libusb_context* const context = context_) libusb_interrupt_event_handler(context);
}

ListedDevice::ListedDevice(libusb_device* device, UsbIdentity usb) : usb(std::move(usb)), device_(libusb_ref_device(device)) {}

ListedDevice::~ListedDevice() {
    if (device_ != nullptr) libusb_unref_device(device_);
}

ListedDevice::ListedDevice(ListedDevice&& other) noexcept
    : usb(std::move(other.usb)), device_(std::exchange(other.device_, nullptr)) {}

ListedDevice& ListedDevice::operator=(ListedDevice&& other) noexcept {
    std::swap(usb, other.usb);
    std::swap(device_, other.device_);
    return *this;
}

std::vector<ListedDevice> hidDevices(libusb_context* context) {
    libusb_device** list = nullptr;
    const ssize_t count = libusb_get_device_list(context, &list);
    std::vector<ListedDevice> devices;
    for (ssize_t i = 0; i < count; ++i)
        if (!hidInterfacesOf(list[i]).empty())
            if (auto usb = usbIdentityAt(pathOf(list[i]))) devices.emplace_back(list[i], std::move(*usb));
    if (count >= 0) libusb_free_device_list(list, 1);
    std::sort(devices.begin(), devices.end(), [](const auto& a, const auto& b) { return a.usb.path < b.usb.path; });
    return devices;
}

std::vector<HidEndpoints> hidInterfacesOf(libusb_device* device) {
    libusb_config_descriptor* read = nullptr;
    if (libusb_get_active_config_descriptor(device, &read) != 0) return {};
    const std::unique_ptr<libusb_config_descriptor, decltype(&libusb_free_config_descriptor)> config(
        read, &libusb_free_config_descriptor);
    std::vector<HidEndpoints> found;
    for (int i = 0; i < config->bNumInterfaces; ++i) {
        if (config->interface[i].num_altsetting < 1) continue;
        const libusb_interface_descriptor& interface = config->interface[i].altsetting[0];
        if (interface.bInterfaceClass != LIBUSB_CLASS_HID) continue;
        HidEndpoints one;
        one.number = interface.bInterfaceNumber;
        const std::span<const std::uint8_t> extra(interface.extra, static_cast<std::size_t>(interface.extra_length));
        for (std::size_t at = 0; at + 9 <= extra.size() && extra[at] >= 2; at += extra[at])
            if (extra[at + 1] == kHidDescriptor && extra[at + 6] == kReportDescriptor)
                one.descriptorSize = static_cast<std::uint16_t>(extra[at + 7] | extra[at + 8] << 8);
        for (int e = 0; e < interface.bNumEndpoints; ++e) {
            const libusb_endpoint_descriptor& endpoint = interface.endpoint[e];
            if ((endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) != LIBUSB_TRANSFER_TYPE_INTERRUPT) continue;
            const bool isIn = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0;
            std::uint8_t& address = isIn ? one.in : one.out;
            if (address != 0) continue;
            address = endpoint.bEndpointAddress;
            if (isIn) one.packet = std::max<std::size_t>(1, endpoint.wMaxPacketSize & 0x7ff);
        }
        if (one.in != 0) found.push_back(one);
    }
    return found;
}

fs::path fileOf(libusb_device* device) {
    return fmt::format("/dev/bus/usb/{:03}/{:03}", libusb_get_bus_number(device), libusb_get_device_address(device));
}

Outage outageOf(int error, const fs::path& file) {
    if (error == LIBUSB_ERROR_ACCESS) return whyNotOpened(file, EACCES);
    if (error == LIBUSB_ERROR_NO_DEVICE || error == LIBUSB_ERROR_NOT_FOUND) return whyNotOpened(file, ENODEV);
    if (error == LIBUSB_ERROR_BUSY)
        return {DeviceState::Faulted, fmt::format("{} is held by another program; end that first", file.string())};
    return {DeviceState::Faulted, fmt::format("{}: {}", file.string(), libusb_strerror(error))};
}

}  // namespace fantascope::drivers
