// The camera driver against the kernel's own drivers: vivid, which is a camera in all but glass,
// and v4l2loopback, which is whatever a program feeds it. tests/vm/camera.sh brings them up, on a
// machine of its own; elsewhere every test here is skipped.

#include "drivers/camera/v4l2.h"
#include "drivers/camera/video_node.h"
#include "drivers/common/file_handle.h"

#include "contract/camera_source_suite.h"
#include "contract/eventually.h"
#include "core/check.h"
#include "core/config/config.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace fantascope::drivers {
namespace {

using testing::HasSubstr;

const std::string kVivid = "vivid", kLoopback = "Loopback";

void run(const std::string& command) { EXPECT_EQ(std::system(command.c_str()), 0) << command; }

class RealNodes : public testing::Test {
protected:
    void SetUp() override {
        for (const FoundDevice& camera : findCameras())
            if (camera.what.starts_with(kVivid)) vivid_ = camera.where;
        if (vivid_.empty()) GTEST_SKIP() << "no vivid here: tests/vm/camera.sh loads it";
    }

    void open(const std::string& options) {
        const std::string text = "driver: v4l2\n" + options;
        camera_ = V4l2Camera::fromConfig(ConfigNode::parse(text, "site.yaml").value()).value().open(context_).value();
    }
    V4l2Camera& camera() { return dynamic_cast<V4l2Camera&>(*camera_); }

    // Whether something becomes so; a machine in software takes its time.
    bool becomes(const std::function<bool()>& so) {
        const Time deadline = clock_.now() + std::chrono::seconds(60);
        while (!so()) {
            if (clock_.now() >= deadline) return false;
            clock_.sleepUntil(clock_.now() + std::chrono::milliseconds(1));
        }
        return true;
    }
    bool comesToRun() {
        return becomes([&] { return camera_->status().state == DeviceState::Running; });
    }
    std::shared_ptr<const CameraFrame> next() {
        std::shared_ptr<const CameraFrame> frame;
        becomes([&] { return (frame = camera_->newest()) != nullptr; });
        return frame;
    }
    void control(const std::string& what) { run(fmt::format("v4l2-ctl -d {} -c {}", vivid_, what)); }

