// The V4L2 driver beyond its contract: what it requests from a camera, how it handles the answers,
// and what can be wrong with frames. With umockdev cameras.

#include "drivers/camera/v4l2.h"

#include "core/config/config.h"
#include "mock_camera.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <linux/videodev2.h>
#include <opencv2/imgcodecs.hpp>

#include <cerrno>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::drivers {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;

using Bytes = std::vector<std::uint8_t>;

constexpr glm::ivec2 kSize{64, 48};

// Of one luma, without colour.
Bytes yuyv(std::uint8_t luma, glm::ivec2 size = kSize, int padding = 0) {
    Bytes bytes;
    for (int y = 0; y < size.y; ++y) {
        for (int x = 0; x < size.x; ++x) bytes.insert(bytes.end(), {luma, 128});
        bytes.insert(bytes.end(), static_cast<std::size_t>(padding), 0xa5);
    }
    return bytes;
}

Bytes jpeg(std::uint8_t grey) {
    Bytes bytes;
    cv::imencode(".jpg", cv::Mat(kSize.y, kSize.x, CV_8UC1, cv::Scalar(grey)), bytes);
    return bytes;
}

class V4l2Cameras : public testing::Test {
protected:
    MockCamera& plugIn(MockCameraKind kind, int number = 0) {
        mocks_.push_back(std::make_unique<MockCamera>(machine_, std::move(kind)));
        mocks_.back()->plugIn(number);
        return *mocks_.back();
    }
    void open(const std::string& options = "") {
        camera_.reset();
        camera_ = V4l2Camera::fromConfig(optionsFrom("size: [64, 48]\n" + options)).value().open(context_).value();
    }
    static ConfigNode optionsFrom(const std::string& options) {
        return ConfigNode::parse("driver: v4l2\n" + options, "site.yaml").value();
    }
    V4l2Camera& camera() { return dynamic_cast<V4l2Camera&>(*camera_); }
    V4l2Camera::Tally tally() { return camera().tally(); }

    bool becomes(const std::function<bool()>& so) {
        const Time deadline = clock_.now() + std::chrono::seconds(30);
        while (!so()) {
            if (clock_.now() >= deadline) return false;
            clock_.sleepUntil(clock_.now() + std::chrono::milliseconds(1));
        }
        return true;
    }
    bool comesTo(DeviceState state) {
        return becomes([&] { return camera_->status().state == state; });
    }
    // Opens it and waits until it streams.
    void stream(MockCamera& mock, const std::string& options = "") {
        open(options);
        ASSERT_TRUE(comesTo(DeviceState::Running)) << camera_->status().detail;
        ASSERT_TRUE(mock.waitUntilTaken());
    }
    // The frame that the driver shows for one frame of the camera: null if it is not shown.
    std::shared_ptr<const CameraFrame> seenOf(MockCamera& mock, const MockCamera::Frame& frame) {
        mock.send(frame);
        EXPECT_TRUE(mock.waitUntilTaken());
        return camera_->newest();
    }

    SteadyClock clock_;
    DriverContext context_{clock_};
    MockMachine machine_;
    std::vector<std::unique_ptr<MockCamera>> mocks_;
    std::unique_ptr<CameraSource> camera_;
};

// --- Which camera

TEST_F(V4l2Cameras, are_told_apart_by_serial_number_port_card_and_file) {
    plugIn({.card = "Left Eye", .serial = "A1", .usb = "1-1"}, 0);
    plugIn({.card = "Right Eye", .serial = "B2", .usb = "1-2"}, 2);
    for (const char* wanted : {"serial: B2", "usb: 1-2", "card: Right Eye", "device: /dev/video2"}) {
        stream(*mocks_[1], std::string(wanted) + "\n");
        const auto frame = seenOf(*mocks_[1], {.bytes = yuyv(100)});
        EXPECT_NE(frame, nullptr) << wanted;
        EXPECT_EQ(mocks_[0]->streams(), 0) << wanted;
    }
}

