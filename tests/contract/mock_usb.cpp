#include "contract/mock_usb.h"

#include "core/check.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <umockdev.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <utility>

namespace fantascope {
namespace {

constexpr int kPipe = 4096;

using Bytes = std::vector<std::uint8_t>;

std::string hex(const Bytes& bytes) {
    std::string text;
    for (const std::uint8_t byte : bytes) text += fmt::format("{:02X}", byte);
    return text;
}

void append(Bytes& to, const Bytes& more) { to.insert(to.end(), more.begin(), more.end()); }
std::uint8_t low(std::size_t value) { return static_cast<std::uint8_t>(value & 0xff); }
std::uint8_t high(std::size_t value) { return static_cast<std::uint8_t>(value >> 8 & 0xff); }

// USB 2.0, section 9.6: the device's descriptor and that of its one configuration.
Bytes descriptorsOf(const MockUsbDevice& device) {
    Bytes bytes = {18, 1, 0, 2, 0, 0, 0, 64, low(device.vendor), high(device.vendor), low(device.product), high(device.product),
                   0,  1, 0, 0, 0, 1};
    Bytes interfaces;
    for (std::size_t i = 0; i < device.reportDescriptors.size(); ++i) {
        const std::size_t length = device.reportDescriptors[i].size();
        const auto endpoints = static_cast<std::uint8_t>(device.hasOutEndpoints ? 2 : 1);
        append(interfaces, {9, 4, low(i), 0, endpoints, 3, 0, 0, 0});
        append(interfaces, {9, 0x21, 0x11, 1, 0, 1, 0x22, low(length), high(length)});
        append(interfaces, {7, 5, static_cast<std::uint8_t>(0x81 + i), 3, 64, 0, 1});
        if (device.hasOutEndpoints) append(interfaces, {7, 5, static_cast<std::uint8_t>(0x01 + i), 3, 64, 0, 1});
    }
    const std::size_t total = 9 + interfaces.size();
    append(bytes, {9, 2, low(total), high(total), low(device.reportDescriptors.size()), 1, 0, 0x80, 50});
    append(bytes, interfaces);
    return bytes;
}

// A request from libusb to usbfs, and its place in libusb's memory.
struct Urb {
    UMockdevIoctlData* request = nullptr;
    UMockdevIoctlData* buffer = nullptr;

    usbdevfs_urb& of() const { return *reinterpret_cast<usbdevfs_urb*>(request->data); }
};

struct Answer {
    Urb urb;
    int status = 0;
    Bytes bytes;
};

struct Endpoint {
    std::deque<Urb> waiting;
    std::deque<Bytes> reports;      // not requested yet
    std::optional<Bytes> atCancel;  // arrives when a transfer is being cancelled
};

}  // namespace

// One plugged device, and usbfs's work with it.
class MockUsb::Plugged {
public:
    Plugged(UMockdevTestbed* bed, MockUsbDevice device, int address, std::map<int, Bytes>& states)
        : bed_(bed),
          device_(std::move(device)),
          address_(address),
          states_(states),
          endpoints_(device_.reportDescriptors.size()) {
        for (std::size_t i = 0; i < endpoints_.size(); ++i) kernelHas_.insert(static_cast<unsigned>(i));
        node_ = fmt::format("/dev/bus/usb/001/{:03}", address);
        folder_ = "/sys/devices/pci0000:00/0000:00:14.0/usb1/" + device_.path;
        const std::string entry = fmt::format(
            "P: {0}\nE: BUSNUM=001\nE: DEVNAME={2}\nE: DEVNUM={1:03}\nE: DEVTYPE=usb_device\nE: "
            "MAJOR=189\n"
            "E: MINOR={3}\nE: SUBSYSTEM=usb\nA: bConfigurationValue=1\\n\nA: busnum=1\\n\nA: devnum={1}\\n\nA: speed=12\\n\n"
            "A: idVendor={4:04x}\\n\nA: idProduct={5:04x}\\n\nA: manufacturer=Lumen\\n\nA: product={6}\\n\nA: serial={7}\\n\n"
            "H: descriptors={8}\n",
            folder_.substr(4), address, node_, address - 1, device_.vendor, device_.product, device_.name, device_.serial,
            hex(descriptorsOf(device_)));
        std::string entries = entry;
        for (std::size_t i = 0; i < endpoints_.size(); ++i)
            entries += fmt::format(
                "\nP: {0}\nE: DEVTYPE=usb_interface\nE: SUBSYSTEM=usb\nA: bInterfaceNumber={1:02x}\\n\n"
                "\nP: {2}\nE: SUBSYSTEM=hid\nH: report_descriptor={3}\n",
                interfaceFolder(i).substr(4), i, hidFolder(i).substr(4), hex(device_.reportDescriptors[i]));
        // libusb may open the device before its event: a late event of the same port is enough; and
        // it may open it after it is gone. So its file and its handler come first and go last. If
        // open() failed, umockdev would keep descriptor -1 and the connection that belongs to it;
        // and a read() of -1 on umockdev's own thread would wait for itself.
        FANTASCOPE_CHECK(mkfifo(file().c_str(), 0600) == 0, "no pipe");
        pipe_ = ::open(file().c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
        // usbfs signals an available answer by POLLOUT; a pipe has POLLOUT unless it is full.
        FANTASCOPE_CHECK(fcntl(pipe_, F_SETPIPE_SZ, kPipe) == kPipe, "no small pipe");
        showAnswers();
        GError* error = nullptr;
        handler_ = umockdev_ioctl_base_new();
        g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(&Plugged::onIoctl), this);
        { const std::lock_guard lock(mutex_); }  // umockdev's thread takes it, and sees everything above
        FANTASCOPE_CHECK(umockdev_testbed_attach_ioctl(bed_, node_.c_str(), handler_, &error) != 0, error->message);
        FANTASCOPE_CHECK(umockdev_testbed_add_from_string(bed_, entries.c_str(), &error) != 0, error->message);
        umockdev_testbed_uevent(bed_, folder_.c_str(), "add");
    }
    ~Plugged() {
        unlink(file().c_str());
        umockdev_testbed_detach_ioctl(bed_, node_.c_str(), nullptr);
        { const std::lock_guard lock(mutex_); }  // after the last answer of umockdev's thread
        g_object_unref(handler_);
        ::close(pipe_);
    }

