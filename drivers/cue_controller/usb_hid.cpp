#include "drivers/cue_controller/usb_hid.h"

#include "drivers/common/file_handle.h"
#include "drivers/cue_controller/hid_profile.h"
#include "drivers/cue_controller/usb_bus.h"
#include "drivers/cue_controller/usb_hid_device.h"

#include <fmt/format.h>
#include <libusb.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

namespace fantascope::drivers {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

std::uint16_t hexadecimal(const std::string& digits) {
    std::uint16_t value = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    return value;
}

const HidProfile* profileOf(const UsbIdentity& usb) { return hidProfileOf(hexadecimal(usb.vendor), hexadecimal(usb.product)); }

// A libusb context to list devices; null if this machine has no USB.
using UsbContext = std::unique_ptr<libusb_context, decltype(&libusb_exit)>;
UsbContext listingContext() {
    libusb_context* opened = nullptr;
    return {libusb_init(&opened) == 0 ? opened : nullptr, &libusb_exit};
}

Result<std::string> fourDigits(const ConfigNode& node) {
    std::string text = TRY(node.text());
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char letter) { return std::tolower(letter); });
    if (text.size() != 4 || text.find_first_not_of("0123456789abcdef") != std::string::npos)
        return node.error(fmt::format("'{}' is not four hexadecimal digits, such as 046d", text));
    return text;
}

}  // namespace

bool UsbHidController::Options::fits(const UsbIdentity& usb) const {
    const auto isThat = [](const std::string& wanted, const std::string& is) { return wanted.empty() || wanted == is; };
    // Without any key only a device with a profile matches, never the machine's keyboard.
    if (vendor.empty() && product.empty() && serial.empty() && path.empty()) return profileOf(usb) != nullptr;
    return isThat(vendor, usb.vendor) && isThat(product, usb.product) && isThat(serial, usb.serial) && isThat(path, usb.path);
}

std::string UsbHidController::Options::description() const {
    std::string text = vendor.empty() && product.empty()
                           ? ""
                           : fmt::format(" {}:{}", vendor.empty() ? "*" : vendor, product.empty() ? "*" : product);
    if (!serial.empty()) text += " with serial " + serial;
    if (!path.empty()) text += " at " + path;
    return text;
}

std::string UsbHidController::Options::notFound() const {
    const std::string said = description();
    return said.empty() ? "no controller that has a profile" : "no USB controller" + said;
}

std::string UsbHidController::Options::claim() const {
    if (const UsbContext context = listingContext())
        for (const ListedDevice& device : hidDevices(context.get()))
            if (fits(device.usb)) return "cue controller at the USB port " + device.usb.path;
    return "cue controller" + description();
}

Result<Opening<CueController>> UsbHidController::fromConfig(const ConfigNode& options) {
    std::string driver;
    Options wanted;
    ConfigFields fields(options);
    fields.text("driver", driver);
    fields.optional().read("vendor", wanted.vendor, fourDigits);
    fields.optional().read("product", wanted.product, fourDigits);
    fields.optional().text("serial", wanted.serial);
    fields.optional().text("path", wanted.path);
    fields.optional().read("profile", wanted.profile, [](const ConfigNode& node) -> Result<const HidProfile*> {
        std::vector<std::string> names;
        for (const HidProfile& profile : hidProfiles()) names.emplace_back(profile.name);
        return &hidProfiles()[TRY(node.choice(names))];
    });
    fields.optional().time("debounce", wanted.debounce, 0, 0.5);
    fields.optional().boolean("ask_state", wanted.asksState);
    fields.optional().number("brightness", wanted.brightness, 0, 1);
    TRY(fields.finish());
    const auto open = [wanted](const DriverContext& context) -> Result<std::unique_ptr<CueController>> {
        return std::unique_ptr<CueController>(new UsbHidController(wanted, context.clock));
    };
    return Opening<CueController>{.open = open, .claim = [wanted] { return wanted.claim(); }};
}

UsbHidController::UsbHidController(Options options, Clock& clock)
    : options_(std::move(options)),
      clock_(clock),
      events_(options_.debounce),
      usb_(std::make_unique<UsbBus>()),
      service_("cue controller", "usb_hid", LossAction::Hold, [this](Service& service) { return runOnce(service); }) {}