TEST_F(V4l2Cameras, of_which_nobody_says_which_are_refused_unless_there_is_one) {
    plugIn({.card = "Eye", .serial = "A1", .usb = "1-1"}, 0);
    open();
    EXPECT_TRUE(comesTo(DeviceState::Running)) << camera_->status().detail;
    plugIn({.card = "Eye", .serial = "B2", .usb = "1-2"}, 1);
    open("card: Eye\n");
    ASSERT_TRUE(comesTo(DeviceState::Faulted));
    EXPECT_THAT(camera_->status().detail,
                AllOf(HasSubstr("more than one camera 'Eye'"), HasSubstr("/dev/video0"), HasSubstr("/dev/video1")));
}

TEST_F(V4l2Cameras, that_are_not_there_are_absent_and_say_who_is_missed) {
    plugIn({.serial = "A1"});
    open("serial: C3\n");
    ASSERT_TRUE(comesTo(DeviceState::Absent));
    EXPECT_THAT(camera_->status().detail, HasSubstr("no camera with the serial number C3"));
    open("device: /dev/video9\n");
    ASSERT_TRUE(comesTo(DeviceState::Absent));
    EXPECT_THAT(camera_->status().detail, HasSubstr("/dev/video9 is not there"));
}

// Example failure: two sites describe one camera differently, and two runs take it from each other.
TEST_F(V4l2Cameras, are_claimed_by_their_file_whatever_a_site_says_of_them) {
    plugIn({.card = "Left Eye", .serial = "A1", .usb = "1-1"}, 0);
    MockCamera& right = plugIn({.card = "Right Eye", .serial = "B2", .usb = "1-2"}, 2);
    const auto claim = [](const char* options) { return V4l2Camera::fromConfig(optionsFrom(options)).value().claim(); };
    const std::string file = claim("device: /dev/video2\n");
    EXPECT_THAT(file, testing::EndsWith("/dev/video2"));
    for (const bool busy : {false, true}) {
        right.setBusy(busy);
        for (const char* wanted : {"serial: B2\n", "usb: 1-2\n", "card: Right Eye\n"}) EXPECT_EQ(claim(wanted), file) << wanted;
    }
    right.setBusy(false);
    EXPECT_EQ(claim(""), "camera") << "of several none";
    EXPECT_EQ(claim("serial: C3\n"), "camera with the serial number C3");
    EXPECT_EQ(right.streams(), 0);
}

// Most USB cameras have a second node, which gives no pictures.
TEST_F(V4l2Cameras, have_nodes_of_metadata_that_are_left_alone) {
    plugIn({.serial = "A1", .usb = "1-1", .captures = false}, 0);
    MockCamera& eye = plugIn({.serial = "A1", .usb = "1-2"}, 1);
    stream(eye, "serial: A1\n");
    EXPECT_NE(seenOf(eye, {.bytes = yuyv(100)}), nullptr);
    open("device: /dev/video0\n");
    ASSERT_TRUE(comesTo(DeviceState::Faulted));
    EXPECT_THAT(camera_->status().detail, HasSubstr("not a streaming camera"));
}

TEST_F(V4l2Cameras, are_found_with_what_a_site_file_would_say_of_them) {
    EXPECT_THAT(findCameras(), IsEmpty());
    plugIn({.card = "Left Eye", .serial = "A1", .usb = "1-1", .formats = {"YUYV", "H264"}}, 0);
    plugIn({.serial = "A1", .usb = "1-3", .captures = false}, 1);
    plugIn({.card = "Right: Eye", .usb = "1-2", .formats = {"H264"}}, 2);
    EXPECT_THAT(
        findCameras(),
        ElementsAre(AllOf(Field(&FoundDevice::family, "camera"), Field(&FoundDevice::what, "Left Eye (YUYV, H264)"),
                          Field(&FoundDevice::identity, "serial A1, USB port 1-1"), Field(&FoundDevice::where, "/dev/video0"),
                          Field(&FoundDevice::why, IsEmpty()), Field(&FoundDevice::options, "{driver: v4l2, serial: A1}")),
                    AllOf(Field(&FoundDevice::what, "Right: Eye (H264)"), Field(&FoundDevice::identity, "USB port 1-2"),
                          Field(&FoundDevice::why, HasSubstr("cannot be decoded")),
                          Field(&FoundDevice::options, "{driver: v4l2, usb: 1-2}"))));
    // The offered options open it.
    open("serial: A1\n");
    EXPECT_TRUE(comesTo(DeviceState::Running)) << camera_->status().detail;
}

