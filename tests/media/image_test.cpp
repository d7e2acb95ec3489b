#include "media/image.h"

#include "core/random.h"
#include "scratch_folder.h"

#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <utility>

namespace fantascope {
namespace {

using testing::AllOf;
using testing::Each;
using testing::HasSubstr;
using testing::StartsWith;

// A picture encoded by OpenCV, in its blue-first order.
std::string encoded(const char* ending, const cv::Mat& picture) {
    std::vector<std::uint8_t> bytes;
    cv::imencode(ending, picture, bytes);
    return {bytes.begin(), bytes.end()};
}

cv::Mat gradient(int width, int height) {
    cv::Mat picture(height, width, CV_8UC3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            picture.at<cv::Vec3b>(y, x) = {std::uint8_t(3 * x), std::uint8_t(5 * y), std::uint8_t(x ^ y)};
    return picture;
}

class ImageTest : public testing::Test {
protected:
    // The error of both readers for a file of these bytes; they must agree.
    std::string refusal(const std::string& bytes) {
        const auto path = folder_.file("picture", bytes);
        const auto grey = readGrey(path);
        EXPECT_EQ(grey.has_value(), readRgba(path).has_value());
        if (grey) return "accepted";
        EXPECT_THAT(grey.error().message(), StartsWith(path.string() + ": ")) << "the file is named";
        return grey.error().message();
    }
    GreyImage grey(const std::string& bytes) { return readGrey(folder_.file("picture", bytes)).value(); }
    RgbaImage rgba(const std::string& bytes) { return readRgba(folder_.file("picture", bytes)).value(); }

    ScratchFolder folder_;
};

TEST_F(ImageTest, a_written_picture_reads_back_as_it_was) {
    RgbaImage picture(3, 2);
    picture.at(0, 0) = {1, 2, 3, 4};
    picture.at(2, 1) = {255, 128, 0, 255};
    ASSERT_TRUE(writePng(folder_ / "a.png", picture));
    EXPECT_EQ(*readRgba(folder_ / "a.png"), picture);
    GreyImage grey(2, 3);
    grey.at(1, 2) = 1;
    ASSERT_TRUE(writePng(folder_ / "b.png", grey));
    EXPECT_EQ(*readGrey(folder_ / "b.png"), grey);
}

TEST_F(ImageTest, grey_values_are_rounded_to_the_nearest_step_and_kept_in_range) {
    GreyImage grey(4, 1);
    std::ranges::copy(std::array{0.4f / 255, 0.6f / 255, -1.0f, 7.0f}, grey.pixels().begin());
    ASSERT_TRUE(writePng(folder_ / "a.png", grey));
    EXPECT_THAT(readGrey(folder_ / "a.png")->pixels(), testing::ElementsAre(0.0f, 1.0f / 255, 0.0f, 1.0f));
}

TEST_F(ImageTest, the_same_picture_gives_the_same_bytes) {
    const RgbaImage picture(40, 30, {9, 8, 7, 255});
    ASSERT_TRUE(writePng(folder_ / "a.png", picture));
    ASSERT_TRUE(writePng(folder_ / "b.png", picture));
    EXPECT_EQ(*readFile(folder_ / "a.png"), *readFile(folder_ / "b.png"));
}

TEST_F(ImageTest, colours_become_grey_by_rec_601) {
    const auto one = [](std::uint8_t r, std::uint8_t g, std::uint8_t b) {
        return encoded(".png", cv::Mat(1, 1, CV_8UC3, cv::Scalar(b, g, r)));
    };
    EXPECT_NEAR(grey(one(255, 0, 0)).at(0, 0), 0.299, 1e-6);
    EXPECT_NEAR(grey(one(0, 255, 0)).at(0, 0), 0.587, 1e-6);
    EXPECT_NEAR(grey(one(0, 0, 255)).at(0, 0), 0.114, 1e-6);
    EXPECT_NEAR(grey(one(255, 255, 255)).at(0, 0), 1, 1e-6);
    EXPECT_EQ(rgba(one(1, 2, 3)).at(0, 0), (Rgba8{1, 2, 3, 255}));
}

TEST_F(ImageTest, sixteen_bits_keep_their_steps) {
    const std::string bytes = encoded(".png", cv::Mat(1, 1, CV_16UC1, cv::Scalar(1000)));
    EXPECT_NEAR(grey(bytes).at(0, 0), 1000.0 / 65535, 1e-7) << "not rounded to eight bits first";
    EXPECT_EQ(rgba(bytes).at(0, 0), (Rgba8{4, 4, 4, 255}));
    EXPECT_EQ(rgba(encoded(".png", cv::Mat(1, 1, CV_16UC4, cv::Scalar(0, 65535, 257 * 7, 257 * 9)))).at(0, 0),
              (Rgba8{7, 255, 0, 9}));
    const Rgba16Image fine(2, 1, Rgba16{1000, 2001, 65535, 40000});
    ASSERT_TRUE(writePng(folder_ / "fine.png", fine));
    EXPECT_EQ(readRgba16(folder_ / "fine.png").value(), fine);
}

// A guide on a transparent background: what was not drawn is black, because no light falls there.
TEST_F(ImageTest, what_is_transparent_is_black_in_grey_and_keeps_its_alpha_in_colour) {
    const std::string bytes = encoded(".png", cv::Mat(1, 1, CV_8UC4, cv::Scalar(255, 255, 255, 51)));
    EXPECT_NEAR(grey(bytes).at(0, 0), 0.2, 1e-6);
    EXPECT_EQ(rgba(bytes).at(0, 0), (Rgba8{255, 255, 255, 51}));
}

TEST_F(ImageTest, row_0_is_at_the_top) {
    cv::Mat picture = cv::Mat::zeros(3, 2, CV_8UC1);
    picture.at<std::uint8_t>(0, 1) = 255;
    EXPECT_EQ(grey(encoded(".png", picture)).at(1, 0), 1);
}

TEST_F(ImageTest, a_truncated_png_is_refused_wherever_it_ends) {
    const std::string whole = encoded(".png", gradient(60, 40));
    EXPECT_EQ(refusal(whole), "accepted");
    for (std::size_t tenth = 1; tenth < 10; ++tenth)
        EXPECT_THAT(refusal(whole.substr(0, whole.size() * tenth / 10)), HasSubstr("truncated"));
    EXPECT_THAT(refusal(whole.substr(0, whole.size() - 9)), HasSubstr("truncated")) << "only the end is missing";
    EXPECT_THAT(refusal(whole.substr(0, 3)), HasSubstr("not a picture"));
    EXPECT_THAT(refusal(""), HasSubstr("empty"));
}

TEST_F(ImageTest, a_damaged_png_is_refused) {
    const std::string whole = encoded(".png", gradient(60, 40));
    for (std::size_t part = 1; part < 8; ++part) {
        std::string damaged = whole;
        damaged[damaged.size() * part / 8] ^= 0x55;
        EXPECT_THAT(refusal(damaged), HasSubstr("damaged")) << "byte " << damaged.size() * part / 8;
    }
}

// libjpeg would fill the missing part with grey and only warn.
TEST_F(ImageTest, a_truncated_jpeg_is_refused_wherever_it_ends) {
    const std::string whole = encoded(".jpg", gradient(60, 40));
    EXPECT_EQ(refusal(whole), "accepted");
    for (std::size_t tenth = 1; tenth < 10; ++tenth)
        EXPECT_THAT(refusal(whole.substr(0, whole.size() * tenth / 10)), HasSubstr("truncated"));
    EXPECT_THAT(refusal(whole.substr(0, whole.size() - 2)), HasSubstr("truncated"));
}

// A camera's JPEG has a small JPEG in its header, whose end is not the picture's.
TEST_F(ImageTest, the_end_of_a_thumbnail_is_not_the_end_of_the_picture) {
    std::string whole = encoded(".jpg", gradient(60, 40));
    const std::string thumbnail = encoded(".jpg", gradient(8, 8));
    const std::size_t length = thumbnail.size() + 2;
    whole.insert(2, std::string("\xff\xe1") + static_cast<char>(length / 256) + static_cast<char>(length % 256) + thumbnail);
    EXPECT_EQ(refusal(whole), "accepted");
    EXPECT_THAT(refusal(whole.substr(0, whole.size() * 3 / 4)), HasSubstr("truncated"));
}

TEST_F(ImageTest, what_is_no_picture_is_refused_with_advice) {
    EXPECT_THAT(refusal("fantascope: show\n"), AllOf(HasSubstr("not a picture"), HasSubstr("save it again as a PNG")));
    EXPECT_THAT(readGrey(folder_ / "none.png").error().message(), HasSubstr("none.png: cannot be read: No such file"));
    std::filesystem::create_directory(folder_ / "folder.png");
    EXPECT_THAT(readRgba(folder_ / "folder.png").error().message(), HasSubstr("is a folder"));
    EXPECT_THAT(refusal(encoded(".png", cv::Mat::zeros(1, 16385, CV_8UC1))), HasSubstr("larger than 16384"));
    EXPECT_EQ(refusal(encoded(".png", cv::Mat::zeros(1, 16384, CV_8UC1))), "accepted");
}

// A picture of floating-point values may hold anything.
// Example failure: it returns the size of a thumbnail, or of something in another segment of the
// header.
TEST_F(ImageTest, a_pictures_size_stands_in_its_head) {
    const auto size = [&](const std::string& bytes) { return pictureSize(folder_.file("picture", bytes)); };
    const cv::Mat picture = gradient(300, 20);
    for (const char* ending : {".png", ".jpg"}) {
        const std::string bytes = encoded(ending, picture);
        EXPECT_EQ(size(bytes).value(), glm::ivec2(300, 20)) << ending;
        EXPECT_EQ(size(bytes.substr(0, 400)).value(), glm::ivec2(300, 20)) << ending << ": from its head alone";
        EXPECT_FALSE(size(bytes.substr(0, 10)));
    }
    // A segment that holds another JPEG.
    const std::string jpeg = encoded(".jpg", picture), thumbnail = encoded(".jpg", gradient(16, 8));
    const std::size_t length = thumbnail.size() + 2;
    const std::string segment = std::string("\xff\xe1") + char(length / 256) + char(length % 256) + thumbnail;
    EXPECT_EQ(size(jpeg.substr(0, 2) + segment + jpeg.substr(2)).value(), glm::ivec2(300, 20));
    EXPECT_THAT(size("no picture").error().message(), HasSubstr("picture: not a PNG or JPEG picture"));
    EXPECT_THAT(pictureSize(folder_ / "absent").error().message(), HasSubstr("absent: cannot be read"));
}

// Many pixels from few bytes: only a header, of every format, that claims more than a decoder could
// allocate.
// Example failure: a file of two megabytes takes three gigabytes before it is refused.
TEST_F(ImageTest, too_many_pixels_are_refused_before_they_are_decoded) {
    const auto number = [](std::uint32_t value, bool isBig) {
        std::string bytes;
        for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> 8 * (isBig ? 3 - i : i));
        return bytes;
    };
    const auto little = [&](std::uint32_t value) { return number(value, false); };
    const auto big = [&](std::uint32_t value) { return number(value, true); };
    const auto half = [](std::uint32_t value) { return std::string{char(value), char(value >> 8)}; };
    const auto tiff = [&](std::uint32_t width, std::uint32_t height) {
        return std::string("II*\0", 4) + little(8) + half(2) + half(256) + half(4) + little(1) + little(width) + half(257) +
               half(4) + little(1) + little(height);
    };
    const auto png = [&](std::uint32_t width, std::uint32_t height) {
        return std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16) + big(width) + big(height) + std::string("\x08\0\0\0\0IEND", 9);
    };
    const std::string kPixels = "30000 x 30000 pixels: a picture may not be larger than 16384";
    const std::string heads[] = {
        png(30000, 30000), tiff(30000, 30000),
        "BM" + std::string(12, '\0') + little(40) + little(30000) + little(static_cast<std::uint32_t>(-30000)),
        std::string("RIFF\x20\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\x2f\x75\0\x2f\x75\0", 30),
        std::string("\xff\xd8\xff\xff\xc0\0\x11\x08\x75\x30\x75\x30\x03", 13) + std::string(9, '\0') + "\xff\xd9"};
    for (const std::string& head : heads) EXPECT_THAT(refusal(head), HasSubstr(kPixels)) << head.substr(0, 4);
    EXPECT_THAT(refusal(png(16384, 4097)), HasSubstr("16384 x 4097 pixels")) << "each dimension is small enough, all is not";
    EXPECT_THAT(refusal(png(0xffffffff, 0xffffffff)), HasSubstr("4294967295 x 4294967295 pixels"));
}

// The size in the header is the decoded size.
TEST_F(ImageTest, every_kind_of_picture_is_read) {
    const cv::Mat picture = gradient(33, 20);
    for (const char* ending : {".png", ".jpg", ".tiff", ".bmp", ".webp"}) {
        const GreyImage read = grey(encoded(ending, picture));
        EXPECT_EQ(glm::ivec2(read.width(), read.height()), glm::ivec2(33, 20)) << ending;
        EXPECT_EQ(pictureSize(folder_.file("a", encoded(ending, picture))).value(), glm::ivec2(33, 20)) << ending;
    }
}

TEST_F(ImageTest, what_is_no_regular_file_is_refused_at_once) {
    ASSERT_EQ(::mkfifo((folder_ / "pipe.png").c_str(), 0600), 0);
    EXPECT_THAT(readGrey(folder_ / "pipe.png").error().message(), HasSubstr("is a pipe, a file is needed"));
    EXPECT_THAT(readRgba("/dev/zero").error().message(), HasSubstr("is a device, a file is needed"));
    const auto huge = folder_.file("huge.png", "");
    std::filesystem::resize_file(huge, std::uintmax_t{1} << 40);
    EXPECT_THAT(readRgba(huge).error().message(), HasSubstr("not a picture")) << "nothing is read of what is none";
    folder_.file("huge.png", encoded(".png", gradient(4, 4)));
    std::filesystem::resize_file(huge, std::uintmax_t{1} << 40);
    EXPECT_THAT(readRgba(huge).error().message(), HasSubstr("is too large"));
}

// Example failure: red and blue are exchanged on every key of the pad.
TEST_F(ImageTest, a_jpeg_has_the_picture_as_it_was_but_for_its_loss) {
    RgbaImage image(32, 16, {200, 40, 0, 255});
    for (int x = 16; x < 32; ++x)
        for (int y = 0; y < 16; ++y) image.at(x, y) = {0, 60, 220, 255};
    const std::vector<std::uint8_t> bytes = jpegOf(image, 95);
    EXPECT_EQ(bytes, jpegOf(image, 95));
    EXPECT_LT(jpegOf(image, 10).size(), bytes.size());
    const cv::Mat read = cv::imdecode(bytes, cv::IMREAD_COLOR);
    ASSERT_EQ(read.size(), cv::Size(32, 16));
    for (const int x : {4, 28})
        for (const int y : {3, 12}) {
            const auto pixel = read.at<cv::Vec3b>(y, x);
            const Rgba8 was = image.at(x, y);
            EXPECT_NEAR(pixel[0], was.b, 8);
            EXPECT_NEAR(pixel[1], was.g, 8);
            EXPECT_NEAR(pixel[2], was.r, 8);
        }
}

TEST_F(ImageTest, values_that_are_no_numbers_are_refused) {
    cv::Mat picture(2, 2, CV_32FC1, cv::Scalar(0.5));
    EXPECT_THAT(grey(encoded(".tiff", picture)).pixels(), Each(0.5f));
    picture.at<float>(1, 1) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_THAT(refusal(encoded(".tiff", picture)), HasSubstr("not a number"));
}

TEST_F(ImageTest, a_picture_that_cannot_be_written_leaves_nothing_behind) {
    folder_.file("file", "x");
    EXPECT_THAT(writePng(folder_ / "file/a.png", GreyImage(2, 2)).error().message(), HasSubstr("cannot be written"));
    EXPECT_THAT(folder_.names(), testing::ElementsAre("file"));
}

TEST(Srgb, is_its_own_inverse_and_meets_the_standard) {
    for (int step = 0; step <= 1000; ++step) {
        const float stored = static_cast<float>(step) / 1000;
        EXPECT_NEAR(srgbFromLinear(linearFromSrgb(stored)), stored, 2e-6);
    }
    EXPECT_EQ(linearFromSrgb(0), 0);
    EXPECT_FLOAT_EQ(linearFromSrgb(1), 1);
    EXPECT_NEAR(linearFromSrgb(0.5f), 0.21404114, 1e-7);
    EXPECT_NEAR(linearFromSrgb(0.04f), 0.04 / 12.92, 1e-9) << "the straight part near black";
}

TEST(Resized, averages_when_it_shrinks_and_keeps_even_pictures_even) {
    GreyImage image(4, 2);
    std::ranges::copy(std::array{0.0f, 1.0f, 0.5f, 0.5f, 1.0f, 0.0f, 1.0f, 1.0f}, image.pixels().begin());
    EXPECT_THAT(resized(image, 2, 1).pixels(), testing::ElementsAre(0.5f, 0.75f));
    EXPECT_THAT(resized(GreyImage(5, 3, 0.25f), 17, 11).pixels(), Each(testing::FloatNear(0.25f, 1e-6f)));
    EXPECT_THAT(resized(RgbaImage(9, 6, {10, 20, 30, 40}), 3, 2).pixels(), Each(Rgba8{10, 20, 30, 40}));
}

// Compared with the definition: the light of each stored value times the share of the target pixel
// that it covers.
// Example failure: stored values are averaged, so that a fine pattern is half as bright as on the
// wall.
TEST(ResizedLight, is_the_area_average_of_the_light) {
    RgbaImage image(53, 31);
    Rng rng(5);
    for (Rgba8& pixel : image.pixels()) {
        const auto value = [&] { return static_cast<std::uint8_t>(rng.uniform() < 0.5 ? 0 : rng.uniform(0, 256)); };
        pixel = {value(), value(), value(), 255};
    }
    for (const auto& [width, height] : {std::pair{16, 9}, {53, 8}, {7, 31}, {1, 1}}) {
        const RgbaImage small = resizedLight(image, width, height);
        ASSERT_EQ(small.width(), width);
        ASSERT_EQ(small.height(), height);
        const double across = 53.0 / width, down = 31.0 / height;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                std::array<double, 3> light{};
                for (int v = 0; v < 31; ++v)
                    for (int u = 0; u < 53; ++u) {
                        const double share =
                            std::max(0.0, std::min(u + 1.0, (x + 1) * across) - std::max<double>(u, x * across)) *
                            std::max(0.0, std::min(v + 1.0, (y + 1) * down) - std::max<double>(v, y * down)) / (across * down);
                        const Rgba8 pixel = image.at(u, v);
                        for (const auto& [sum, stored] :
                             {std::pair(&light[0], pixel.r), {&light[1], pixel.g}, {&light[2], pixel.b}})
                            *sum += share * linearFromSrgb(static_cast<float>(stored) / 255);
                    }
                const Rgba8 pixel = small.at(x, y);
                for (const auto& [wanted, stored] : {std::pair(light[0], pixel.r), {light[1], pixel.g}, {light[2], pixel.b}})
                    EXPECT_NEAR(255 * srgbFromLinear(static_cast<float>(wanted)), stored, 1) << width << " " << x << "," << y;
                EXPECT_EQ(pixel.a, 255);
            }
    }
}

TEST(Blurred, spreads_light_as_a_gaussian_and_loses_none) {
    constexpr int kSize = 61, kCentre = 30;
    constexpr double kSigma = 3;
    GreyImage dot(kSize, kSize);
    dot.at(kCentre, kCentre) = 1;
    const GreyImage image = blurred(dot, kSigma);
    double sum = 0, variance = 0;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            sum += image.at(x, y);
            variance += image.at(x, y) * (x - kCentre) * (x - kCentre);
        }
    EXPECT_NEAR(sum, 1, 1e-5);
    EXPECT_NEAR(std::sqrt(variance), kSigma, 0.01);
    EXPECT_THAT(blurred(GreyImage(10, 10, 0.5f), kSigma).pixels(), Each(testing::FloatNear(0.5f, 1e-6f)))
        << "the border repeats the edge";
}

}  // namespace
}  // namespace fantascope