    // A program that has it open still gets an answer to its requests: there is no device.
    void unplug() {
        {
            const std::lock_guard lock(mutex_);
            isGone_ = true;
            for (Endpoint& endpoint : endpoints_) {
                for (const Urb& urb : endpoint.waiting) answers_.push_back({urb, -ESHUTDOWN, {}});
                endpoint = {};
            }
            for (const Urb& urb : std::exchange(offered_, {})) answers_.push_back({urb, -ESHUTDOWN, {}});
            showAnswers();
        }
        umockdev_testbed_uevent(bed_, folder_.c_str(), "remove");
        for (std::size_t i = 0; i < endpoints_.size(); ++i) {
            umockdev_testbed_remove_device(bed_, hidFolder(i).c_str());
            umockdev_testbed_remove_device(bed_, interfaceFolder(i).c_str());
        }
        umockdev_testbed_remove_device(bed_, folder_.c_str());
    }

    void report(int interface, const Bytes& bytes) {
        const std::lock_guard lock(mutex_);
        endpoints_.at(static_cast<std::size_t>(interface)).reports.push_back(bytes);
        hear();
    }

    void reportAtCancel(int interface, const Bytes& bytes) {
        const std::lock_guard lock(mutex_);
        endpoints_.at(static_cast<std::size_t>(interface)).atCancel = bytes;
    }

    void fail(int interface, int status) {
        const std::lock_guard lock(mutex_);
        Endpoint& endpoint = endpoints_.at(static_cast<std::size_t>(interface));
        if (endpoint.waiting.empty()) return;
        ++owed_;
        answers_.push_back({endpoint.waiting.front(), status, {}});
        endpoint.waiting.pop_front();
        showAnswers();
    }

    std::vector<MockUsbReport> sent() const {
        const std::lock_guard lock(mutex_);
        return sent_;
    }
    void take(Taking taking) {
        const std::lock_guard lock(mutex_);
        taking_ = taking;
        if (taking != Taking::Nothing)
            for (const Urb& urb : std::exchange(offered_, {})) answers_.push_back(taken(urb));
        showAnswers();
    }

    void forbid() const {
        chmod(file().c_str(), 0);
        // Files by which umockdev itself talks to the program; a user other than root may use them.
        const std::string root = file().substr(0, file().size() - node_.size());
        for (const std::string& path : {root + node_, root + "/ioctl" + node_})
            for (std::size_t at = root.size(); at != std::string::npos; at = path.find('/', at + 1))
                chmod(path.substr(0, at).c_str(), 0777);
        chmod((root + "/ioctl" + node_).c_str(), 0777);
    }