// Like the kernel's vivid and many frame grabbers. Example failure: one camera fills the screen.
TEST_F(V4l2Cameras, that_offer_eighty_formats_are_told_in_a_line) {
    std::vector<std::string> formats = {"YUYV"};
    for (int number = 0; number < 79; ++number) formats.push_back(fmt::format("X{:03}", number));
    plugIn({.card = "vivid", .usb = "1-1", .formats = formats}, 0);
    EXPECT_THAT(findCameras(),
                ElementsAre(Field(&FoundDevice::what, "vivid (YUYV, X000, X001, X002, X003, X004, X005, X006 and 72 more)")));
}

TEST_F(V4l2Cameras, have_options_that_are_read_strictly) {
    for (const char* wrong : {"colour: true", "size: [0, 480]", "rate: 0", "format: H264", "range: some", "exposure: long",
                              "gain: 1.5", "device: video0", "device: /dev/video0\nserial: A1"})
        EXPECT_FALSE(V4l2Camera::fromConfig(optionsFrom(std::string(wrong) + "\n"))) << wrong;
}

// --- What it gives

// USB cannot carry 30 large pictures a second unless they are coded.
TEST_F(V4l2Cameras, are_asked_for_the_format_that_reaches_the_rate) {
    MockCamera& mock = plugIn({.formats = {"GREY", "MJPG", "YUYV"}, .rates = {{"YUYV", 10}, {"GREY", 29.97}}});
    stream(mock, "rate: 30\n");
    EXPECT_EQ(mock.format(), "MJPG") << "a grey picture has the rate too, and no colours";
    stream(mock, "rate: 10\n");
    EXPECT_EQ(mock.format(), "YUYV") << "what need not be decoded is preferred";
    stream(mock, "rate: 30\nformat: YUYV\n");
    EXPECT_EQ(mock.format(), "YUYV") << "but what the site file says comes first";
    stream(mock, "format: NV12\n");
    EXPECT_EQ(mock.format(), "MJPG") << "what is not offered is no reason to show nothing";
}

// Drivers answer with what they have, and a picture decoded in the wrong format is garbage.
TEST_F(V4l2Cameras, that_answer_with_another_format_are_not_believed) {
    MockCamera& mock = plugIn({.formats = {"YUYV", "MJPG"}, .answers = "MJPG"});
    stream(mock);
    EXPECT_EQ(mock.format(), "MJPG");
    const auto frame = seenOf(mock, {.bytes = jpeg(100)});
    ASSERT_NE(frame, nullptr);
    EXPECT_NEAR(frame->image.at(30, 20).g, 100, 2);

    plugIn({.usb = "1-2", .formats = {"YUYV"}, .answers = "H264"}, 1);
    open("usb: 1-2\n");
    ASSERT_TRUE(comesTo(DeviceState::Faulted));
    EXPECT_THAT(camera_->status().detail, HasSubstr("grants none of the formats"));
    plugIn({.usb = "1-3", .formats = {"H264", "HEVC"}}, 2);
    open("usb: 1-3\n");
    ASSERT_TRUE(comesTo(DeviceState::Faulted));
    EXPECT_THAT(camera_->status().detail, HasSubstr("it offers H264, HEVC, which cannot be decoded"));
}

TEST_F(V4l2Cameras, that_grant_another_size_show_it) {
    MockCamera& mock = plugIn({.size = {32, 24}});
    stream(mock);
    const auto frame = seenOf(mock, {.bytes = yuyv(126, {32, 24})});
    ASSERT_NE(frame, nullptr);
    EXPECT_EQ(frame->image.width(), 32);
    EXPECT_EQ(frame->image.height(), 24);
}

