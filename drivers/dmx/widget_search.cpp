#include "drivers/dmx/widget_search.h"

#include "drivers/common/claim.h"
#include "drivers/dmx/enttec_widget.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace fantascope::drivers {
namespace {

constexpr const char* kFtdi = "0403";  // all known widgets have an FTDI adapter

// How long a line may take to open.
constexpr Time kOpening = std::chrono::seconds(1);

// As those of Enttec and DMXking do. An Open DMX is a bare adapter and has the adapter's name.
bool callsItselfWidget(const UsbIdentity& usb) { return usb.name.find("DMX") != std::string::npos; }

std::vector<UsbFile> widgetLines() {
    std::vector<UsbFile> lines = serialLines({.file = {}, .vendor = kFtdi, .product = {}, .serial = {}});
    std::erase_if(lines, [](const UsbFile& line) { return !callsItselfWidget(line.usb); });
    return lines;
}

Result<std::filesystem::path> onlyWidget() {
    const std::vector<UsbFile> lines = widgetLines();
    if (lines.empty()) return Error("no DMX widget is plugged in");
    if (lines.size() == 1) return lines[0].file;
    std::vector<std::string> serials;
    for (const UsbFile& line : lines) serials.push_back(line.usb.serial);
    return Error(fmt::format("several DMX widgets are plugged in; choose one with 'serial': {}", fmt::join(serials, ", ")));
}

bool isByNumber(const WidgetChoice& choice) {
    return choice.line.file.empty() && choice.line.serial.empty() && !choice.number.empty();
}

std::string optionsFor(const char* driver, const UsbFile& line) {
    return line.usb.serial.empty() ? fmt::format("{{driver: {}, port: {}}}", driver, line.file.string())
                                   : fmt::format("{{driver: {}, serial: {}}}", driver, fantascope::quoted(line.usb.serial));
}

// Asks what is on a line. Error: why it cannot be used.
Result<std::string> whatIsOn(const UsbFile& line, Clock& clock) {
    SerialStream stream(
        "search", [&] { return Result<std::filesystem::path>(line.file); }, kWidgetSettings);
    for (const Time deadline = clock.now() + kOpening; clock.now() < deadline;) {
        if (stream.status().state != DeviceState::Starting) break;
        clock.sleepUntil(clock.now() + std::chrono::milliseconds(1));
    }
    if (const DeviceStatus status = stream.status(); status.state != DeviceState::Running) return Error(status.detail);
    EnttecWidget widget(stream, clock);
    const WidgetParameters parameters = TRY(widget.handshake());
    const std::string number = TRY(widget.number()), name = TRY(widget.name());
    return fmt::format("{}, firmware {}.{}, number {}", name.empty() ? line.usb.manufacturer + " " + line.usb.name : name,
                       parameters.firmware / 256, parameters.firmware % 256, number.empty() ? "none" : number);
}

FoundDevice describedWidget(const UsbFile& line, Clock& clock) {
    FoundDevice found{"dmx", "", "serial " + line.usb.serial, line.file.string(), "", optionsFor("enttec_pro", line)};
    const auto what = whatIsOn(line, clock);
    found.what = what ? *what : line.usb.manufacturer + " " + line.usb.name;
    if (!what) found.why = what.error().message();
    return found;
}

}  // namespace

void readWidgetLine(ConfigFields& fields, SerialIdentity& line) {
    fields.optional().read("port", line.file, [](const ConfigNode& node) -> Result<std::filesystem::path> {
        const std::filesystem::path port = TRY(node.text());
        if (!port.is_absolute()) return node.error("a device file is needed, such as /dev/ttyUSB0");
        return port;
    });
    fields.optional().read("serial", line.serial, [&](const ConfigNode& node) -> Result<std::string> {
        if (!line.file.empty()) return node.error("'port' already chooses the adapter");
        return node.text();
    });
}

void readWidgetNumber(ConfigFields& fields, std::string& number) {
    fields.optional().read("number", number, [](const ConfigNode& node) -> Result<std::string> {
        const std::string digits = TRY(node.text());
        if (digits.size() != 8 || digits.find_first_not_of("0123456789") != std::string::npos)
            return node.error("the eight digits printed on the widget are needed");
        return digits;
    });
}

Use useOf(const WidgetChoice& choice) {
    if (!choice.line.file.empty()) return {choice.line.file.string(), ""};
    if (!choice.line.serial.empty()) return {"the USB adapter serial " + choice.line.serial, ""};
    return {choice.number.empty() ? "the only DMX widget" : "the DMX widget " + choice.number, ""};
}

std::string claimOf(const WidgetChoice& choice) {
    if (isByNumber(choice)) return useOf(choice).what;
    const auto file = widgetFinder(choice)();
    return file ? claimOfFile(kSerialLine, *file) : useOf(choice).what;
}

SerialStream::Find widgetFinder(const WidgetChoice& choice) {
    if (!choice.line.file.empty() || !choice.line.serial.empty()) return [line = choice.line] { return findSerialLine(line); };
    if (!isByNumber(choice)) return onlyWidget;
    return [number = choice.number, next = std::size_t{0}]() mutable -> Result<std::filesystem::path> {
        const std::vector<UsbFile> lines = serialLines({.file = {}, .vendor = kFtdi, .product = {}, .serial = {}});
        if (lines.empty()) return Error(fmt::format("no adapter that could be widget {} is plugged in", number));
        return lines[next++ % lines.size()].file;
    };
}

std::vector<FoundDevice> findWidgets() {
    SteadyClock clock;
    std::vector<FoundDevice> found;
    for (const UsbFile& line : serialLines({.file = {}, .vendor = kFtdi, .product = {}, .serial = {}})) {
        if (callsItselfWidget(line.usb)) {
            found.push_back(describedWidget(line, clock));
        } else {
            found.push_back({"dmx",
                             fmt::format("{} {}: an Open DMX or another serial adapter", line.usb.manufacturer, line.usb.name),
                             "serial " + line.usb.serial, line.file.string(), "", optionsFor("open_dmx", line)});
        }
    }
    return found;
}

}  // namespace fantascope::drivers