    bool isHeard() const {
        const std::lock_guard lock(mutex_);
        for (const Endpoint& endpoint : endpoints_)
            if (!endpoint.reports.empty()) return false;
        return owed_ == 0;
    }
    bool kernelHas(int interface) const {
        const std::lock_guard lock(mutex_);
        return kernelHas_.contains(static_cast<unsigned>(interface));
    }
    std::size_t waiting(int interface) const {
        const std::lock_guard lock(mutex_);
        return endpoints_.at(static_cast<std::size_t>(interface)).waiting.size();
    }

private:
    std::string interfaceFolder(std::size_t number) const { return fmt::format("{}/{}:1.{}", folder_, device_.path, number); }
    std::string hidFolder(std::size_t number) const {
        return fmt::format("{}/0003:{:04X}:{:04X}.{:04X}", interfaceFolder(number), device_.vendor, device_.product,
                           static_cast<std::size_t>(address_) * 16 + number);
    }
    std::string file() const {
        char* const root = umockdev_testbed_get_root_dir(bed_);
        const std::string path = root + node_;
        g_free(root);
        return path;
    }

    static gboolean onIoctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
        Plugged& plugged = *static_cast<Plugged*>(self);
        const std::lock_guard lock(plugged.mutex_);
        int error = 0;
        const int result =
            plugged.answer(umockdev_ioctl_client_get_request(client), umockdev_ioctl_client_get_arg(client), error);
        umockdev_ioctl_client_complete(client, error == 0 ? result : -1, error);
        return TRUE;
    }

    template <class Value>
    static Value valueAt(UMockdevIoctlData* argument) {
        UMockdevIoctlData* const data = umockdev_ioctl_data_resolve(argument, 0, sizeof(Value), nullptr);
        Value value;
        std::memcpy(&value, data->data, sizeof value);
        g_object_unref(data);
        return value;
    }

    // The ioctls of linux/usbdevice_fs.h that libusb uses.
    int answer(unsigned long request, UMockdevIoctlData* argument, int& error) {
        const auto code = static_cast<std::uint32_t>(request);
        if (isGone_ && code != USBDEVFS_REAPURBNDELAY) {
            error = ENODEV;
            return -1;
        }
        switch (code) {
            case USBDEVFS_GET_CAPABILITIES: {
                std::uint32_t can =
                    USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
                UMockdevIoctlData* const data = umockdev_ioctl_data_resolve(argument, 0, sizeof can, nullptr);
                umockdev_ioctl_data_update(data, 0, reinterpret_cast<guint8*>(&can), sizeof can);
                g_object_unref(data);
                return 0;
            }
            case USBDEVFS_DISCONNECT_CLAIM:
                kernelHas_.erase(valueAt<usbdevfs_disconnect_claim>(argument).interface);
                return 0;
            case USBDEVFS_CLAIMINTERFACE:
                error = kernelHas_.contains(valueAt<unsigned>(argument)) ? EBUSY : 0;
                return 0;
            case USBDEVFS_RELEASEINTERFACE:
            case USBDEVFS_CLEAR_HALT:
                return 0;
            case USBDEVFS_IOCTL: {
                const auto inner = valueAt<usbdevfs_ioctl>(argument);
                if (static_cast<unsigned>(inner.ioctl_code) != USBDEVFS_CONNECT) break;
                kernelHas_.insert(static_cast<unsigned>(inner.ifno));
                return 1;
            }
            case USBDEVFS_SUBMITURB:
                submit(argument);
                return 0;
            case USBDEVFS_DISCARDURB:
                error = discard(argument) ? 0 : EINVAL;
                return 0;
            case USBDEVFS_REAPURBNDELAY:
                error = reap(argument) ? 0 : isGone_ ? ENODEV : EAGAIN;
                return 0;
        }
        error = ENOTTY;
        return -1;
    }