TEST_F(V4l2Cameras, whose_rows_are_padded_show_straight_pictures) {
    MockCamera& mock = plugIn({.padding = 48});
    stream(mock);
    const auto frame = seenOf(mock, {.bytes = yuyv(126, kSize, 48)});
    ASSERT_NE(frame, nullptr);
    for (const Rgba8 pixel : frame->image.pixels()) ASSERT_NEAR(pixel.g, 128, 2);
}

// v4l2loopback is one of these.
TEST_F(V4l2Cameras, that_say_no_row_length_have_no_padding) {
    MockCamera& mock = plugIn({.saysStride = false});
    stream(mock);
    EXPECT_NE(seenOf(mock, {.bytes = yuyv(126)}), nullptr);
}

TEST_F(V4l2Cameras, have_the_range_that_they_say_or_that_the_site_file_says) {
    MockCamera& limited = plugIn({.usb = "1-1"}, 0);
    stream(limited, "usb: 1-1\n");
    EXPECT_NEAR(seenOf(limited, {.bytes = yuyv(16)})->image.at(9, 9).r, 0, 1);
    stream(limited, "usb: 1-1\nrange: full\n");
    EXPECT_NEAR(seenOf(limited, {.bytes = yuyv(16)})->image.at(9, 9).r, 16, 1);
    MockCamera& full = plugIn({.usb = "1-2", .fullRange = true}, 1);
    stream(full, "usb: 1-2\n");
    EXPECT_NEAR(seenOf(full, {.bytes = yuyv(16)})->image.at(9, 9).r, 16, 1);
    stream(full, "usb: 1-2\nrange: limited\n");
    EXPECT_NEAR(seenOf(full, {.bytes = yuyv(16)})->image.at(9, 9).r, 0, 1);
}

// --- What is locked