    SteadyClock clock_;
    DriverContext context_{clock_};
    std::string vivid_;
    std::unique_ptr<CameraSource> camera_;
};

struct Bar {
    int r, g, b;
};

class RealNodesOf : public RealNodes, public testing::WithParamInterface<std::string> {};

// The kernel's own test pattern, through its own coding of it: eight bars of full colour.
TEST_P(RealNodesOf, give_the_colours_of_the_kernels_test_pattern) {
    const std::string format = GetParam();
    control("test_pattern=1,osd_text_mode=2");
    open(fmt::format("card: {}\nsize: [640, 360]\nrate: 30\nformat: {}\n", kVivid, format));
    ASSERT_TRUE(comesToRun()) << camera_->status().detail;
    next();  // the first may be from before the pattern was chosen
    const auto frame = next();
    ASSERT_NE(frame, nullptr) << camera_->status().detail;
    const RgbaImage& image = frame->image;
    ASSERT_EQ(image.width(), 640);
    ASSERT_EQ(image.height(), 360);
    const Bar bars[] = {{255, 255, 255}, {255, 255, 0}, {0, 255, 255}, {0, 255, 0},
                        {255, 0, 255},   {255, 0, 0},   {0, 0, 255},   {0, 0, 0}};
    for (int bar = 0; bar < 8; ++bar) {
        const Rgba8 seen = image.at(bar * 80 + 40, 180);
        if (format == "GREY") {
            EXPECT_EQ(seen.r, seen.g);
            continue;
        }
        EXPECT_NEAR(seen.r, bars[bar].r, 4) << bar;
        EXPECT_NEAR(seen.g, bars[bar].g, 4) << bar;
        EXPECT_NEAR(seen.b, bars[bar].b, 4) << bar;
    }
}
INSTANTIATE_TEST_SUITE_P(As, RealNodesOf, testing::Values("YUYV", "UYVY", "NV12", "RGB24", "GREY"),
                         [](const auto& format) { return format.param; });

TEST_F(RealNodes, stamp_each_frame_by_our_clock_and_count_it) {
    open(fmt::format("card: {}\nsize: [640, 360]\nrate: 30\n", kVivid));
    std::shared_ptr<const CameraFrame> last;
    for (int i = 0; i < 20; ++i) {
        auto frame = next();
        ASSERT_NE(frame, nullptr) << camera_->status().detail;
        EXPECT_LE(frame->exposed, clock_.now());
        EXPECT_GT(frame->exposed, Time::zero()) << "it was exposed since we looked";
        if (last) {
            EXPECT_GT(frame->exposed, last->exposed);
            EXPECT_GT(frame->sequence, last->sequence);
        }
        last = std::move(frame);
    }
}

// So the colours above came through DMABUFs; v4l2loopback offers none, and its film comes through
// memory that is mapped.
TEST_F(RealNodes, share_dmabufs) {
    int error = 0;
    auto node = VideoNode::open(vivid_, error);
    ASSERT_TRUE(node) << error;
    VideoNode::Grant grant;
    ASSERT_EQ(node->setFormat(FrameCoding::Yuyv, {640, 360}, 30, grant), 0);
    EXPECT_FALSE(node->sharesDmabufs()) << "before it streams";
    ASSERT_EQ(node->start(), 0);
    EXPECT_TRUE(node->sharesDmabufs());
}

// vivid answers with a format that it has.
TEST_F(RealNodes, that_do_not_know_a_format_give_another) {
    open(fmt::format("card: {}\nsize: [640, 360]\nformat: MJPG\n", kVivid));
    EXPECT_NE(next(), nullptr) << camera_->status().detail;
}

TEST_F(RealNodes, that_drop_frames_leave_gaps_in_the_count) {
    open(fmt::format("card: {}\nsize: [640, 360]\nrate: 30\n", kVivid));
    ASSERT_NE(next(), nullptr) << camera_->status().detail;
    control("percentage_of_dropped_buffers=50");
    const auto before = camera().tally().missed;
    EXPECT_TRUE(becomes([&] { return camera().tally().missed >= before + 10; }));
    control("percentage_of_dropped_buffers=0");
    EXPECT_EQ(camera_->status().state, DeviceState::Running);
    EXPECT_EQ(camera_->status().losses, 0);
}

TEST_F(RealNodes, that_flag_a_frame_as_damaged_show_it_to_nobody) {
    open(fmt::format("card: {}\nsize: [640, 360]\nrate: 30\n", kVivid));
    ASSERT_NE(next(), nullptr) << camera_->status().detail;
    const auto before = camera().tally();
    control("inject_v4l2_buf_flag_error=1");
    EXPECT_TRUE(becomes([&] { return camera().tally().damaged > before.damaged; }));
    EXPECT_TRUE(becomes([&] { return camera().tally().good > before.good + 3; }));
    EXPECT_EQ(camera_->status().losses, 0);
}

TEST_F(RealNodes, that_another_program_streams_from_are_busy) {
    const pid_t other = fork();
    if (other == 0) {
        execlp("v4l2-ctl", "v4l2-ctl", "-d", vivid_.c_str(), "--stream-mmap", "--stream-to=/dev/null", "--silent", nullptr);
        _exit(127);
    }
    // The other one needs a moment until it streams, and ours would have had it until then.
    EXPECT_TRUE(becomes([&] {
        return std::system(fmt::format("v4l2-ctl -d {} --set-fmt-video=width=320 >/dev/null 2>&1", vivid_).c_str()) != 0;
    }));
    open(fmt::format("card: {}\n", kVivid));
    EXPECT_TRUE(becomes([&] { return camera_->status().state == DeviceState::Faulted; }));
    EXPECT_THAT(camera_->status().detail, HasSubstr("another program uses it"));
    for (const FoundDevice& listed : findCameras()) {
        if (listed.where != vivid_) continue;
        EXPECT_THAT(listed.why, HasSubstr("another program uses it"));
    }
    kill(other, SIGTERM);
    waitpid(other, nullptr, 0);
    EXPECT_NE(next(), nullptr) << "it is free again: " << camera_->status().detail;
}

// A program plays the camera, and may stop at any moment.
TEST_F(RealNodes, that_fall_silent_are_faulted_until_they_speak_again) {
    ASSERT_NE(std::getenv("FANTASCOPE_FILM"), nullptr) << "camera.sh is given one";
    std::string node;
    for (const FoundDevice& camera : findCameras())
        if (camera.what.starts_with(kLoopback)) node = camera.where;
    ASSERT_FALSE(node.empty()) << "camera.sh loads it";
    const auto play = [&] {
        const pid_t player = fork();
        if (player == 0) {
            execlp("ffmpeg", "ffmpeg", "-nostdin", "-loglevel", "error", "-re", "-stream_loop", "-1", "-i",
                   std::getenv("FANTASCOPE_FILM"), "-c", "copy", "-f", "v4l2", node.c_str(), nullptr);
            _exit(127);
        }
        return player;
    };
    const auto stop = [](pid_t player) {
        kill(player, SIGKILL);
        waitpid(player, nullptr, 0);
    };
    const pid_t first = play();
    open(fmt::format("card: {}\nsize: [640, 360]\nformat: MJPG\n", kLoopback));
    const auto frame = next();
    ASSERT_NE(frame, nullptr) << camera_->status().detail;
    EXPECT_EQ(frame->image.width(), 640);
    for (int i = 0; i < 10; ++i) EXPECT_NE(next(), nullptr);
    EXPECT_EQ(camera().tally().damaged, 0u);
    stop(first);
    EXPECT_TRUE(becomes([&] { return camera_->status().state != DeviceState::Running; }));
    fmt::print("silent: {}\n", camera_->status().detail);
    EXPECT_EQ(camera_->newest(), nullptr);
    const pid_t second = play();
    EXPECT_NE(next(), nullptr) << camera_->status().detail;
    EXPECT_EQ(camera_->status().losses, 1);
    stop(second);
}

// vivid's nodes are gone for as long as anybody still has them open.
TEST_F(RealNodes, that_are_unplugged_while_they_stream_come_back) {
    open(fmt::format("card: {}\nsize: [640, 360]\nrate: 30\n", kVivid));
    ASSERT_NE(next(), nullptr) << camera_->status().detail;
    control("disconnect=1");
    EXPECT_TRUE(becomes([&] { return camera_->status().losses == 1; })) << camera_->status().detail;
    EXPECT_NE(next(), nullptr) << camera_->status().detail;
    EXPECT_EQ(camera_->status().state, DeviceState::Running);
}

// One of two. Who has its node open keeps a disconnected one away; it is back once nobody has.
class VividRig final : public contract::CameraSourceRig {
public:
    VividRig() {
        reopen();
        letTimePass();
    }
    ~VividRig() override { plugIn(); }

