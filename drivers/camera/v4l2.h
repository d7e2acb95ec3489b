#pragma once

#include "drivers/camera/camera_search.h"
#include "drivers/camera/frame_pool.h"
#include "drivers/common/opening.h"
#include "drivers/common/service.h"

#include "device/camera_source.h"

#include "core/config/config.h"

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace fantascope::drivers {

// A camera of the kernel's V4L2, such as USB cameras; README.md lists its keys. The driver's own
// thread decodes the frames.
class V4l2Camera final : public CameraSource {
public:
    static Result<Opening<CameraSource>> fromConfig(const ConfigNode& options);

    DeviceStatus status() const override { return service_.status(); }
    std::shared_ptr<const CameraFrame> newest() override;
    CameraDescription description() const override;

    // Frames since the opening. Thread: any.
    struct Tally {
        std::uint64_t good = 0;
        std::uint64_t damaged = 0;  // flagged by the kernel's driver, too short, or an undecodable JPEG; never shown
        std::uint64_t missed = 0;   // counted by the camera, but late or never received
    };
    Tally tally() const;

private:
    struct Options {
        CameraIdentity identity;
        glm::ivec2 size{640, 480};
        double rate = 30;                   // Hz
        std::optional<FrameCoding> coding;  // preferred
        std::optional<bool> fullRange;      // overrides the camera
        std::map<VideoNode::Control, std::optional<std::int64_t>> controls;
    };
    struct Life;

    V4l2Camera(Options options, const DriverContext& context);
    Outage runOnce(Service& service);
    std::optional<Outage> negotiate(Life& life) const;
    std::string applyControls(VideoNode& node) const;
    void describe(const Life& life, const std::string& shortcomings);
    Outage stream(Service& service, Life& life);
    int take(Life& life);
    bool show(Service& service, Life& life);
    void countDamaged();
    void countMissed(std::uint64_t frames);
    void forget();

    const Options options_;
    Clock& clock_;
    FramePool pool_;
    std::string said_;            // the last log line about the camera
    bool silent_ = false;         // its last life had no good frame; it is Running once it has one
    std::uint64_t sequence_ = 0;  // of the last frame
    Time exposed_ = Time::min();

    mutable std::mutex mutex_;
    std::shared_ptr<const CameraFrame> newest_;
    CameraDescription description_;
    Tally tally_;

    Service service_;
};

}  // namespace fantascope::drivers
