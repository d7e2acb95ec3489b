#include "mock_camera.h"

#include "core/check.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <sys/stat.h>
#include <umockdev.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace fantascope {
namespace {

constexpr auto kPatience = std::chrono::milliseconds(2);  // that a take without a frame lasts
constexpr auto kDeadline = std::chrono::seconds(30);
constexpr unsigned kPage = 4096;

std::uint32_t fourcc(const std::string& name) { return v4l2_fourcc(name[0], name[1], name[2], name[3]); }

unsigned rowBytes(const std::string& format, int width) {
    const auto pixels = static_cast<unsigned>(width);
    return format == "YUYV" || format == "UYVY" ? 2 * pixels : format == "RGB3" ? 3 * pixels : pixels;
}

void stopUnless(bool done, GError* error) { FANTASCOPE_CHECK(done, error != nullptr ? error->message : "umockdev serves"); }

}  // namespace

MockCamera::MockCamera(MockMachine& machine, MockCameraKind kind)
    : machine_(machine), kind_(std::move(kind)), handler_(umockdev_ioctl_base_new()), controls_(kind_.controls) {
    g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(&MockCamera::handle), this);
}

MockCamera::~MockCamera() {
    if (plugged_) unplug();
    for (const std::filesystem::path& file : answered_) umockdev_testbed_detach_ioctl(machine_.testbed(), file.c_str(), nullptr);
    g_signal_handlers_disconnect_by_data(handler_, this);
    g_object_unref(handler_);
}

std::filesystem::path MockCamera::file() const { return fmt::format("/dev/video{}", number_); }

void MockCamera::plugIn(int number) {
    number_ = number;
    parent_ = "/sys/devices/pci0000:00/usb1/" + kind_.usb;
    const std::string place = parent_.substr(4);
    std::string told =
        fmt::format("P: {}\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_device\nA: idVendor=046d\nA: idProduct=0825\nA: product={}\n", place,
                    kind_.card);
    if (!kind_.serial.empty()) told += fmt::format("A: serial={}\n", kind_.serial);
    told +=
        fmt::format("\nP: {0}/{1}:1.0\nE: SUBSYSTEM=usb\nE: DEVTYPE=usb_interface\nA: bInterfaceNumber=00\n", place, kind_.usb);
    told += fmt::format("\nP: {0}/{1}:1.0/video4linux/video{2}\nN: video{2}=00\nE: SUBSYSTEM=video4linux\nA: name={3}\n", place,
                        kind_.usb, number, kind_.card);
    // Whoever opens a node finds somebody who answers, before it can be seen and after it is gone:
    // umockdev ends the program otherwise. Nor does the node's file go when the camera is unplugged:
    // umockdev never closes its connection for an open() that fails.
    std::filesystem::remove(machine_.root().string() + file().string());
    GError* error = nullptr;
    stopUnless(umockdev_testbed_attach_ioctl(machine_.testbed(), file().c_str(), handler_, &error), error);
    answered_.push_back(file());
    stopUnless(umockdev_testbed_add_from_string(machine_.testbed(), told.c_str(), &error), error);
    {
        const std::lock_guard lock(mutex_);
        memory_ = open((machine_.root().string() + file().string()).c_str(), O_RDWR | O_CLOEXEC);
        FANTASCOPE_CHECK(memory_ >= 0, "the node has a file");
        plugged_ = true;
        streaming_ = idle_ = settled_ = false;
        empty_.clear();
        filled_.clear();
        sequence_ = 0;
        controls_ = kind_.controls;
    }
}

void MockCamera::unplug() {
    {
        const std::lock_guard lock(mutex_);
        plugged_ = false;
        close(std::exchange(memory_, -1));
        changed_.notify_all();
    }
    const std::string interface = fmt::format("{0}/{1}:1.0", parent_, kind_.usb);
    umockdev_testbed_remove_device(machine_.testbed(), fmt::format("{}/video4linux/video{}", interface, number_).c_str());
    umockdev_testbed_remove_device(machine_.testbed(), interface.c_str());
    umockdev_testbed_remove_device(machine_.testbed(), parent_.c_str());
}