    CameraSource& port() override { return *port_; }
    void reopen() override {
        port_.reset();
        port_ = open(10);
    }
    void unplug() override {
        held_ = FileHandle(::open("/dev/video10", O_RDWR | O_CLOEXEC));
        run("v4l2-ctl -d /dev/video10 -c disconnect=1");
    }
    void plugIn() override { held_ = FileHandle(); }
    void letTimePass() override {
        contract::eventually("the camera is as it was plugged", [&] { return runs(*port_) != held_.isOpen(); });
    }
    Clock& clock() override { return clock_; }
    Device& neighbour() override {
        contract::eventually("the neighbour runs", [&] { return runs(*neighbour_); });
        return *neighbour_;
    }
    void expose(int) override { FANTASCOPE_CHECK(false, "nobody tells the kernel's camera when"); }

private:
    static bool runs(const Device& device) { return device.status().state == DeviceState::Running; }
    std::unique_ptr<CameraSource> open(int node) {
        const std::string text = fmt::format("driver: v4l2\ndevice: /dev/video{}\nsize: [320, 180]\nrate: 30\n", node);
        return V4l2Camera::fromConfig(ConfigNode::parse(text, "site.yaml").value()).value().open(context_).value();
    }

    SteadyClock clock_;
    DriverContext context_{clock_};
    FileHandle held_;
    std::unique_ptr<CameraSource> neighbour_ = open(11), port_;
};

// What a camera promises of its life; what it sees, and when, is told above and by cameras that are
// told when.
TEST(RealNodesTwo, keep_the_contract_of_their_lives) {
    if (!std::filesystem::exists("/dev/video11")) GTEST_SKIP() << "no two cameras here: tests/vm/camera.sh loads them";
    const auto serves = [](contract::CameraSourceRig& rig) -> std::string {
        for (std::int64_t last = -1, frames = 0; frames < 3;) {
            std::shared_ptr<const CameraFrame> frame;
            contract::eventually("a frame", [&] {
                frame = rig.port().newest();
                return frame != nullptr || rig.port().status().state != DeviceState::Running;
            });
            CONTRACT_REQUIRE(frame != nullptr, "no frame came");
            CONTRACT_REQUIRE(static_cast<std::int64_t>(frame->sequence) > last, "count {} after {}", frame->sequence, last);
            last = static_cast<std::int64_t>(frame->sequence);
            ++frames;
        }
        return "";
    };
    EXPECT_THAT(contract::violations(contract::lifeClauses<contract::CameraSourceRig>(serves),
                                     [] { return std::make_unique<VividRig>(); }),
                testing::IsEmpty());
}

}  // namespace
}  // namespace fantascope::drivers
