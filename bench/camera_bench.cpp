// Measures the time from a camera frame's arrival in the kernel's driver until the program has it,
// with a camera simulated by umockdev.

#include "drivers/camera/v4l2.h"

#include "core/check.h"
#include "core/config/config.h"
#include "mock_camera.h"

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace fantascope;

namespace {

constexpr int kFrames = 600;
constexpr double kRate = 60;
const glm::ivec2 kSize{640, 480};

// About as hard to encode as a camera's picture at night: soft shapes with noise.
std::vector<std::uint8_t> frameOf(const std::string& format, int number) {
    cv::Mat picture(kSize.y, kSize.x, CV_8UC3);
    std::uint32_t noise = static_cast<std::uint32_t>(number) + 1;
    for (int y = 0; y < kSize.y; ++y)
        for (int x = 0; x < kSize.x; ++x)
            for (int channel = 0; channel < 3; ++channel) {
                noise = noise * 1664525u + 1013904223u;
                const double soft = 90 + 60 * std::sin(x / 31. + channel) * std::cos(y / 23. + number / 10.);
                picture.at<cv::Vec3b>(y, x)[channel] = static_cast<std::uint8_t>(soft + (noise >> 28));
            }
    std::vector<std::uint8_t> bytes;
    if (format == "MJPG")
        cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 85});
    else
        bytes.assign(picture.data, picture.data + 2 * kSize.x * kSize.y);  // the colours do not matter
    return bytes;
}

void measure(const std::string& format) {
    SteadyClock clock;
    const drivers::DriverContext context{clock};
    MockMachine machine;
    MockCamera mock(machine, {.formats = {format}, .rates = {{format, kRate}}, .size = kSize});
    mock.plugIn(0);
    const auto options = ConfigNode::parse(fmt::format("driver: v4l2\nrate: {}\n", kRate), "bench.yaml").value();
    const auto camera = drivers::V4l2Camera::fromConfig(options).value().open(context).value();
    if (!mock.waitUntilTaken()) return;

    std::vector<std::vector<std::uint8_t>> frames;
    for (int number = 0; number < 16; ++number) frames.push_back(frameOf(format, number));
    std::vector<double> delays;
    std::uint64_t first = 0;
    for (int number = 0; number < kFrames; ++number) {
        clock.sleepUntil(clock.now() + fromSeconds(1 / kRate));
        const Time sent = clock.now();
        mock.send({.bytes = frames[static_cast<std::size_t>(number) % frames.size()]});
        const auto seen = [&] {
            const auto frame = camera->newest();
            if (frame && number == 0) first = frame->sequence;
            return frame && frame->sequence == first + static_cast<std::uint64_t>(number);
        };
        while (!seen() && clock.now() < sent + std::chrono::seconds(1))
            clock.sleepUntil(clock.now() + std::chrono::microseconds(100));
        delays.push_back(1e3 * seconds(clock.now() - sent));
    }
    std::ranges::sort(delays);
    fmt::print("{} {} x {}, {} bytes: p50 {:.2f} ms, p99 {:.2f}, max {:.2f}, of {} frames at {} Hz\n", format, kSize.x, kSize.y,
               frames[0].size(), delays[kFrames / 2], delays[kFrames * 99 / 100], delays.back(), kFrames, kRate);
}

}  // namespace

int main(int, char** words) {
    FANTASCOPE_CHECK(underUmockdev(words), "Debian's package umockdev is installed");
    for (const char* format : {"YUYV", "MJPG"}) measure(format);
}
