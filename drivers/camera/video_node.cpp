#include "drivers/camera/video_node.h"

#include <fcntl.h>
#include <linux/dma-buf.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <iterator>

namespace fantascope::drivers {
namespace {

constexpr unsigned kBuffers = 4;  // one being read, one being filled, two for a late thread

struct Coding {
    std::uint32_t fourcc;
    FrameCoding coding;
};
// In order of preference: formats without decoding first, colour before grey.
constexpr Coding kCodings[] = {
    {V4L2_PIX_FMT_YUYV, FrameCoding::Yuyv},   {V4L2_PIX_FMT_NV12, FrameCoding::Nv12},  {V4L2_PIX_FMT_UYVY, FrameCoding::Uyvy},
    {V4L2_PIX_FMT_RGB24, FrameCoding::Rgb24}, {V4L2_PIX_FMT_MJPEG, FrameCoding::Mjpg}, {V4L2_PIX_FMT_GREY, FrameCoding::Grey},
};

std::string nameOf(std::uint32_t fourcc) {
    std::string name;
    for (int shift = 0; shift < 32; shift += 8) name += static_cast<char>(fourcc >> shift & 0x7f);
    while (!name.empty() && name.back() == ' ') name.pop_back();
    return name;
}

// The format's fields that both variants of the API have.
struct Granted {
    std::uint32_t width, height, fourcc, stride, colourSpace, encoding, quantization;
};

Granted grantedIn(const v4l2_format& format, bool planar) {
    if (planar) {
        const auto& pixels = format.fmt.pix_mp;
        return {pixels.width,      pixels.height,    pixels.pixelformat, pixels.plane_fmt[0].bytesperline,
                pixels.colorspace, pixels.ycbcr_enc, pixels.quantization};
    }
    const auto& pixels = format.fmt.pix;
    return {pixels.width,      pixels.height,    pixels.pixelformat, pixels.bytesperline,
            pixels.colorspace, pixels.ycbcr_enc, pixels.quantization};
}

bool isFullRange(FrameCoding coding, const Granted& granted) {
    if (coding == FrameCoding::Mjpg) return true;  // as in JFIF, whatever the driver reports
    if (granted.quantization != V4L2_QUANTIZATION_DEFAULT) return granted.quantization == V4L2_QUANTIZATION_FULL_RANGE;
    // V4L2 does not define a grey sensor's range; its bytes are raw values.
    return coding == FrameCoding::Rgb24 || coding == FrameCoding::Grey || granted.colourSpace == V4L2_COLORSPACE_JPEG;
}

LumaWeights weightsOf(const Granted& granted) {
    const std::uint32_t encoding = granted.encoding != V4L2_YCBCR_ENC_DEFAULT
                                       ? granted.encoding
                                       : static_cast<std::uint32_t>(V4L2_MAP_YCBCR_ENC_DEFAULT(granted.colourSpace));
    switch (encoding) {
        case V4L2_YCBCR_ENC_709:
        case V4L2_YCBCR_ENC_XV709:
        case V4L2_YCBCR_ENC_SMPTE240M:  // equal to within 1 %
            return LumaWeights::Rec709;
        case V4L2_YCBCR_ENC_BT2020:
        case V4L2_YCBCR_ENC_BT2020_CONST_LUM:
            return LumaWeights::Rec2020;
        default:
            return LumaWeights::Rec601;
    }
}

// A control's value, and the automatic mode that may change it.
struct ControlIds {
    std::uint32_t automatic;
    std::array<std::int32_t, 2> on, off;  // tried in this order
    std::uint32_t value;
};

ControlIds idsOf(VideoNode::Control control) {
    switch (control) {
        case VideoNode::Control::Exposure:
            return {V4L2_CID_EXPOSURE_AUTO,
                    {V4L2_EXPOSURE_APERTURE_PRIORITY, V4L2_EXPOSURE_AUTO},
                    {V4L2_EXPOSURE_MANUAL, V4L2_EXPOSURE_SHUTTER_PRIORITY},
                    V4L2_CID_EXPOSURE_ABSOLUTE};
        case VideoNode::Control::Gain:
            return {V4L2_CID_AUTOGAIN, {1, 1}, {0, 0}, V4L2_CID_GAIN};
        case VideoNode::Control::WhiteBalance:
            return {V4L2_CID_AUTO_WHITE_BALANCE, {1, 1}, {0, 0}, V4L2_CID_WHITE_BALANCE_TEMPERATURE};
        case VideoNode::Control::Focus:
            break;
    }
    return {V4L2_CID_FOCUS_AUTO, {1, 1}, {0, 0}, V4L2_CID_FOCUS_ABSOLUTE};
}

// A buffer's description, with room for its plane in the multi-planar API.
struct Description {
    v4l2_buffer buffer{};
    v4l2_plane planes[VIDEO_MAX_PLANES]{};

