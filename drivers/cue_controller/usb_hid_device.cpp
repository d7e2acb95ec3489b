#include "drivers/cue_controller/usb_hid_device.h"

#include <fmt/format.h>
#include <libusb.h>

#include <algorithm>
#include <string>
#include <utility>

namespace fantascope::drivers {
namespace {

using namespace std::chrono_literals;

// HID 1.11, sections 6.2.1 and 7: descriptor types and requests.
constexpr std::uint8_t kReportDescriptor = 0x22, kGetReport = 0x01, kSetReport = 0x09, kSetIdle = 0x0a;
constexpr int kInputReport = 1, kOutputReport = 2, kFeatureReport = 3;
constexpr std::uint8_t kFromInterface = 0x81, kFromHid = 0xa1, kToHid = 0x21;  // bmRequestType

constexpr unsigned kDescriptorTimeout = 1000, kStateTimeout = 200;  // milliseconds
// A device that nobody listened to may hold a report or two from before, which come with the first
// polls. No device with buttons has a bInterval longer than a fifth of this.
constexpr Time kSettling = 100ms;
constexpr int kQueued = 8;      // transfers per interface that wait for reports
constexpr int kMaxErrors = 64;  // consecutive, of transfers

constexpr unsigned kLightTimeout = 1000, kDarkenTimeout = 200;  // milliseconds, for one report
constexpr Time kLightPause = 1s;                                // after a report that was refused
constexpr int kMaxFailures = 8;                                 // consecutive, to send lights

std::uint16_t reportValue(int type, int id) { return static_cast<std::uint16_t>(type << 8 | id); }

}  // namespace

UsbHidDevice::UsbHidDevice(const Environment& environment, const ListedDevice& device, const HidProfile* profile,
                           double brightness)
    : environment_(environment),
      file_(fileOf(device.get())),
      handle_(nullptr, &libusb_close),
      brightness_(brightness),
      outTransfer_(libusb_alloc_transfer(0), &libusb_free_transfer) {
    libusb_device_handle* opened = nullptr;
    if (const int error = libusb_open(device.get(), &opened); error != 0) {
        outage_ = outageOf(error, file_);
        return;
    }
    handle_.reset(opened);
    libusb_set_auto_detach_kernel_driver(opened, 1);
    if (!claim(hidInterfacesOf(device.get())) || !readLayout(profile)) return;
    if (profile != nullptr) lamps_ = lampsOf(profile->lamps, interfaces_);
    listen();
    startLamps();
}

UsbHidDevice::~UsbHidDevice() {
    isEnding_ = true;
    for (const Transfer& transfer : transfers_) libusb_cancel_transfer(transfer.get());
    if (isSending_) libusb_cancel_transfer(outTransfer_.get());
    while (inFlight_ > 0) environment_.bus.wait(1s);  // each completes, cancelled or not
    for (const HidEndpoints& heard : claimed_) libusb_release_interface(handle_.get(), heard.number);
}

void UsbHidDevice::readInitialState(bool ask) {
    const Time end = environment_.clock.now() + kSettling;
    if (ask) askState();
    while (!outage_ && !environment_.closing && environment_.clock.now() < end) {
        environment_.bus.wait(end - environment_.clock.now());
        poll();
    }
    isSettled_ = true;
}

void UsbHidDevice::poll() {
    for (libusb_transfer* const transfer : std::exchange(stopped_, {})) {
        libusb_clear_halt(handle_.get(), transfer->endpoint);
        submit(transfer);
    }
    sendLights();
}

bool UsbHidDevice::claim(const std::vector<HidEndpoints>& interfaces) {
    for (const HidEndpoints& heard : interfaces) {
        if (const int error = libusb_claim_interface(handle_.get(), heard.number); error != 0) {
            outage_ = outageOf(error, file_);
            return false;
        }
        claimed_.push_back(heard);
    }
    return true;
}

bool UsbHidDevice::readLayout(const HidProfile* profile) {
    std::string why = "its descriptors name no buttons";
    for (const HidEndpoints& heard : claimed_) {
        std::vector<std::uint8_t> bytes(heard.descriptorSize);
        const int count = libusb_control_transfer(handle_.get(), kFromInterface, LIBUSB_REQUEST_GET_DESCRIPTOR,
                                                  kReportDescriptor << 8, static_cast<std::uint16_t>(heard.number), bytes.data(),
                                                  heard.descriptorSize, kDescriptorTimeout);
        if (count == LIBUSB_ERROR_NO_DEVICE) {
            outage_ = outageOf(count, file_);
            return false;
        }
        auto parsed = count < 0 ? Result<HidDescriptor>(Error(fmt::format("no report descriptor: {}", libusb_strerror(count))))
                                : parseHidDescriptor(std::span(bytes).first(static_cast<std::size_t>(count)));
        if (parsed)
            interfaces_.push_back({heard.number, std::move(parsed).value()});
        else
            why = fmt::format("interface {}: {}", heard.number, parsed.error().message());
    }
    HidLayout layout = layoutOf(interfaces_, profile);
    if (layout.controls.empty()) {
        outage_ = {DeviceState::Faulted, fmt::format("it has no usable buttons: {}", why)};
        return false;
    }
    buttons_.emplace(std::move(layout));
    return true;
}

void UsbHidDevice::listen() {
    for (const HidEndpoints& heard : claimed_) {
        // Requests changes only, no repeats. A device that does not support this says so; that is
        // no fault.
        libusb_control_transfer(handle_.get(), kToHid, kSetIdle, 0, static_cast<std::uint16_t>(heard.number), nullptr, 0,
                                kStateTimeout);
        std::size_t longest = 1;
        for (const HidInterface& interface : interfaces_)
            if (interface.number == heard.number)
                for (const HidReport& report : interface.descriptor.inputReports) longest = std::max(longest, report.bytes);
        // Whole packets, so that a device that sends more than it declared causes no error.
        const std::size_t size = (longest + heard.packet - 1) / heard.packet * heard.packet;
        for (int i = 0; i < kQueued; ++i) {
            auto& buffer = buffers_.emplace_back(size);
            auto& transfer = transfers_.emplace_back(libusb_alloc_transfer(0), &libusb_free_transfer);
            libusb_fill_interrupt_transfer(transfer.get(), handle_.get(), heard.in, buffer.data(), static_cast<int>(size),
                                           &UsbHidDevice::completed, this, 0);
            interfaceOf_[heard.in] = heard.number;
            submit(transfer.get());
        }
    }
}

void UsbHidDevice::askState() {
    for (const HidInterface& interface : interfaces_)
        for (const HidReport& report : interface.descriptor.inputReports) {
            std::vector<std::uint8_t> bytes(report.bytes);
            const int count = libusb_control_transfer(handle_.get(), kFromHid, kGetReport, reportValue(kInputReport, report.id),
                                                      static_cast<std::uint16_t>(interface.number), bytes.data(),
                                                      static_cast<std::uint16_t>(bytes.size()), kStateTimeout);
            if (count == LIBUSB_ERROR_TIMEOUT) return;  // it ignores unknown requests instead of refusing them
            if (count > 0) take(interface.number, std::span(bytes).first(static_cast<std::size_t>(count)));
        }
}

void UsbHidDevice::take(int interface, std::span<const std::uint8_t> report) {
    if (report.empty()) return;
    const auto changes = buttons_->take(interface, report);
    if (isSettled_)
        environment_.events.feed(changes, environment_.clock.now());
    else
        environment_.events.setInitial(changes);
}

void UsbHidDevice::submit(libusb_transfer* transfer) {
    if (isEnding_) return;  // a report that came just before the cancellation completes its transfer
    const int error = libusb_submit_transfer(transfer);
    if (error == 0)
        ++inFlight_;
    else if (!outage_)
        outage_ = outageOf(error, file_);
}

void UsbHidDevice::completed(libusb_transfer* transfer) {
    UsbHidDevice& device = *static_cast<UsbHidDevice*>(transfer->user_data);
    --device.inFlight_;
    switch (transfer->status) {
        case LIBUSB_TRANSFER_COMPLETED:
            device.errors_ = 0;
            device.take(device.interfaceOf_[transfer->endpoint],
                        {transfer->buffer, static_cast<std::size_t>(transfer->actual_length)});
            return device.submit(transfer);
        case LIBUSB_TRANSFER_STALL:
            device.stopped_.push_back(transfer);
            [[fallthrough]];
        case LIBUSB_TRANSFER_ERROR:
        case LIBUSB_TRANSFER_OVERFLOW:
        case LIBUSB_TRANSFER_TIMED_OUT:
            if (++device.errors_ >= kMaxErrors && !device.outage_)
                device.outage_ = {DeviceState::Faulted, "its reports have errors; check its cable"};
            if (!device.outage_ && transfer->status != LIBUSB_TRANSFER_STALL) device.submit(transfer);
            return;
        case LIBUSB_TRANSFER_CANCELLED:
            return;
        case LIBUSB_TRANSFER_NO_DEVICE:
            if (!device.outage_) device.outage_ = {DeviceState::Absent, "it was unplugged; plug it in again"};
            return;
    }
}

void UsbHidDevice::startLamps() {
    if (lamps_ == nullptr) return;
    environment_.lights.invalidate(lamps_->count());
    const auto first = lamps_->begin(brightness_);
    outgoing_.assign(first.begin(), first.end());
}

void UsbHidDevice::sendLights() {
    if (lamps_ == nullptr || isSending_ || outage_ || environment_.clock.now() < nextAttempt_) return;
    while (outgoing_.empty()) {
        const auto next = environment_.lights.next();
        if (!next) return;
        const auto reports = lamps_->show(next->first, next->second);
        outgoing_.assign(reports.begin(), reports.end());
    }
    submitReport(outgoing_.front());
}

std::uint8_t UsbHidDevice::outEndpointOf(const HidOutReport& report) const {
    for (const HidEndpoints& interface : claimed_)
        if (interface.number == report.interface && !report.feature) return interface.out;
    return 0;
}

// HID 1.11, sections 4.4 and 7.2.2: output reports go to the interrupt endpoint where there is one.
void UsbHidDevice::submitReport(const HidOutReport& report) {
    const std::uint8_t endpoint = outEndpointOf(report);
    if (endpoint != 0) {
        if (std::exchange(isOutStopped_, false)) libusb_clear_halt(handle_.get(), endpoint);
        sending_ = report.bytes;
        libusb_fill_interrupt_transfer(outTransfer_.get(), handle_.get(), endpoint, sending_.data(),
                                       static_cast<int>(sending_.size()), &UsbHidDevice::sent, this, kLightTimeout);
    } else {
        sending_.resize(LIBUSB_CONTROL_SETUP_SIZE);
        libusb_fill_control_setup(sending_.data(), kToHid, kSetReport,
                                  reportValue(report.feature ? kFeatureReport : kOutputReport, report.id),
                                  static_cast<std::uint16_t>(report.interface), static_cast<std::uint16_t>(report.bytes.size()));
        sending_.insert(sending_.end(), report.bytes.begin(), report.bytes.end());
        libusb_fill_control_transfer(outTransfer_.get(), handle_.get(), sending_.data(), &UsbHidDevice::sent, this,
                                     kLightTimeout);
    }
    const int error = libusb_submit_transfer(outTransfer_.get());
    isSending_ = error == 0;
    if (error == 0)
        ++inFlight_;
    else if (error == LIBUSB_ERROR_NO_DEVICE)
        outage_ = outageOf(error, file_);
    else
        failToSend();
}

void UsbHidDevice::sent(libusb_transfer* transfer) {
    UsbHidDevice& device = *static_cast<UsbHidDevice*>(transfer->user_data);
    --device.inFlight_;
    device.isSending_ = false;
    switch (transfer->status) {
        case LIBUSB_TRANSFER_COMPLETED:
            device.failures_ = 0;
            device.outgoing_.pop_front();
            return;
        case LIBUSB_TRANSFER_STALL:
            device.isOutStopped_ = true;
            [[fallthrough]];
        case LIBUSB_TRANSFER_ERROR:
        case LIBUSB_TRANSFER_OVERFLOW:
        case LIBUSB_TRANSFER_TIMED_OUT:
            return device.failToSend();
        case LIBUSB_TRANSFER_CANCELLED:
            return;
        case LIBUSB_TRANSFER_NO_DEVICE:
            if (!device.outage_) device.outage_ = {DeviceState::Absent, "it was unplugged; plug it in again"};
            return;
    }
}

// A device that refuses lights still works as a controller.
void UsbHidDevice::failToSend() {
    if (++failures_ >= kMaxFailures) {
        trouble_ = "it refuses lights; its buttons still work. Plug it in again to retry the lights";
        lamps_.reset();
        return;
    }
    nextAttempt_ = environment_.clock.now() + kLightPause;
    startLamps();
}

void UsbHidDevice::darken() {
    if (lamps_ == nullptr || outage_) return;
    if (isSending_) libusb_cancel_transfer(outTransfer_.get());
    while (isSending_) environment_.bus.wait(1s);
    for (const int button : environment_.lights.lit())
        for (const HidOutReport& report : lamps_->show(button, {}))
            if (outage_ || !sendNow(report)) return;
}

bool UsbHidDevice::sendNow(const HidOutReport& report) {
    auto bytes = report.bytes;
    const int size = static_cast<int>(bytes.size());
    if (const std::uint8_t endpoint = outEndpointOf(report); endpoint != 0) {
        int count = 0;
        return libusb_interrupt_transfer(handle_.get(), endpoint, bytes.data(), size, &count, kDarkenTimeout) == 0;
    }
    return libusb_control_transfer(handle_.get(), kToHid, kSetReport,
                                   reportValue(report.feature ? kFeatureReport : kOutputReport, report.id),
                                   static_cast<std::uint16_t>(report.interface), bytes.data(), static_cast<std::uint16_t>(size),
                                   kDarkenTimeout) == size;
}

}  // namespace fantascope::drivers
