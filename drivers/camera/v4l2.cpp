#include "drivers/camera/v4l2.h"

#include "drivers/common/usb_identity.h"

#include "core/log.h"

#include <fmt/format.h>
#include <glm/common.hpp>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

namespace fantascope::drivers {
namespace {

// How long a camera may be silent before it has stalled. Many take more than a second for their
// first frame.
constexpr Time kFirstTimeout = std::chrono::seconds(3), kMinTimeout = std::chrono::seconds(1);
constexpr int kPatientPeriods = 5;
constexpr Time kMaxStampAge = std::chrono::seconds(10);  // an older time stamp is invalid

// The time of a clock when the kernel's clock shows 0. Takes the least disturbed of several
// readings.
Time kernelEpoch(const Clock& clock) {
    Time epoch{}, least = Time::max();
    for (int reading = 0; reading < 16; ++reading) {
        const Time before = clock.now(), kernel = kernelTime(), after = clock.now();
        if (after - before >= least) continue;
        least = after - before;
        epoch = before + least / 2 - kernel;
    }
    return epoch;
}

// The USB serial number of a camera, by its file or a link to it; empty if it has none.
std::string serialOf(const std::filesystem::path& file) {
    std::error_code failed;
    const std::filesystem::path real = std::filesystem::canonical(file, failed);
    const auto plugged = usbFileOf("video4linux", (failed ? file : real).filename().string());
    return plugged ? plugged->usb.serial : "";
}

const char* nameOf(VideoNode::Control control) {
    constexpr const char* kNames[] = {"exposure", "gain", "white balance", "focus"};
    return kNames[static_cast<int>(control)];
}

// Rates are equal if nobody sees the difference: 29.97 Hz is 30 Hz. 0 means that the driver does
// not say.
bool isRate(double granted, double asked) { return granted == 0 || granted > .95 * asked; }

// "auto", or a value in V4L2's unit for the control.
Result<std::optional<std::int64_t>> controlFrom(const ConfigNode& node) {
    if (const auto word = node.text(); word && *word == "auto") return std::optional<std::int64_t>();
    return std::optional(TRY(node.integer(std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max())));
}

}  // namespace

Result<Opening<CameraSource>> V4l2Camera::fromConfig(const ConfigNode& node) {
    std::string driver;
    Options options;
    ConfigFields fields(node);
    fields.text("driver", driver);
    fields.optional().read("device", options.identity.device, [](const ConfigNode& value) -> Result<std::string> {
        auto path = value.text();
        if (path && !path->starts_with('/'))
            return value.error(fmt::format("'{}' is not an absolute path, such as /dev/video0", *path));
        return path;
    });
    fields.optional().text("serial", options.identity.serial);
    fields.optional().text("usb", options.identity.usb);
    fields.optional().text("card", options.identity.card);
    fields.optional().read("size", options.size, [](const ConfigNode& value) -> Result<glm::ivec2> {
        const auto sides = TRY(value.items(2, 2));
        const auto width = TRY(sides[0].integer(2, 16384)), height = TRY(sides[1].integer(2, 16384));
        return glm::ivec2(width, height);
    });
    fields.optional().number("rate", options.rate, 0.1, 1000, "Hz");
    fields.optional().read("format", options.coding, [](const ConfigNode& value) -> Result<std::optional<FrameCoding>> {
        return std::optional(static_cast<FrameCoding>(TRY(value.choice({"YUYV", "NV12", "UYVY", "RGB24", "MJPG", "GREY"}))));
    });
    fields.optional().read("range", options.fullRange, [](const ConfigNode& value) -> Result<std::optional<bool>> {
        return std::optional(TRY(value.choice({"limited", "full"})) == 1);
    });
    for (const auto& [key, control] :
         {std::pair("exposure", VideoNode::Control::Exposure), std::pair("gain", VideoNode::Control::Gain),
          std::pair("white_balance", VideoNode::Control::WhiteBalance), std::pair("focus", VideoNode::Control::Focus)})
        fields.optional().read(key, options.controls, [&](const ConfigNode& value) -> Result<decltype(options.controls)> {
            auto controls = options.controls;
            controls[control] = TRY(controlFrom(value));
            return controls;
        });
    const CameraIdentity& identity = options.identity;
    if (!identity.device.empty() && !(identity.serial + identity.usb + identity.card).empty())
        fields.check(node, node.error("give either 'device' alone, or 'serial', 'usb' and 'card'"));
    TRY(fields.finish());
    const auto open = [options](const DriverContext& context) -> Result<std::unique_ptr<CameraSource>> {
        return std::unique_ptr<CameraSource>(new V4l2Camera(options, context));
    };
    return Opening<CameraSource>{.open = open, .claim = [identity] { return claimOf(identity); }};
}

V4l2Camera::V4l2Camera(Options options, const DriverContext& context)
    : options_(std::move(options)),
      clock_(context.clock),
      service_("camera", "v4l2", LossAction::Dark, [this](Service& service) { return runOnce(service); }) {}

std::shared_ptr<const CameraFrame> V4l2Camera::newest() {
    if (!service_.isRunning()) return nullptr;
    const std::lock_guard lock(mutex_);
    return std::exchange(newest_, nullptr);
}

CameraDescription V4l2Camera::description() const {
    const std::lock_guard lock(mutex_);
    return description_;
}

V4l2Camera::Tally V4l2Camera::tally() const {
    const std::lock_guard lock(mutex_);
    return tally_;
}

// From here on: the driver's thread.

// One life of an open camera.
struct V4l2Camera::Life {
    explicit Life(OpenCamera camera) : file(std::move(camera.file)), node(std::move(camera.node)) {}