    void submit(UMockdevIoctlData* argument) {
        Urb urb;
        urb.request = umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), nullptr);
        urb.buffer = umockdev_ioctl_data_resolve(urb.request, offsetof(usbdevfs_urb, buffer),
                                                 static_cast<gsize>(urb.of().buffer_length), nullptr);
        if (isOut(urb)) {
            if (taking_ == Taking::Nothing)
                offered_.push_back(urb);
            else
                answers_.push_back(taken(urb));
        } else if (urb.of().type == USBDEVFS_URB_TYPE_CONTROL) {
            answers_.push_back(controlled(urb));
        } else {
            if (owed_ > 0) --owed_;
            endpoints_.at((urb.of().endpoint & 0x0f) - 1u).waiting.push_back(urb);
            hear();
        }
        showAnswers();
    }

    // Whether it is a report to the device, by either way.
    static bool isOut(const Urb& urb) {
        if (urb.of().type != USBDEVFS_URB_TYPE_CONTROL) return (urb.of().endpoint & 0x80) == 0;
        return urb.buffer->data[0] == 0x21 && urb.buffer->data[1] == 0x09;  // SET_REPORT
    }
    Answer taken(const Urb& urb) {
        if (taking_ == Taking::Stalls) return {urb, -EPIPE, {}};
        const std::uint8_t* const data = urb.buffer->data;
        const std::uint8_t* const end = data + urb.of().buffer_length;
        if (urb.of().type == USBDEVFS_URB_TYPE_CONTROL)
            sent_.push_back({data[4], data[3] == 3, false, data[2], Bytes(data + 8, end)});
        else
            sent_.push_back({urb.of().endpoint - 1, false, true, 0, Bytes(data, end)});
        return {urb, 0, Bytes(sent_.back().bytes)};
    }

    // USB 2.0, section 9.4, and HID 1.11, section 7.2.
    Answer controlled(const Urb& urb) const {
        const std::uint8_t* const setup = urb.buffer->data;
        const auto interface = static_cast<std::size_t>(setup[4] | setup[5] << 8);
        const auto wanted = static_cast<std::size_t>(setup[6] | setup[7] << 8);
        Answer answer{urb, 0, {}};
        const bool isHid = interface < device_.reportDescriptors.size();
        if (isHid && setup[0] == 0x81 && setup[1] == 6 && setup[3] == 0x22) {
            answer.bytes = device_.reportDescriptors[interface];
        } else if (isHid && setup[0] == 0xa1 && setup[1] == 1 && device_.tellsState) {
            if (const auto state = states_.find(static_cast<int>(interface)); state != states_.end())
                answer.bytes = state->second;
        } else {
            answer.status = -EPIPE;  // a stall
        }
        answer.bytes.resize(std::min(answer.bytes.size(), wanted));
        return answer;
    }

    void hear() {
        for (Endpoint& endpoint : endpoints_)
            while (!endpoint.reports.empty() && !endpoint.waiting.empty()) {
                ++owed_;
                answers_.push_back({endpoint.waiting.front(), 0, endpoint.reports.front()});
                endpoint.waiting.pop_front();
                endpoint.reports.pop_front();
            }
        showAnswers();
    }

    bool discard(UMockdevIoctlData* argument) {
        unsigned long address = 0;
        std::memcpy(&address, argument->data, sizeof address);
        for (Endpoint& endpoint : endpoints_)
            for (auto urb = endpoint.waiting.begin(); urb != endpoint.waiting.end(); ++urb)
                if (urb->request->client_addr == address) {
                    const bool isLate = endpoint.atCancel.has_value();
                    answers_.push_back({*urb, isLate ? 0 : -ENOENT, std::exchange(endpoint.atCancel, {}).value_or(Bytes{})});
                    endpoint.waiting.erase(urb);
                    showAnswers();
                    return !isLate;
                }
        for (auto urb = offered_.begin(); urb != offered_.end(); ++urb)
            if (urb->request->client_addr == address) {
                answers_.push_back({*urb, -ENOENT, {}});
                offered_.erase(urb);
                showAnswers();
                return true;
            }
        return false;
    }

    bool reap(UMockdevIoctlData* argument) {
        if (answers_.empty()) return false;
        Answer answer = std::move(answers_.front());
        answers_.pop_front();
        usbdevfs_urb urb = answer.urb.of();
        const std::size_t start = urb.type == USBDEVFS_URB_TYPE_CONTROL ? 8 : 0;
        answer.bytes.resize(std::min(answer.bytes.size(), static_cast<std::size_t>(urb.buffer_length) - start));
        if (!answer.bytes.empty() && !isOut(answer.urb))
            umockdev_ioctl_data_update(answer.urb.buffer, start, answer.bytes.data(), static_cast<gint>(answer.bytes.size()));
        urb.status = answer.status;
        urb.actual_length = static_cast<int>(answer.bytes.size());
        umockdev_ioctl_data_update(answer.urb.request, 0, reinterpret_cast<guint8*>(&urb), sizeof urb);
        UMockdevIoctlData* const place = umockdev_ioctl_data_resolve(argument, 0, sizeof(void*), nullptr);
        umockdev_ioctl_data_set_ptr(place, 0, answer.urb.request);
        g_object_unref(place);
        g_object_unref(answer.urb.buffer);
        g_object_unref(answer.urb.request);
        showAnswers();
        return true;
    }

    // Fills or drains the pipe.
    void showAnswers() const {
        std::array<char, kPipe> bytes{};
        [[maybe_unused]] const ssize_t moved =
            answers_.empty() ? ::write(pipe_, bytes.data(), bytes.size()) : ::read(pipe_, bytes.data(), bytes.size());
    }

    UMockdevTestbed* const bed_;
    const MockUsbDevice device_;
    const int address_;
    std::string node_, folder_;
    int pipe_ = -1;
    UMockdevIoctlBase* handler_ = nullptr;

    mutable std::mutex mutex_;  // guards what follows; umockdev answers on a thread of its own
    std::map<int, Bytes>& states_;
    std::vector<Endpoint> endpoints_;
    std::set<unsigned> kernelHas_;
    std::deque<Answer> answers_;
    std::vector<Urb> offered_;  // sent to a device that accepts nothing
    std::vector<MockUsbReport> sent_;
    Taking taking_ = Taking::All;
    int owed_ = 0;  // reports delivered, whose transfer was not submitted again yet
    bool isGone_ = false;
};