void MockCamera::send(const Frame& frame) {
    const std::lock_guard lock(mutex_);
    sequence_ += frame.skipped;
    const std::uint32_t sequence = sequence_++;
    if (!plugged_ || !streaming_ || empty_.empty()) return;
    const unsigned index = empty_.front();
    empty_.pop_front();
    const unsigned length =
        (rowBytes("RGB3", kind_.size.x) + kind_.padding) * static_cast<unsigned>(kind_.size.y) * 2 / kPage * kPage + kPage;
    FANTASCOPE_CHECK(frame.bytes.size() <= length &&
                         pwrite(memory_, frame.bytes.data(), frame.bytes.size(), static_cast<off_t>(index) * length) ==
                             static_cast<ssize_t>(frame.bytes.size()),
                     "a frame fits into its buffer");
    filled_.push_back({index, static_cast<std::uint32_t>(frame.bytes.size()), sequence,
                       kind_.stampFlags | (frame.damaged ? V4L2_BUF_FLAG_ERROR : 0u), frame.stamp.value_or(kernelTime())});
    idle_ = settled_ = false;
    changed_.notify_all();
}

bool MockCamera::waitUntilTaken() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kDeadline, [&] { return idle_; });
}

void MockCamera::setBusy(bool busy) {
    const std::lock_guard lock(mutex_);
    busy_ = busy;
}

void MockCamera::failTaking(int error) {
    const std::lock_guard lock(mutex_);
    takingFails_ = error;
    changed_.notify_all();
}

std::optional<int> MockCamera::control(std::uint32_t id) {
    const std::lock_guard lock(mutex_);
    const auto found = controls_.find(id);
    return found == controls_.end() ? std::nullopt : std::optional(found->second.now);
}

std::string MockCamera::format() {
    const std::lock_guard lock(mutex_);
    return format_;
}

int MockCamera::streams() {
    const std::lock_guard lock(mutex_);
    return streams_;
}

bool MockCamera::waitForStreams(int count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kDeadline, [&] { return streams_ >= count; });
}

int MockCamera::handle(_UMockdevIoctlBase*, _UMockdevIoctlClient* client, void* self) {
    const auto request = static_cast<std::uint32_t>(umockdev_ioctl_client_get_request(client));
    UMockdevIoctlData* const data =
        umockdev_ioctl_data_resolve(umockdev_ioctl_client_get_arg(client), 0, _IOC_SIZE(request), nullptr);
    const int error = data == nullptr ? EFAULT : static_cast<MockCamera*>(self)->answer(request, data->data);
    umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
    if (data != nullptr) umockdev_ioctl_data_unref(data);
    return TRUE;
}