    std::filesystem::path file;
    VideoNode node;
    VideoNode::Grant grant;
    std::optional<FrameDecoder> decoder;
    std::optional<Time> exposure;  // duration, if known
    Time epoch{};                  // our time at the kernel clock's 0

    // The newest complete frame; its buffer is back with the camera.
    VideoNode::Buffer buffer;
    std::vector<std::uint8_t> coded;
    std::uint64_t sequence = 0;

    std::optional<std::uint32_t> counted;  // the camera's count of the last frame that was taken
};

Outage V4l2Camera::runOnce(Service& service) {
    auto found = openCameraThatIs(options_.identity);
    if (auto* const outage = std::get_if<Outage>(&found)) return std::move(*outage);
    auto& camera = std::get<OpenCamera>(found);
    Life life(std::move(camera));
    if (auto outage = negotiate(life)) return std::move(*outage);
    const std::string shortcomings = applyControls(life.node);
    life.exposure = life.node.lockedExposure();
    life.epoch = kernelEpoch(clock_);
    if (const int error = life.node.start(); error != 0) return whyNotUsed(life.file, "starting its stream", error);
    describe(life, shortcomings);
    if (!silent_) service.setRunning();
    Outage outage = stream(service, life);
    forget();
    return outage;
}

// Drivers answer with something else rather than refuse, so each format is tried and the nearest
// answer is taken.
std::optional<Outage> V4l2Camera::negotiate(Life& life) const {
    const VideoNode::Offer offer = life.node.offer();
    if (offer.codings.empty())
        return Outage{DeviceState::Faulted, fmt::format("{}: it offers {}, which cannot be decoded here", life.file.string(),
                                                        offer.others.empty() ? "nothing" : listedFormats(offer.others))};
    std::optional<FrameCoding> best;
    std::tuple<bool, int, double> bestScore;
    const auto ask = [&](FrameCoding coding) { return life.node.setFormat(coding, options_.size, options_.rate, life.grant); };
    for (const FrameCoding coding : offer.codings) {
        const int error = ask(coding);
        if (error == EINVAL || error == ENOTSUP) continue;
        if (error != 0) return whyNotUsed(life.file, "setting its format", error);
        const glm::ivec2 missing = glm::abs(life.grant.format.size - options_.size);
        const double rate = isRate(life.grant.rate, options_.rate) ? options_.rate : life.grant.rate;
        const std::tuple score(coding == options_.coding, -missing.x - missing.y, rate);
        if (best && score <= bestScore) continue;
        best = coding;
        bestScore = score;
    }
    if (!best)
        return Outage{DeviceState::Faulted, fmt::format("{}: it grants none of the formats that it offers", life.file.string())};
    if (const int error = ask(*best); error != 0) return whyNotUsed(life.file, "setting its format", error);
    if (options_.fullRange) life.grant.format.fullRange = *options_.fullRange;
    life.decoder.emplace(life.grant.format);
    return std::nullopt;
}

// Sets the controls that the site file locks. Returns what the camera cannot do: "; no focus", "".
std::string V4l2Camera::applyControls(VideoNode& node) const {
    std::string shortcomings;
    for (const auto& [control, wanted] : options_.controls) {
        auto value = wanted;
        switch (node.set(control, value)) {
            case VideoNode::Outcome::Done:
                break;
            case VideoNode::Outcome::Changed:
                shortcomings += fmt::format("; {} {} instead of {}", nameOf(control), *value, *wanted);
                break;
            case VideoNode::Outcome::Missing:
                shortcomings += fmt::format("; {} cannot be {}", nameOf(control), wanted ? "set" : "automatic");
                break;
        }
    }
    return shortcomings;
}

// Notes and logs the camera and the granted format, the latter once until they change.
void V4l2Camera::describe(const Life& life, const std::string& shortcomings) {
    const FrameFormat& format = life.grant.format;
    CameraDescription description{
        .card = life.node.card(), .serial = serialOf(life.file), .format = {}, .lacks = {}, .exposure = {}};
    description.format = fmt::format("{} {} x {}", nameOf(format.coding), format.size.x, format.size.y);
    description.format += life.grant.rate > 0 ? fmt::format(" at {:.4g} Hz", life.grant.rate) : " at an unknown rate";
    description.exposure = life.exposure.value_or(Time::zero());
    if (!shortcomings.empty()) description.lacks = shortcomings.substr(std::string_view("; ").size());
    std::string words = fmt::format("{} '{}': {}", life.file.string(), life.node.card(), description.format);
    {
        const std::lock_guard lock(mutex_);
        description_ = std::move(description);
    }
    const bool asAsked = format.size == options_.size && isRate(life.grant.rate, options_.rate) &&
                         format.coding == options_.coding.value_or(format.coding);
    if (!asAsked)
        words +=
            fmt::format("; asked for {}{} x {} at {:.4g} Hz", options_.coding ? std::string(nameOf(*options_.coding)) + " " : "",
                        options_.size.x, options_.size.y, options_.rate);
    words += shortcomings;
    if (words == said_) return;
    log::write(asAsked && shortcomings.empty() ? log::Level::Info : log::Level::Warning, "camera", words);
    said_ = std::move(words);
}

Outage V4l2Camera::stream(Service& service, Life& life) {
    const Time period = life.grant.rate > 0 ? fromSeconds(1 / life.grant.rate) : Time::zero();
    const Time several = kPatientPeriods * std::max(period, life.exposure.value_or(Time::zero()));
    const Time atFirst = kFirstTimeout + several;
    const Time later = life.grant.rate > 0 ? std::max(kMinTimeout, several) : atFirst;
    Time timeout = atFirst, heard = clock_.now();
    bool restarted = silent_;  // being reopened is as good as a restart
    bool damaged = false;      // damaged frames came since `heard`
    while (!service.ending()) {
        service.wait(heard + timeout - clock_.now(), {life.node.file()});
        const int error = take(life);
        if (error == 0 && show(service, life)) {
            heard = clock_.now();
            timeout = later;
            if (restarted) service.setTrouble("");
            restarted = damaged = false;
            continue;
        }
        damaged = damaged || error == 0 || error == EBADMSG;
        const bool nothing = error == 0 || error == EBADMSG || error == EAGAIN;
        if (nothing && clock_.now() - heard < timeout) continue;
        if (!nothing && error != EIO) return whyNotUsed(life.file, "reading its frames", error);
        // It has stalled or lost its signal.
        if (service.ending()) break;
        if (restarted) {
            silent_ = true;
            return {DeviceState::Faulted,
                    fmt::format("{} '{}' {}; replug it, at another port or with a shorter cable", life.file.string(),
                                life.node.card(), damaged ? "gives only damaged frames" : "gives no frames")};
        }
        service.setTrouble("it gave no frames for a while; restarting its stream");
        if (const int failed = life.node.restart(); failed != 0) return whyNotUsed(life.file, "restarting its stream", failed);
        life.counted.reset();
        restarted = true;
        timeout = atFirst;
        heard = clock_.now();
    }
    return {};
}

// Takes all available frames and keeps the bytes of the newest. EAGAIN: there is none; EBADMSG:
// none is complete.
// EBADMSG: none that is whole.
int V4l2Camera::take(Life& life) {
    int outcome = EAGAIN;
    for (;;) {
        VideoNode::Buffer buffer;
        const int error = life.node.take(buffer);
        if (error == EAGAIN) return outcome;
        if (error != 0) return error;
        // The camera counts in 32 bits and restarts with every stream; some never count.
        const auto step = life.counted ? static_cast<std::int32_t>(buffer.sequence - *life.counted) : 1;
        life.counted = buffer.sequence;
        sequence_ += static_cast<std::uint64_t>(std::max(step, 1));
        countMissed(static_cast<std::uint64_t>(std::max(step - 1, 0)));
        if (buffer.damaged) {
            countDamaged();
            if (outcome == EAGAIN) outcome = EBADMSG;
        } else {
            if (outcome == 0) countMissed(1);  // overtaken by this one
            life.buffer = buffer;
            life.coded.resize(buffer.bytes.size() + FrameDecoder::kPadding);
            std::ranges::copy(buffer.bytes, life.coded.begin());
            life.sequence = sequence_;
            outcome = 0;
        }
        if (const int failed = life.node.requeue(buffer.index); failed != 0) return failed;
    }
}

// Decodes the taken frame and publishes it. Returns whether it was good.
bool V4l2Camera::show(Service& service, Life& life) {
    const VideoNode::Buffer& buffer = life.buffer;
    auto frame = pool_.take(life.grant.format.size);
    if (!life.decoder->decode({life.coded.data(), buffer.bytes.size()}, frame->image)) {
        countDamaged();
        return false;
    }
    const Time now = clock_.now(), stamp = buffer.stamp ? *buffer.stamp + life.epoch : now;
    const Time at = stamp <= now && now - stamp < kMaxStampAge ? stamp : now;
    const Time half = life.exposure.value_or(Time::zero()) / 2;
    exposed_ = std::max(exposed_ + Time(1), std::min(now, buffer.stampedAtStart ? at + half : at - half));
    frame->exposed = exposed_;
    frame->sequence = life.sequence;
    if (std::exchange(silent_, false)) service.setRunning();
    const std::lock_guard lock(mutex_);
    newest_ = std::move(frame);
    ++tally_.good;
    return true;
}

void V4l2Camera::countDamaged() {
    std::uint64_t count = 0;
    {
        const std::lock_guard lock(mutex_);
        count = ++tally_.damaged;
    }
    std::uint64_t leading = count;
    while (leading % 10 == 0) leading /= 10;
    if (leading == 1) log::warning("camera", fmt::format("damaged frames so far: {}; they are not shown", count));
}

void V4l2Camera::countMissed(std::uint64_t frames) {
    const std::lock_guard lock(mutex_);
    tally_.missed += frames;
}

void V4l2Camera::forget() {
    const std::lock_guard lock(mutex_);
    newest_ = nullptr;
}

}  // namespace fantascope::drivers
