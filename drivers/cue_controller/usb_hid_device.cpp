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

constexpr unsigned kDescriptorPatience = 1000, kStatePatience = 200;  // milliseconds
// A device that was not listened to has a report or two from that time left, which come with the
// first polls; no bInterval of a device with buttons is longer than a fifth of this.
constexpr Time kSettling = 100ms;
constexpr int kQueued = 8;       // transfers of an interface that wait for reports
constexpr int kMostErrors = 64;  // of transfers, one after the other

constexpr unsigned kLightPatience = 1000, kFarewellPatience = 200;  // milliseconds, for one report
constexpr Time kLightPause = 1s;                                    // after a report that was not taken
constexpr int kMostFailures = 8;                                    // to send lights, one after the other

std::uint16_t reportValue(int type, int id) { return static_cast<std::uint16_t>(type << 8 | id); }

}  // namespace

UsbHidDevice::UsbHidDevice(const Around& around, const ListedDevice& device, const HidProfile* profile, double brightness)
    : around_(around),
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
    if (!claim(hidInterfacesOf(device.get())) || !layOut(profile)) return;
    if (profile != nullptr) lamps_ = lampsOf(profile->lamps, interfaces_);
    listen();
    startLamps();
}

UsbHidDevice::~UsbHidDevice() {
    isEnding_ = true;
    for (const Transfer& transfer : transfers_) libusb_cancel_transfer(transfer.get());
    if (isSending_) libusb_cancel_transfer(outTransfer_.get());
    while (inFlight_ > 0) around_.bus.wait(1s);  // each comes back, cancelled or not
    for (const HidEndpoints& heard : claimed_) libusb_release_interface(handle_.get(), heard.number);
}

void UsbHidDevice::settle(bool asks) {
    const Time end = around_.clock.now() + kSettling;
    if (asks) askState();
    while (!outage_ && !around_.leaving && around_.clock.now() < end) {
        around_.bus.wait(end - around_.clock.now());
        tend();
    }
    isSettled_ = true;
}

void UsbHidDevice::tend() {
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

bool UsbHidDevice::layOut(const HidProfile* profile) {
    std::string why = "its descriptors name nothing to press";
    for (const HidEndpoints& heard : claimed_) {
        std::vector<std::uint8_t> bytes(heard.descriptorSize);
        const int count = libusb_control_transfer(handle_.get(), kFromInterface, LIBUSB_REQUEST_GET_DESCRIPTOR,
                                                  kReportDescriptor << 8, static_cast<std::uint16_t>(heard.number), bytes.data(),
                                                  heard.descriptorSize, kDescriptorPatience);
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
        outage_ = {DeviceState::Faulted, fmt::format("it has no buttons: {}", why)};
        return false;
    }
    buttons_.emplace(std::move(layout));
    return true;
}

void UsbHidDevice::listen() {
    for (const HidEndpoints& heard : claimed_) {
        // Only changes, no repeats; who does not know it says so, and that is all.
        libusb_control_transfer(handle_.get(), kToHid, kSetIdle, 0, static_cast<std::uint16_t>(heard.number), nullptr, 0,
                                kStatePatience);
        std::size_t longest = 1;
        for (const HidInterface& interface : interfaces_)
            if (interface.number == heard.number)
                for (const HidReport& report : interface.descriptor.inputReports) longest = std::max(longest, report.bytes);
        // Whole packets: a device that sends more than it says does not end the transfer with an
        // error.
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
                                                      static_cast<std::uint16_t>(bytes.size()), kStatePatience);
            if (count == LIBUSB_ERROR_TIMEOUT) return;  // it knows no such request, and no manners
            if (count > 0) take(interface.number, std::span(bytes).first(static_cast<std::size_t>(count)));
        }
}

void UsbHidDevice::take(int interface, std::span<const std::uint8_t> report) {
    if (report.empty()) return;
    const auto changes = buttons_->take(interface, report);
    if (isSettled_)
        around_.events.take(changes, around_.clock.now());
    else
        around_.events.settle(changes);
}

void UsbHidDevice::submit(libusb_transfer* transfer) {
    if (isEnding_) return;  // a report that came just before its transfer was cancelled completes it
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
            if (++device.errors_ >= kMostErrors && !device.outage_)
                device.outage_ = {DeviceState::Faulted, "its reports come with errors; look at its cable"};
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
    around_.lights.restart(lamps_->count());
    const auto first = lamps_->begin(brightness_);
    outgoing_.assign(first.begin(), first.end());
}

void UsbHidDevice::sendLights() {
    if (lamps_ == nullptr || isSending_ || outage_ || around_.clock.now() < nextAttempt_) return;
    while (outgoing_.empty()) {
        const auto next = around_.lights.next();
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
                                       static_cast<int>(sending_.size()), &UsbHidDevice::sent, this, kLightPatience);
    } else {
        sending_.resize(LIBUSB_CONTROL_SETUP_SIZE);
        libusb_fill_control_setup(sending_.data(), kToHid, kSetReport,
                                  reportValue(report.feature ? kFeatureReport : kOutputReport, report.id),
                                  static_cast<std::uint16_t>(report.interface), static_cast<std::uint16_t>(report.bytes.size()));
        sending_.insert(sending_.end(), report.bytes.begin(), report.bytes.end());
        libusb_fill_control_transfer(outTransfer_.get(), handle_.get(), sending_.data(), &UsbHidDevice::sent, this,
                                     kLightPatience);
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

// A device that does not take its lights is no worse as a controller.
void UsbHidDevice::failToSend() {
    if (++failures_ >= kMostFailures) {
        trouble_ = "it takes no lights; its buttons serve all the same. Plug it in again";
        lamps_.reset();
        return;
    }
    nextAttempt_ = around_.clock.now() + kLightPause;
    startLamps();
}

void UsbHidDevice::darken() {
    if (lamps_ == nullptr || outage_) return;
    if (isSending_) libusb_cancel_transfer(outTransfer_.get());
    while (isSending_) around_.bus.wait(1s);
    for (const int button : around_.lights.lit())
        for (const HidOutReport& report : lamps_->show(button, {}))
            if (outage_ || !sendNow(report)) return;
}

bool UsbHidDevice::sendNow(const HidOutReport& report) {
    auto bytes = report.bytes;
    const int size = static_cast<int>(bytes.size());
    if (const std::uint8_t endpoint = outEndpointOf(report); endpoint != 0) {
        int count = 0;
        return libusb_interrupt_transfer(handle_.get(), endpoint, bytes.data(), size, &count, kFarewellPatience) == 0;
    }
    return libusb_control_transfer(handle_.get(), kToHid, kSetReport,
                                   reportValue(report.feature ? kFeatureReport : kOutputReport, report.id),
                                   static_cast<std::uint16_t>(report.interface), bytes.data(), static_cast<std::uint16_t>(size),
                                   kFarewellPatience) == size;
}

}  // namespace fantascope::drivers