UsbHidController::~UsbHidController() {
    closing_ = true;
    usb_->interrupt();
}

void UsbHidController::light(int button, const ButtonLight& light) {
    if (lights_.set(button, light)) usb_->interrupt();
}

Outage UsbHidController::runOnce(Service& service) {
    if (const auto started = usb_->start(); !started) return {DeviceState::Absent, started.error().message()};
    const auto fitting = [&] {
        auto devices = hidDevices(usb_->context());
        std::erase_if(devices, [&](const ListedDevice& device) { return !options_.fits(device.usb); });
        return devices;
    };
    auto devices = fitting();
    // Once reported as absent, it waits here for a device.
    while (devices.empty() && !closing_ && service.status().state == DeviceState::Absent) {
        usb_->wait(1s);
        devices = fitting();
    }
    std::optional<Outage> first;
    for (const ListedDevice& device : devices) {
        const HidProfile* const profile = options_.profile != nullptr ? options_.profile : profileOf(device.usb);
        UsbHidDevice life({*usb_, clock_, events_, lights_, closing_}, device, profile, options_.brightness);
        if (!life.outage()) life.readInitialState(options_.asksState);
        if (closing_) {
            life.darken();
            return {};
        }
        if (life.outage()) {
            events_.deviceLost(clock_.now());
            if (!first) first = life.outage();
            continue;  // another matching device may work
        }
        service.setRunning();
        while (!closing_ && !life.outage()) {
            const auto due = events_.nextFlush();
            usb_->wait(due ? *due - clock_.now() : Time(1s));
            events_.flush(clock_.now());
            life.poll();
            service.setTrouble(life.trouble());
        }
        if (closing_) life.darken();
        events_.deviceLost(clock_.now());
        return life.outage().value_or(Outage{});
    }
    return first.value_or(Outage{DeviceState::Absent, options_.notFound() + " is plugged in"});
}

std::vector<FoundDevice> findControllers() {
    const UsbContext context = listingContext();
    if (!context) return {};
    std::vector<FoundDevice> found;
    for (const ListedDevice& device : hidDevices(context.get())) {
        const UsbIdentity& usb = device.usb;
        const HidProfile* const profile = profileOf(usb);
        // The kernel shows the report descriptors of devices that its own drivers have.
        std::vector<HidInterface> interfaces;
        bool isHeld = false;
        for (const HidEndpoints& heard : hidInterfacesOf(device.get())) {
            const fs::path folder = fmt::format("/sys/bus/usb/devices/{}:1.{}", usb.path, heard.number);
            std::error_code none;
            isHeld = isHeld || fs::read_symlink(folder / "driver", none).filename() == "usbfs";
            for (const fs::directory_entry& entry : fs::directory_iterator(folder, none)) {
                std::ifstream file(entry.path() / "report_descriptor", std::ios::binary);
                const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
                auto parsed = parseHidDescriptor({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
                if (!bytes.empty() && parsed) interfaces.push_back({heard.number, std::move(parsed).value()});
            }
        }
        const auto count = layoutOf(interfaces, profile).count();
        const fs::path node = fileOf(device.get());

        FoundDevice one;
        one.family = "cue_controller";
        one.what =
            profile != nullptr ? std::string(profile->what) : usb.manufacturer + (usb.manufacturer.empty() ? "" : " ") + usb.name;
        if (one.what.empty()) one.what = "HID device";
        if (count > 0) one.what += fmt::format(", {} button{}", count, count == 1 ? "" : "s");
        one.identity = fmt::format("{}:{}", usb.vendor, usb.product);
        if (!usb.serial.empty()) one.identity += ", serial " + usb.serial;
        one.where = usb.path;
        if (isHeld)
            one.why = "another program holds it";
        else if (access(node.c_str(), R_OK | W_OK) != 0)
            one.why = whyNotOpened(node, errno).why;
        one.options =
            fmt::format("{{driver: usb_hid, vendor: {}, product: {}{}}}", fantascope::quoted(usb.vendor),
                        fantascope::quoted(usb.product), usb.serial.empty() ? "" : ", serial: " + fantascope::quoted(usb.serial));
        found.push_back(std::move(one));
    }
    return found;
}

}  // namespace fantascope::drivers