    Description(unsigned type, bool planar) {
        buffer.type = type;
        buffer.memory = V4L2_MEMORY_MMAP;
        if (!planar) return;
        buffer.m.planes = planes;
        buffer.length = VIDEO_MAX_PLANES;
    }
    Description(const Description&) = delete;
    Description& operator=(const Description&) = delete;
};

int callOf(int file, unsigned long request, void* argument) {
    int answer = 0;
    do answer = ioctl(file, request, argument);
    while (answer < 0 && errno == EINTR);
    return answer < 0 ? errno : 0;
}

// Tells the kernel that reading a DMABUF begins or ends.
bool synchronise(int dmabuf, std::uint64_t edge) {
    dma_buf_sync sync{edge | DMA_BUF_SYNC_READ};
    int error = 0;
    do error = callOf(dmabuf, DMA_BUF_IOCTL_SYNC, &sync);
    while (error == EAGAIN);
    return error == 0;
}

std::span<std::uint8_t> mapped(int file, int protection, std::size_t length, std::int64_t offset) {
    void* const seen = mmap(nullptr, length, protection, MAP_SHARED, file, offset);
    if (seen == MAP_FAILED) return {};
    return {static_cast<std::uint8_t*>(seen), length};
}

}  // namespace

VideoNode::Memory::Memory(FileHandle dmabuf, int node, std::size_t length, std::int64_t offset) {
    if (dmabuf.isOpen() && synchronise(dmabuf.get(), DMA_BUF_SYNC_START) && synchronise(dmabuf.get(), DMA_BUF_SYNC_END))
        bytes_ = mapped(dmabuf.get(), PROT_READ, length, 0);
    if (!bytes_.empty())
        dmabuf_ = std::move(dmabuf);
    else
        bytes_ = mapped(node, PROT_READ | PROT_WRITE, length, offset);  // some drivers map only for both
}

VideoNode::Memory::~Memory() {
    if (!bytes_.empty()) munmap(bytes_.data(), bytes_.size());
}

void VideoNode::Memory::beginReading() const {
    if (isDmabuf()) synchronise(dmabuf_.get(), DMA_BUF_SYNC_START);
}

void VideoNode::Memory::endReading() const {
    if (isDmabuf()) synchronise(dmabuf_.get(), DMA_BUF_SYNC_END);
}

int VideoNode::call(unsigned long request, void* argument) const { return callOf(file_.get(), request, argument); }

unsigned VideoNode::type() const { return planar_ ? V4L2_BUF_TYPE_VIDEO_CAPTURE_MPLANE : V4L2_BUF_TYPE_VIDEO_CAPTURE; }

std::optional<VideoNode> VideoNode::open(const std::filesystem::path& path, int& error) {
    VideoNode node(FileHandle(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC)), "", false);
    error = node.file_.isOpen() ? 0 : errno;
    if (error != 0) return std::nullopt;
    v4l2_capability known{};
    error = node.call(VIDIOC_QUERYCAP, &known);
    if (error == ENOTTY || error == EINVAL) error = ENOTSUP;
    if (error != 0) return std::nullopt;
    const std::uint32_t here = (known.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? known.device_caps : known.capabilities;
    node.planar_ = (here & V4L2_CAP_VIDEO_CAPTURE) == 0;
    node.card_ = reinterpret_cast<const char*>(known.card);
    const bool captures = (here & (V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_VIDEO_CAPTURE_MPLANE)) != 0;
    if (captures && (here & V4L2_CAP_STREAMING) != 0) return node;
    error = ENOTSUP;
    return std::nullopt;
}

bool VideoNode::isInUse() const {
    v4l2_requestbuffers none{};  // freeing no buffers is harmless, and fails only if another program has some
    none.type = type();
    none.memory = V4L2_MEMORY_MMAP;
    return call(VIDIOC_REQBUFS, &none) == EBUSY;
}

VideoNode::Offer VideoNode::offer() const {
    std::vector<std::uint32_t> offered;
    v4l2_fmtdesc format{};
    for (format.type = type(); call(VIDIOC_ENUM_FMT, &format) == 0; ++format.index) offered.push_back(format.pixelformat);
    Offer offer;
    for (const Coding& coding : kCodings)
        if (std::ranges::count(offered, coding.fourcc) != 0) offer.codings.push_back(coding.coding);
    for (const std::uint32_t fourcc : offered)
        if (std::ranges::find(kCodings, fourcc, &Coding::fourcc) == std::end(kCodings)) offer.others.push_back(nameOf(fourcc));
    return offer;
}

int VideoNode::setFormat(FrameCoding coding, glm::ivec2 size, double rate, Grant& grant) {
    const std::uint32_t fourcc = std::ranges::find(kCodings, coding, &Coding::coding)->fourcc;
    v4l2_format format{};
    format.type = type();
    const auto describe = [&](auto& pixels) {
        pixels.width = static_cast<std::uint32_t>(size.x);
        pixels.height = static_cast<std::uint32_t>(size.y);
        pixels.pixelformat = fourcc;
        pixels.field = V4L2_FIELD_NONE;
    };
    planar_ ? describe(format.fmt.pix_mp) : describe(format.fmt.pix);
    if (const int error = call(VIDIOC_S_FMT, &format); error != 0) return error;
    const Granted granted = grantedIn(format, planar_);
    const bool pairs = coding == FrameCoding::Yuyv || coding == FrameCoding::Uyvy || coding == FrameCoding::Nv12;
    constexpr std::uint32_t kMaxSide = 16384;  // pixels
    if (granted.fourcc != fourcc || granted.width < 2 || granted.height < 2 || granted.width > kMaxSide ||
        granted.height > kMaxSide || (pairs && granted.width % 2 != 0) ||
        (coding == FrameCoding::Nv12 && granted.height % 2 != 0))
        return ENOTSUP;
    const int width = static_cast<int>(granted.width);
    // Some drivers report 0 for rows without padding, and some report nonsense for coded rows.
    const int stride = coding == FrameCoding::Mjpg ? 0 : std::max(static_cast<int>(granted.stride), minStride(coding, width));
    grant.format = {coding, {width, granted.height}, stride, isFullRange(coding, granted), weightsOf(granted)};

    constexpr std::uint32_t kThousandths = 1000;
    v4l2_streamparm parameters{};
    parameters.type = type();
    parameters.parm.capture.timeperframe = {kThousandths, static_cast<std::uint32_t>(std::lround(rate * kThousandths))};
    grant.rate = 0;
    const v4l2_fract& period = parameters.parm.capture.timeperframe;
    if (call(VIDIOC_S_PARM, &parameters) == 0 && (parameters.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) != 0 &&
        period.numerator != 0)
        grant.rate = static_cast<double>(period.denominator) / period.numerator;
    return 0;
}

VideoNode::Outcome VideoNode::set(Control control, std::optional<std::int64_t>& value) {
    const ControlIds ids = idsOf(control);
    const auto move = [&](std::uint32_t id, std::int64_t to) {
        v4l2_control moved{id, static_cast<std::int32_t>(to)};
        return call(VIDIOC_S_CTRL, &moved) == 0;
    };
    const auto moveToOneOf = [&](const std::array<std::int32_t, 2>& settings) {
        return std::ranges::any_of(settings, [&](std::int32_t setting) { return move(ids.automatic, setting); });
    };
    if (!value) return moveToOneOf(ids.on) ? Outcome::Done : Outcome::Missing;
    moveToOneOf(ids.off);  // cameras without an automatic mode have the value all the same
    if (!move(ids.value, *value)) return Outcome::Missing;
    v4l2_control now{ids.value, 0};
    if (call(VIDIOC_G_CTRL, &now) != 0 || now.value == *value) return Outcome::Done;
    value = now.value;
    return Outcome::Changed;
}

std::optional<Time> VideoNode::lockedExposure() const {
    constexpr Time kUnit = std::chrono::microseconds(100);  // of V4L2_CID_EXPOSURE_ABSOLUTE
    v4l2_control automatic{V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL}, exposure{V4L2_CID_EXPOSURE_ABSOLUTE, 0};
    if (call(VIDIOC_G_CTRL, &automatic) == 0 && automatic.value != V4L2_EXPOSURE_MANUAL &&
        automatic.value != V4L2_EXPOSURE_SHUTTER_PRIORITY)
        return std::nullopt;
    if (call(VIDIOC_G_CTRL, &exposure) != 0 || exposure.value <= 0) return std::nullopt;
    return exposure.value * kUnit;
}

int VideoNode::start() {
    v4l2_requestbuffers request{};
    request.count = kBuffers;
    request.type = type();
    request.memory = V4L2_MEMORY_MMAP;
    if (const int error = call(VIDIOC_REQBUFS, &request); error != 0) return error;
    for (unsigned index = 0; index < request.count; ++index) {
        Description buffer(type(), planar_);
        buffer.buffer.index = index;
        if (const int error = call(VIDIOC_QUERYBUF, &buffer.buffer); error != 0) return error;
        const auto [length, offset] = planar_ ? std::pair(buffer.planes[0].length, buffer.planes[0].m.mem_offset)
                                              : std::pair(buffer.buffer.length, buffer.buffer.m.offset);
        memories_.emplace_back(dmabufOf(index), file_.get(), length, offset);
        if (memories_.back().bytes().empty()) return errno;
    }
    return memories_.empty() ? ENOMEM : restart();
}

int VideoNode::restart() {
    unsigned type = this->type();
    // This returns every buffer to us.
    if (const int error = call(VIDIOC_STREAMOFF, &type); error != 0) return error;
    for (unsigned index = 0; index < memories_.size(); ++index)
        if (const int error = queue(index); error != 0) return error;
    return call(VIDIOC_STREAMON, &type);
}

int VideoNode::take(Buffer& taken) {
    Description description(type(), planar_);
    if (const int error = call(VIDIOC_DQBUF, &description.buffer); error != 0) return error;
    const v4l2_buffer& buffer = description.buffer;
    if (buffer.index >= memories_.size()) return EIO;
    memories_[buffer.index].beginReading();
    const auto all = memories_[buffer.index].bytes();
    const std::size_t end = std::min<std::size_t>(planar_ ? description.planes[0].bytesused : buffer.bytesused, all.size());
    const std::size_t begin = planar_ ? std::min<std::size_t>(description.planes[0].data_offset, end) : 0;
    taken = {.index = buffer.index,
             .bytes = all.subspan(begin, end - begin),
             .damaged = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0,
             .sequence = buffer.sequence,
             .stamp = std::nullopt,
             .stampedAtStart = (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE};
    if ((buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC)
        taken.stamp = std::chrono::seconds(buffer.timestamp.tv_sec) + std::chrono::microseconds(buffer.timestamp.tv_usec);
    return 0;
}

int VideoNode::requeue(unsigned index) {
    memories_[index].endReading();
    return queue(index);
}

// Closed if the driver offers none.
FileHandle VideoNode::dmabufOf(unsigned index) const {
    v4l2_exportbuffer exported{};
    exported.type = type();
    exported.index = index;
    exported.flags = O_RDONLY | O_CLOEXEC;
    return call(VIDIOC_EXPBUF, &exported) == 0 ? FileHandle(exported.fd) : FileHandle();
}

int VideoNode::queue(unsigned index) {
    Description description(type(), planar_);
    description.buffer.index = index;
    if (planar_) description.buffer.length = 1;
    return call(VIDIOC_QBUF, &description.buffer);
}

}  // namespace fantascope::drivers