int MockCamera::answer(std::uint32_t request, void* argument) {
    std::unique_lock lock(mutex_);
    if (!plugged_) return ENODEV;
    const auto length =
        (rowBytes("RGB3", kind_.size.x) + kind_.padding) * static_cast<unsigned>(kind_.size.y) * 2 / kPage * kPage + kPage;
    switch (request) {
        case static_cast<std::uint32_t>(VIDIOC_QUERYCAP): {
            auto& known = *static_cast<v4l2_capability*>(argument);
            known = {};
            std::strncpy(reinterpret_cast<char*>(known.card), kind_.card.c_str(), sizeof known.card - 1);
            known.device_caps = V4L2_CAP_STREAMING | (kind_.captures ? V4L2_CAP_VIDEO_CAPTURE : V4L2_CAP_META_CAPTURE);
            known.capabilities = V4L2_CAP_STREAMING | V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_META_CAPTURE | V4L2_CAP_DEVICE_CAPS;
            return 0;
        }
        case static_cast<std::uint32_t>(VIDIOC_ENUM_FMT): {
            auto& format = *static_cast<v4l2_fmtdesc*>(argument);
            if (format.index >= kind_.formats.size()) return EINVAL;
            format.pixelformat = fourcc(kind_.formats[format.index]);
            return 0;
        }
        case static_cast<std::uint32_t>(VIDIOC_S_FMT): {
            if (busy_) return EBUSY;
            auto& pixels = static_cast<v4l2_format*>(argument)->fmt.pix;
            format_ = kind_.formats.front();
            for (const std::string& format : kind_.formats)
                if (fourcc(format) == pixels.pixelformat) format_ = format;
            if (kind_.answers) format_ = *kind_.answers;
            pixels.pixelformat = fourcc(format_);
            pixels.width = static_cast<std::uint32_t>(kind_.size.x);
            pixels.height = static_cast<std::uint32_t>(kind_.size.y);
            pixels.bytesperline = kind_.saysStride ? rowBytes(format_, kind_.size.x) + kind_.padding : 0;
            pixels.sizeimage = length;
            pixels.colorspace = V4L2_COLORSPACE_SRGB;
            pixels.quantization = kind_.fullRange ? V4L2_QUANTIZATION_FULL_RANGE : V4L2_QUANTIZATION_DEFAULT;
            return 0;
        }
        case static_cast<std::uint32_t>(VIDIOC_S_PARM): {
            auto& capture = static_cast<v4l2_streamparm*>(argument)->parm.capture;
            const auto rate = kind_.rates.find(format_);
            capture.capability = V4L2_CAP_TIMEPERFRAME;
            capture.timeperframe = {1000, static_cast<std::uint32_t>(1000 * (rate == kind_.rates.end() ? 30 : rate->second))};
            return 0;
        }
        case static_cast<std::uint32_t>(VIDIOC_REQBUFS): {
            if (busy_) return EBUSY;
            auto& buffers = *static_cast<v4l2_requestbuffers*>(argument);
            buffers.count = std::min(buffers.count, 4u);
            return ftruncate(memory_, static_cast<off_t>(buffers.count) * length) == 0 ? 0 : ENOMEM;
        }
        case static_cast<std::uint32_t>(VIDIOC_QUERYBUF): {
            auto& buffer = *static_cast<v4l2_buffer*>(argument);
            buffer.length = length;
            buffer.m.offset = buffer.index * length;
            return 0;
        }
        case static_cast<std::uint32_t>(VIDIOC_QBUF):
            empty_.push_back(static_cast<v4l2_buffer*>(argument)->index);
            return 0;
        case static_cast<std::uint32_t>(VIDIOC_STREAMON):
            streaming_ = true;
            ++streams_;
            changed_.notify_all();
            return 0;
        case static_cast<std::uint32_t>(VIDIOC_STREAMOFF):
            streaming_ = false;
            empty_.clear();
            filled_.clear();
            sequence_ = 0;
            return 0;
        case static_cast<std::uint32_t>(VIDIOC_DQBUF): {
            if (filled_.empty() && takingFails_ == 0) {
                if (!std::exchange(settled_, true)) return EAGAIN;
                idle_ = true;
                changed_.notify_all();
                changed_.wait_for(lock, kPatience, [&] { return !filled_.empty() || !plugged_ || takingFails_ != 0; });
                if (!plugged_) return ENODEV;
            }
            if (takingFails_ != 0) return takingFails_;
            if (filled_.empty()) return EAGAIN;
            const Filled taken = filled_.front();
            filled_.pop_front();
            auto& buffer = *static_cast<v4l2_buffer*>(argument);
            buffer.index = taken.index;
            buffer.bytesused = taken.bytes;
            buffer.sequence = taken.sequence;
            buffer.flags = taken.flags;
            const auto micros = std::chrono::floor<std::chrono::microseconds>(taken.stamp).count();
            buffer.timestamp = {micros / 1'000'000, micros % 1'000'000};
            return 0;
        }
        case static_cast<std::uint32_t>(VIDIOC_S_CTRL): {
            auto& moved = *static_cast<v4l2_control*>(argument);
            const auto found = controls_.find(moved.id);
            if (found == controls_.end()) return EINVAL;
            found->second.now = std::clamp(moved.value, found->second.least, found->second.most);
            return 0;
        }
        case static_cast<std::uint32_t>(VIDIOC_G_CTRL): {
            auto& read = *static_cast<v4l2_control*>(argument);
            const auto found = controls_.find(read.id);
            if (found == controls_.end()) return EINVAL;
            read.value = found->second.now;
            return 0;
        }
        default:
            return ENOTTY;
    }
}

}  // namespace fantascope