TEST_F(V4l2Cameras, keep_what_is_locked) {
    MockCamera& mock = plugIn({.controls = {{V4L2_CID_EXPOSURE_AUTO, {0, 3, 3}},
                                            {V4L2_CID_EXPOSURE_ABSOLUTE, {1, 10000, 156}},
                                            {V4L2_CID_AUTOGAIN, {0, 1, 1}},
                                            {V4L2_CID_GAIN, {0, 255, 64}},
                                            {V4L2_CID_AUTO_WHITE_BALANCE, {0, 1, 1}},
                                            {V4L2_CID_WHITE_BALANCE_TEMPERATURE, {2800, 6500, 4000}},
                                            {V4L2_CID_FOCUS_AUTO, {0, 1, 1}},
                                            {V4L2_CID_FOCUS_ABSOLUTE, {0, 250, 0}}}});
    stream(mock, "exposure: 200\ngain: 300\nwhite_balance: 3200\nfocus: 40\n");
    EXPECT_EQ(mock.control(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_MANUAL);
    EXPECT_EQ(mock.control(V4L2_CID_EXPOSURE_ABSOLUTE), 200);
    EXPECT_EQ(mock.control(V4L2_CID_AUTOGAIN), 0);
    EXPECT_EQ(mock.control(V4L2_CID_GAIN), 255) << "as near as it can";
    EXPECT_EQ(mock.control(V4L2_CID_AUTO_WHITE_BALANCE), 0);
    EXPECT_EQ(mock.control(V4L2_CID_WHITE_BALANCE_TEMPERATURE), 3200);
    EXPECT_EQ(mock.control(V4L2_CID_FOCUS_AUTO), 0);
    EXPECT_EQ(mock.control(V4L2_CID_FOCUS_ABSOLUTE), 40);

    stream(mock, "exposure: auto\nfocus: auto\n");
    EXPECT_EQ(mock.control(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_APERTURE_PRIORITY);
    EXPECT_EQ(mock.control(V4L2_CID_FOCUS_AUTO), 1);
    EXPECT_EQ(mock.control(V4L2_CID_AUTOGAIN), 0) << "what is not named stays";

    // A camera forgets everything when it loses power.
    mock.unplug();
    ASSERT_TRUE(comesTo(DeviceState::Absent));
    EXPECT_EQ(camera_->newest(), nullptr);
    mock.plugIn(5);
    ASSERT_TRUE(comesTo(DeviceState::Running)) << camera_->status().detail;
    EXPECT_EQ(mock.control(V4L2_CID_FOCUS_AUTO), 1);
}

TEST_F(V4l2Cameras, that_cannot_be_locked_run_all_the_same) {
    MockCamera& mock = plugIn({});
    stream(mock, "exposure: 200\nfocus: auto\n");
    EXPECT_NE(seenOf(mock, {.bytes = yuyv(100)}), nullptr);
    const CameraDescription description = camera_->description();
    EXPECT_EQ(description.lacks, "exposure cannot be set; focus cannot be automatic");
    EXPECT_EQ(description.exposure, Time::zero());
}

// A lens is kept by these.
TEST_F(V4l2Cameras, say_what_they_are_and_what_they_do_not_do) {
    open();
    EXPECT_EQ(camera_->description(), CameraDescription()) << "none is there";
    MockCamera& mock = plugIn(
        {.card = "HD Webcam C525",
         .serial = "4F2A",
         .controls = {
             {V4L2_CID_EXPOSURE_AUTO, {0, 3, 3}}, {V4L2_CID_EXPOSURE_ABSOLUTE, {1, 10000, 156}}, {V4L2_CID_GAIN, {0, 255, 64}}}});
    stream(mock, "exposure: 200\ngain: 300\n");
    const CameraDescription description = camera_->description();
    EXPECT_EQ(description.card, "HD Webcam C525");
    EXPECT_EQ(description.serial, "4F2A");
    EXPECT_EQ(description.format, "YUYV 64 x 48 at 30 Hz");
    EXPECT_EQ(description.lacks, "gain 255 instead of 300");
    EXPECT_EQ(description.exposure, std::chrono::milliseconds(20));
    mock.unplug();
    ASSERT_TRUE(comesTo(DeviceState::Absent));
    EXPECT_EQ(camera_->description(), description) << "as it was last found";
}

// --- When it was exposed

constexpr MockCameraKind::Range kTwentyMilliseconds{1, 10000, 200}, kManual{0, 3, V4L2_EXPOSURE_MANUAL};
constexpr Time kMillisecond = std::chrono::milliseconds(1);

TEST_F(V4l2Cameras, tell_the_middle_of_an_exposure_that_is_known) {
    const std::map<std::uint32_t, MockCameraKind::Range> locked{{V4L2_CID_EXPOSURE_AUTO, kManual},
                                                                {V4L2_CID_EXPOSURE_ABSOLUTE, kTwentyMilliseconds}};
    for (const bool atStart : {false, true}) {
        const int number = atStart ? 1 : 0;
        MockCamera& mock =
            plugIn({.usb = fmt::format("1-{}", number + 1),
                    .controls = locked,
                    .stampFlags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | (atStart ? V4L2_BUF_FLAG_TSTAMP_SRC_SOE : 0u)},
                   number);
        stream(mock, fmt::format("usb: {}\n", mock.kind().usb));
        // A tenth of a second ago, on either clock.
        const Time before = clock_.now(), stamp = kernelTime() - 100 * kMillisecond, after = clock_.now();
        const auto frame = seenOf(mock, {.bytes = yuyv(100), .stamp = stamp});
        ASSERT_NE(frame, nullptr);
        const Time middle = (atStart ? 10 : -10) * kMillisecond - 100 * kMillisecond;
        EXPECT_GE(frame->exposed, before + middle - std::chrono::microseconds(10));
        EXPECT_LE(frame->exposed, after + middle + std::chrono::microseconds(10));
    }
}

// Some drivers use another clock, some have no time stamps, and some report nonsense.
TEST_F(V4l2Cameras, whose_stamps_say_nothing_are_taken_at_their_arrival) {
    MockCamera& mock = plugIn({.usb = "1-1"}, 0);
    MockCamera& unstamped = plugIn({.usb = "1-2", .stampFlags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN}, 1);
    stream(mock, "usb: 1-1\n");
    for (const Time stamp : {Time::zero(), kernelTime() + std::chrono::hours(1)}) {
        const Time before = clock_.now();
        const auto frame = seenOf(mock, {.bytes = yuyv(100), .stamp = stamp});
        ASSERT_NE(frame, nullptr);
        EXPECT_GE(frame->exposed, before);
        EXPECT_LE(frame->exposed, clock_.now());
    }
    stream(unstamped, "usb: 1-2\n");
    const Time before = clock_.now();
    const auto frame = seenOf(unstamped, {.bytes = yuyv(100), .stamp = kernelTime() - 100 * kMillisecond});
    ASSERT_NE(frame, nullptr);
    EXPECT_GE(frame->exposed, before);
}

TEST_F(V4l2Cameras, whose_stamps_go_back_still_tell_times_that_rise) {
    MockCamera& mock = plugIn({});
    stream(mock);
    const Time now = kernelTime();
    const auto first = seenOf(mock, {.bytes = yuyv(100), .stamp = now});
    const auto second = seenOf(mock, {.bytes = yuyv(100), .stamp = now - kMillisecond});
    ASSERT_TRUE(first != nullptr && second != nullptr);
    EXPECT_GT(second->exposed, first->exposed);
    EXPECT_GT(second->sequence, first->sequence);
}

// --- What is wrong with its frames

TEST_F(V4l2Cameras, show_no_damaged_frame_and_count_it) {
    MockCamera& mock = plugIn({.formats = {"MJPG"}});
    stream(mock);
    ASSERT_NE(seenOf(mock, {.bytes = jpeg(100)}), nullptr);
    Bytes torn = jpeg(100);
    torn.resize(torn.size() / 2);
    EXPECT_EQ(seenOf(mock, {.bytes = torn}), nullptr);
    EXPECT_EQ(seenOf(mock, {.bytes = {}}), nullptr);
    EXPECT_EQ(seenOf(mock, {.bytes = jpeg(100), .damaged = true}), nullptr);
    EXPECT_EQ(tally().damaged, 3u);
    EXPECT_NE(seenOf(mock, {.bytes = jpeg(100)}), nullptr);
    EXPECT_EQ(tally().good, 2u);
    EXPECT_EQ(tally().missed, 0u);
    EXPECT_EQ(camera_->status().losses, 0);
}

TEST_F(V4l2Cameras, show_no_frame_that_is_too_short) {
    MockCamera& mock = plugIn({});
    stream(mock);
    Bytes part = yuyv(100);
    part.resize(part.size() - 1);
    EXPECT_EQ(seenOf(mock, {.bytes = part}), nullptr);
    EXPECT_EQ(tally().damaged, 1u);
}

TEST_F(V4l2Cameras, that_drop_frames_leave_gaps_in_the_count) {
    MockCamera& mock = plugIn({});
    stream(mock);
    const auto first = seenOf(mock, {.bytes = yuyv(100)});
    const auto second = seenOf(mock, {.bytes = yuyv(100), .skipped = 3});
    ASSERT_TRUE(first != nullptr && second != nullptr);
    EXPECT_EQ(second->sequence, first->sequence + 4);
    EXPECT_EQ(tally().missed, 3u);
}

TEST_F(V4l2Cameras, go_on_counting_when_the_stream_begins_anew) {
    MockCamera& mock = plugIn({});
    stream(mock);
    seenOf(mock, {.bytes = yuyv(100)});
    const auto before = seenOf(mock, {.bytes = yuyv(100)});
    mock.unplug();
    ASSERT_TRUE(comesTo(DeviceState::Absent));
    mock.plugIn(1);
    ASSERT_TRUE(comesTo(DeviceState::Running));
    ASSERT_TRUE(mock.waitUntilTaken());
    const auto after = seenOf(mock, {.bytes = yuyv(100)});
    ASSERT_TRUE(before != nullptr && after != nullptr);
    EXPECT_GT(after->sequence, before->sequence);
}

// --- When it stops

TEST_F(V4l2Cameras, that_stall_are_started_again_then_faulted_until_they_speak) {
    MockCamera& mock = plugIn({});
    stream(mock);
    ASSERT_NE(seenOf(mock, {.bytes = yuyv(100)}), nullptr);
    const int streams = mock.streams();
    EXPECT_EQ(camera_->status().trouble, "");
    ASSERT_TRUE(mock.waitForStreams(streams + 1)) << "its stream is restarted first";
    EXPECT_EQ(camera_->status().losses, 0);
    EXPECT_THAT(camera_->status().trouble, HasSubstr("restarting its stream"));
    EXPECT_NE(seenOf(mock, {.bytes = yuyv(100)}), nullptr);
    EXPECT_EQ(camera_->status().trouble, "");
    ASSERT_TRUE(mock.waitForStreams(streams + 2));
    ASSERT_TRUE(comesTo(DeviceState::Faulted));
    EXPECT_THAT(camera_->status().detail, HasSubstr("gives no frames"));
    EXPECT_EQ(camera_->status().trouble, "");
    // It is reopened again and again, and is not Running before there is a picture.
    ASSERT_TRUE(mock.waitForStreams(streams + 3));
    ASSERT_TRUE(mock.waitUntilTaken());
    EXPECT_EQ(camera_->status().state, DeviceState::Faulted);
    EXPECT_NE(seenOf(mock, {.bytes = yuyv(100)}), nullptr);
    EXPECT_EQ(camera_->status().state, DeviceState::Running);
    EXPECT_EQ(camera_->status().losses, 1);
}

TEST_F(V4l2Cameras, that_lose_their_signal_are_started_again) {
    MockCamera& mock = plugIn({.rates = {{"YUYV", .1}}});
    stream(mock);
    const int streams = mock.streams();
    mock.failTaking(EIO);
    ASSERT_TRUE(comesTo(DeviceState::Faulted));
    EXPECT_GT(mock.streams(), streams);
    mock.failTaking(0);
    ASSERT_TRUE(mock.waitForStreams(streams + 2));
    ASSERT_TRUE(mock.waitUntilTaken());
    EXPECT_NE(seenOf(mock, {.bytes = yuyv(100)}), nullptr);
    EXPECT_EQ(camera_->status().state, DeviceState::Running);
}

TEST_F(V4l2Cameras, that_another_program_uses_are_faulted_until_it_lets_them_go) {
    MockCamera& mock = plugIn({});
    mock.setBusy(true);
    open();
    ASSERT_TRUE(comesTo(DeviceState::Faulted));
    EXPECT_THAT(camera_->status().detail, AllOf(HasSubstr("/dev/video0"), HasSubstr("another program uses it")));
    const auto listed = findCameras();
    ASSERT_EQ(listed.size(), 1u);
    EXPECT_EQ(listed[0].why, camera_->status().detail);
    mock.setBusy(false);
    EXPECT_TRUE(comesTo(DeviceState::Running)) << camera_->status().detail;
    EXPECT_EQ(camera_->status().losses, 0);
}

// --- What a frame costs

TEST(FramePool, uses_memory_again_that_nobody_holds) {
    FramePool pool;
    auto held = pool.take(kSize);
    const Rgba8* first = held->image.pixels().data();
    auto other = pool.take(kSize);
    EXPECT_NE(other->image.pixels().data(), first) << "what is held goes nowhere else";
    held.reset();
    other.reset();
    held = pool.take(kSize);
    other = pool.take(kSize);
    EXPECT_TRUE(held->image.pixels().data() == first || other->image.pixels().data() == first);
    EXPECT_EQ(pool.take({4, 2})->image.width(), 4);
}

}  // namespace
}  // namespace fantascope::drivers