struct MockUsb::Bed {
    UMockdevTestbed* const testbed;
    int nextAddress = 2;
    std::map<std::string, std::map<int, Bytes>> states;
    std::map<std::string, Plugged*> plugged, last;  // by path; the last one also after unplugging
    std::vector<std::unique_ptr<Plugged>> all;      // also unplugged ones, which may still be open
};

MockUsb::MockUsb(MockMachine& machine) : bed_(std::make_unique<Bed>(machine.testbed())) {
    GError* error = nullptr;
    FANTASCOPE_CHECK(
        umockdev_testbed_add_from_string(bed_->testbed,
                                         "P: /devices/pci0000:00/0000:00:14.0/usb1\nN: bus/usb/001/001\nE: BUSNUM=001\n"
                                         "E: DEVNAME=/dev/bus/usb/001/001\nE: DEVNUM=001\nE: DEVTYPE=usb_device\n"
                                         "E: MAJOR=189\nE: MINOR=0\nE: SUBSYSTEM=usb\nA: bConfigurationValue=1\\n\n"
                                         "A: busnum=1\\n\nA: devnum=1\\n\nA: speed=480\\n\nH: descriptors="
                                         "12010002090001406B1D0200010603020101"
                                         "0902190001010000E000090400000109000000070581030400FF\n",
                                         &error) != 0,
        error->message);
}

MockUsb::~MockUsb() = default;

MockUsb::Plugged* MockUsb::at(const std::string& path) const {
    const auto found = bed_->plugged.find(path);
    return found == bed_->plugged.end() ? nullptr : found->second;
}

void MockUsb::plug(const MockUsbDevice& device) {
    FANTASCOPE_CHECK(at(device.path) == nullptr, "there is something plugged in");
    // A new address every time, as from the kernel.
    bed_->all.push_back(std::make_unique<Plugged>(bed_->testbed, device, bed_->nextAddress++, bed_->states[device.path]));
    bed_->plugged[device.path] = bed_->last[device.path] = bed_->all.back().get();
}

void MockUsb::unplug(const std::string& path) {
    if (Plugged* const plugged = at(path)) plugged->unplug();
    bed_->plugged.erase(path);
}

void MockUsb::report(const std::string& path, int interface, const Bytes& bytes) {
    if (Plugged* const plugged = at(path)) plugged->report(interface, bytes);
}

void MockUsb::reportAtCancel(const std::string& path, int interface, const Bytes& bytes) {
    at(path)->reportAtCancel(interface, bytes);
}
void MockUsb::setState(const std::string& path, int interface, const Bytes& bytes) { bed_->states[path][interface] = bytes; }

void MockUsb::stall(const std::string& path, int interface) { at(path)->fail(interface, -EPIPE); }
void MockUsb::fail(const std::string& path, int interface) { at(path)->fail(interface, -EPROTO); }
std::vector<MockUsbReport> MockUsb::sent(const std::string& path) const { return bed_->last.at(path)->sent(); }
void MockUsb::take(const std::string& path, Taking taking) { at(path)->take(taking); }
void MockUsb::forbid(const std::string& path) { at(path)->forbid(); }
bool MockUsb::isHeard(const std::string& path) const { return at(path) == nullptr || at(path)->isHeard(); }
bool MockUsb::kernelHas(const std::string& path, int interface) const { return at(path)->kernelHas(interface); }
std::size_t MockUsb::waiting(const std::string& path, int interface) const { return at(path)->waiting(interface); }

}  // namespace fantascope
