// The camera's contract on the real driver, with umockdev cameras.

#include "drivers/camera/v4l2.h"

#include "contract/camera_source_suite.h"
#include "core/config/config.h"
#include "mock_camera.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include <vector>

namespace fantascope::contract {
namespace {

using testing::IsEmpty;

// One grey, in a format's own coding, limited range.
std::vector<std::uint8_t> greyFrame(const std::string& format, glm::ivec2 size, int grey) {
    std::vector<std::uint8_t> bytes;
    if (format == "MJPG") {
        cv::imencode(".jpg", cv::Mat(size.y, size.x, CV_8UC1, cv::Scalar(grey)), bytes);
        return bytes;
    }
    const auto luma = static_cast<std::uint8_t>(16 + (grey * 219 + 127) / 255);
    for (int pixel = 0; pixel < size.x * size.y; ++pixel) bytes.insert(bytes.end(), {luma, 128});
    return bytes;
}

class V4l2CameraRig final : public CameraSourceRig {
public:
    explicit V4l2CameraRig(const std::string& format) : format_(format) {
        camera_.plugIn(number_);
        other_.plugIn(1);
        reopen();
        letTimePass();
    }

    CameraSource& port() override { return *port_; }
    void reopen() override {
        port_.reset();
        port_ = open("OURS");
    }
    void unplug() override {
        plugged_ = false;
        camera_.unplug();
    }
    // It comes back under another name.
    void plugIn() override {
        plugged_ = true;
        camera_.plugIn(number_ += 2);
    }
    void letTimePass() override {
        const Time deadline = clock_.now() + std::chrono::seconds(30);
        const auto asPlugged = [&] {
            const DeviceState state = port_->status().state;
            return plugged_ ? state == DeviceState::Running : state == DeviceState::Absent || state == DeviceState::Faulted;
        };
        while (!asPlugged() && clock_.now() < deadline) clock_.sleepUntil(clock_.now() + std::chrono::milliseconds(1));
        EXPECT_TRUE(asPlugged()) << port_->status().detail;
        if (plugged_) {
            EXPECT_TRUE(camera_.waitUntilTaken());
        }
        while (neighbour_->status().state != DeviceState::Running && clock_.now() < deadline)
            clock_.sleepUntil(clock_.now() + std::chrono::milliseconds(1));
    }
    Clock& clock() override { return clock_; }
    Device& neighbour() override { return *neighbour_; }
    void expose(int grey) override { camera_.send({.bytes = greyFrame(format_, camera_.kind().size, grey)}); }

private:
    std::unique_ptr<CameraSource> open(const std::string& serial) {
        const std::string text = fmt::format("driver: v4l2\nserial: {}\nsize: [64, 48]\nrate: .1\n", serial);
        return drivers::V4l2Camera::fromConfig(ConfigNode::parse(text, "site.yaml").value()).value().open(context_).value();
    }
    MockCameraKind kindOf(const std::string& serial, const std::string& usb) const {
        // It reports ten seconds per frame, so that the driver tolerates its silence between two
        // exposures, however slow the machine.
        return {.serial = serial, .usb = usb, .formats = {format_}, .rates = {{format_, .1}}};
    }

    std::string format_;
    SteadyClock clock_;
    drivers::DriverContext context_{clock_};
    MockMachine machine_;
    MockCamera camera_{machine_, kindOf("OURS", "1-1")}, other_{machine_, kindOf("OTHER", "1-2")};
    int number_ = 0;
    bool plugged_ = true;
    std::unique_ptr<CameraSource> neighbour_ = open("OTHER"), port_;
};

class V4l2CameraContract : public testing::TestWithParam<std::string> {};

TEST_P(V4l2CameraContract, is_kept) {
    EXPECT_THAT(violations(cameraSourceSuite(), [] { return std::make_unique<V4l2CameraRig>(GetParam()); }), IsEmpty());
}
INSTANTIATE_TEST_SUITE_P(Of, V4l2CameraContract, testing::Values("YUYV", "MJPG"),
                         [](const auto& format) { return format.param; });

}  // namespace
}  // namespace fantascope::contract
