// How strong and sharp a picture on the wall is, and what other light there is, while a show runs.

#include "vision/watch/wall_watch.h"
#include "vision/watched_wall.h"

#include <gmock/gmock.h>

#include <array>
#include <functional>

namespace fantascope::vision {
namespace {

// A brick wall, a show of leaves on it, and the watch.
struct Night {
    ProjectedWall wall = brickWall();
    WallWatch watch{{watchedOn(wall)}, wall.camera.size};
    Rng rng{21};
    std::uint64_t pictures = 0;

    // Measures one picture. `defocus`: of the projector, its pixels. `disturb` changes what the
    // camera sees.
    WallLight measure(double defocus = 0, const std::function<void(GreyImage&)>& disturb = {}) {
        const RgbaImage shown = leaves(wall.projector.size, 160, 300 + ++pictures);
        GreyImage seen = wall.seen(defocus > 0 ? blurredFrame(shown, defocus) : shown, rng);
        if (disturb) disturb(seen);
        const GreyImage light = watch.lightOf(0, shown);
        watch.look(storedOf(seen), {&light});
        return watch.measureLight();
    }
    OutputLight output(double defocus = 0, const std::function<void(GreyImage&)>& disturb = {}) {
        const WallLight light = measure(defocus, disturb);
        EXPECT_TRUE(light.outputs[0]);
        return light.outputs[0].value_or(OutputLight{});
    }
    // Until it is known what is usual.
    void begin() {
        for (int i = 0; i < 8; ++i) measure();
    }
    RgbaImage blurredFrame(const RgbaImage& frame, double sigma) const {
        GreyImage light(frame.width(), frame.height());
        for (std::size_t i = 0; i < light.pixels().size(); ++i)
            light.pixels()[i] = static_cast<float>(std::pow(frame.pixels()[i].r / 255.0, wall.gamma));
        light = blurred(light, sigma);
        RgbaImage soft(frame.width(), frame.height());
        for (std::size_t i = 0; i < light.pixels().size(); ++i) {
            const auto stored = static_cast<std::uint8_t>(std::lround(255 * std::pow(light.pixels()[i], 1 / wall.gamma)));
            soft.pixels()[i] = {stored, stored, stored, 255};
        }
        return soft;
    }
};

TEST(WallLight, is_as_usual_while_nothing_changes) {
    Night night;
    EXPECT_FALSE(night.measure().outputs[0]) << "it is not known yet what is usual";
    night.begin();
    for (int i = 0; i < 4; ++i) {
        const OutputLight light = night.output();
        EXPECT_NEAR(light.contrast, 1, 0.05);
        EXPECT_LT(light.blur, 0.4);
        EXPECT_NEAR(light.otherLight, 0, 0.005);
        EXPECT_GT(light.asUsual, 0.95);
        EXPECT_LT(light.hidden, 0.02);
    }
}

TEST(WallLight, tells_how_strong_the_picture_is) {
    Night night;
    night.begin();
    for (const double share : {0.8, 0.5, 0.2}) {
        night.wall.strength = share * brickWall().strength;
        const OutputLight light = night.output();
        EXPECT_NEAR(light.contrast, share, 0.04);
        EXPECT_LT(light.blur, 0.5) << share;
        EXPECT_GT(light.explained, 0.95);
    }
    night.wall.strength = 0;
    EXPECT_LT(night.output().contrast, 0.05);
    EXPECT_LT(night.output().asUsual, 0.05);
    EXPECT_GT(night.output().explained, 0.95) << "nothing is there, and nothing else";
}

// The camera has 480 pixels for about 700 of the projector.
TEST(WallLight, tells_how_sharp_the_picture_is) {
    Night night;
    night.begin();
    double perPixel = 0;  // cells along a projector pixel
    for (const double defocus : {4.0, 7.0, 11.0}) {
        const OutputLight light = night.output(defocus);
        EXPECT_GT(light.blur, 1) << defocus;
        if (perPixel > 0) {
            EXPECT_NEAR(light.blur / defocus, perPixel, 0.15 * perPixel) << defocus;
        }
        perPixel = light.blur / defocus;
        EXPECT_NEAR(light.contrast, 1, 0.25) << defocus;
        EXPECT_FALSE(light.isCameraBlurred) << defocus;
    }
}

TEST(WallLight, sees_by_the_surface_whether_the_camera_blurs) {
    Night night;
    night.begin();
    night.wall.blur = 3;
    const OutputLight light = night.output();
    EXPECT_GT(light.blur, 1.5);
    EXPECT_TRUE(light.isCameraBlurred);
}

TEST(WallLight, tells_other_light_and_forgets_that_of_known_lamps) {
    Night night;
    night.begin();
    const double before = night.wall.ambient;
    night.wall.ambient = before + 0.04 * night.wall.strength;
    EXPECT_NEAR(night.output().otherLight, 0.04, 0.008);
    EXPECT_NEAR(night.output().contrast, 1, 0.05);
    // A lamp of the show: what was there before it stays told.
    night.watch.lampsChange(LampState{1});
    night.wall.ambient = before + 0.10 * night.wall.strength;
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(night.output().otherLight, 0.04, 0.01);
    night.wall.ambient = before + 0.06 * night.wall.strength;
    EXPECT_NEAR(night.output().otherLight, 0, 0.01);
}

// Example failure: what is usual is learned anew whenever the lamps change, from what was beside it
// at that moment, so the errors of a night add up.
TEST(WallLight, knows_the_lamps_again_after_many_cues) {
    Night night;
    night.begin();
    const double before = night.wall.ambient;
    Rng rng(5);
    for (int cue = 0; cue < 24; ++cue) {
        const std::uint8_t lamp = cue % 2;
        if (cue % 5 == 0) night.watch.lampsChange({});  // a fade
        night.watch.lampsChange(LampState{lamp});
        for (int i = 0; i < 3; ++i) {
            night.wall.ambient = before + (0.03 * lamp + 0.008 * rng.uniform()) * night.wall.strength;  // cars pass
            night.output();
        }
    }
    night.watch.lampsChange(LampState{0});
    night.wall.ambient = before;
    EXPECT_NEAR(night.output().otherLight, 0, 0.008);
    night.wall.ambient = before + 0.03 * night.wall.strength;
    EXPECT_NEAR(night.output().otherLight, 0.03, 0.008);
}

// Example failure: whoever passes counts as hiding the picture, or what hangs there does not.
TEST(WallLight, tells_what_hides_a_part_for_long) {
    Night night;
    night.begin();
    const auto cover = [](int left) {
        return [left](GreyImage& seen) {
            for (int y = 0; y < seen.height(); ++y)
                for (int x = left; x < std::min(left + 90, seen.width()); ++x) seen.at(x, y) = 0.01f;
        };
    };
    for (int i = 0; i < 8; ++i) {
        const OutputLight light = night.output(0, cover(60 * i));
        EXPECT_LT(light.hidden, 0.02) << "somebody passes";
    }
    OutputLight light;
    for (int i = 0; i < 8; ++i) light = night.output(0, cover(200));
    EXPECT_GT(light.hidden, 0.1);
    EXPECT_LT(light.hidden, 0.5);
    EXPECT_NEAR(light.contrast, 1, 0.08);
    EXPECT_NEAR(light.asUsual, 1 - light.hidden, 0.1);
}

// A picture of about 80 camera pixels across, and a post before it. Example failure: blocks have as
// many cells as in a large picture, so each is too much of it.
TEST(WallLight, a_post_hides_little_of_a_small_picture) {
    for (const glm::ivec2 at : {glm::ivec2(60, 35), glm::ivec2(66, 25), glm::ivec2(75, 35)}) {
        ProjectedWall wall = brickWall();
        wall.camera = *CameraModel::fromFieldOfView(wall.camera.pose, {136, 76}, 0.9, -0.05, 0.01);
        Night night{wall};
        night.begin();
        OutputLight light;
        for (int i = 0; i < 8; ++i)
            light = night.output(0, [&](GreyImage& seen) {
                for (int y = at.y; y < at.y + 12; ++y)
                    for (int x = at.x; x < at.x + 4; ++x) seen.at(x, y) = 0.4f;
            });
        EXPECT_GT(light.hidden, 0) << at.x;
        EXPECT_LT(light.hidden, 0.05) << at.x;
    }
}

// Two pictures that overlap, before a small and soft camera. The neighbour's edge is dark while it
// is learned what is usual, and then bright. Example failure: the camera blurs it over what is
// beside it, and that counts as hidden.
TEST(WallLight, of_a_picture_does_not_depend_on_the_neighbours) {
    for (const double turn : {20.0, 24.0, 28.0}) {
        std::array<ProjectedWall, 2> walls{brickWall(), brickWall()};
        for (ProjectedWall& wall : walls) {
            wall.camera = *CameraModel::fromFieldOfView(wall.camera.pose, {200, 112}, 0.9, -0.05, 0.01);
            wall.blur = 1.2;
            wall.strength = 0.3;
        }
        walls[1].projector = bumped(walls[1].projector, {0, turn, 0});
        walls[1].ambient = 0;
        walls[1].strength = 0.9;
        WallWatch watch({watchedOn(walls[0]), watchedOn(walls[1])}, walls[0].camera.size);
        const glm::ivec2 size = walls[0].projector.size;
        Rng rng(31);
        double asUsual = 0;
        constexpr std::uint64_t kDark = 8, kBright = 8;  // pictures
        for (std::uint64_t picture = 0; picture < kDark + kBright; ++picture) {
            std::array<RgbaImage, 2> shown{leaves(size, 60, 700 + picture), leaves(size, 60, 800 + picture)};
            const std::uint8_t edge = picture < kDark ? 0 : 255;
            for (int y = 0; y < size.y; ++y)
                for (int x = 0; x < size.x / 4; ++x) shown[1].at(x, y) = {edge, edge, edge, 255};
            GreyImage seen = walls[0].seen(shown[0], rng);
            const GreyImage other = walls[1].seen(shown[1], rng);
            for (std::size_t p = 0; p < seen.pixels().size(); ++p) seen.pixels()[p] += other.pixels()[p];
            const std::array<GreyImage, 2> lights{watch.lightOf(0, shown[0]), watch.lightOf(1, shown[1])};
            watch.look(storedOf(seen), {&lights[0], &lights[1]});
            const auto light = watch.measureLight().outputs[0];
            if (picture < kDark) continue;
            ASSERT_TRUE(light) << turn;
            EXPECT_EQ(light->hidden, 0) << turn;
            asUsual += light->asUsual / kBright;
        }
        EXPECT_GT(asUsual, 0.95) << turn;
    }
}

TEST(WallLight, tells_another_picture_from_none) {
    Night night;
    night.begin();
    const RgbaImage other = leaves(night.wall.projector.size, 160, 999);
    const OutputLight light = [&] {
        const RgbaImage shown = leaves(night.wall.projector.size, 160, 500);
        const GreyImage expected = night.watch.lightOf(0, shown);
        night.watch.look(storedOf(night.wall.seen(other, night.rng)), {&expected});
        return night.watch.measureLight().outputs[0].value_or(OutputLight{});
    }();
    EXPECT_LT(light.contrast, 0.2);
    EXPECT_LT(light.explained, 0.6);
}

TEST(WallLight, sees_that_the_picture_is_upside_down) {
    Night night;
    night.begin();
    EXPECT_FALSE(night.watch.isUpsideDown());
    night.measure(0, [](GreyImage& seen) { std::ranges::reverse(seen.pixels()); });
    EXPECT_TRUE(night.watch.isUpsideDown());
    night.measure(0, [](GreyImage& seen) { std::ranges::fill(seen.pixels(), 0.01f); });
    EXPECT_FALSE(night.watch.isUpsideDown());
}

TEST(Surroundings, tell_a_veil_from_a_change_of_all_light) {
    GreyImage mask(320, 160, 1), usual(320, 160);
    for (int y = 0; y < usual.height(); ++y)
        for (int x = 0; x < usual.width(); ++x) {
            usual.at(x, y) = 0.01f + 0.02f * static_cast<float>(x) / 320;
            if (x < 100) mask.at(x, y) = 0;
        }
    const auto after = [&](const std::function<float(float)>& change) {
        Surroundings surroundings(mask);
        while (surroundings.isLearning()) EXPECT_FALSE(surroundings.measure(usual));
        GreyImage now = usual;
        for (int y = 0; y < now.height(); ++y)
            for (int x = 0; x < now.width(); ++x) {
                now.at(x, y) = change(now.at(x, y));
                if (x < 100) now.at(x, y) = 1;                // a picture
                if (x > 150 && x < 200) now.at(x, y) = 0.3f;  // a headlight
            }
        return *surroundings.measure(now);
    };
    const SurroundingsLight same = after([](float light) { return light; }),
                            brighter = after([](float light) { return 3 * light; }),
                            hazy = after([](float light) { return light + 0.02f; });
    EXPECT_NEAR(same.gain, 1, 0.01);
    EXPECT_NEAR(same.veil, 0, 0.0002);
    EXPECT_NEAR(brighter.gain, 3, 0.05);
    EXPECT_NEAR(brighter.veil, 0, 0.002);
    EXPECT_NEAR(brighter.level, 3, 0.05);
    EXPECT_NEAR(hazy.gain, 1, 0.05);
    EXPECT_NEAR(hazy.veil, 0.02, 0.002);
    EXPECT_FALSE(Surroundings(GreyImage(320, 160, 0)).measure(usual));
}

// A dark night: the patches differ less than the camera's noise. Example failure: the noise makes
// the line flatter, and a usual night looks like a change of exposure and a veil.
TEST(Surroundings, are_as_usual_in_the_noise_of_a_dark_night) {
    Rng rng(3);
    const auto picture = [&] {
        constexpr int kSide = 16;
        GreyImage picture(320, 160);
        for (int top = 0; top < picture.height(); top += kSide)
            for (int left = 0; left < picture.width(); left += kSide) {
                const double light = 0.004 + 0.001 * left / 320 + 0.0003 * rng.normal();
                for (int y = top; y < top + kSide; ++y)
                    for (int x = left; x < left + kSide; ++x) picture.at(x, y) = static_cast<float>(light);
            }
        return picture;
    };
    double gain = 0;
    constexpr int kNights = 20;
    for (int night = 0; night < kNights; ++night) {
        Surroundings surroundings(GreyImage(320, 160, 1));
        while (surroundings.isLearning()) surroundings.measure(picture());
        const SurroundingsLight same = *surroundings.measure(picture());
        EXPECT_NEAR(same.level, 1, 0.02);
        gain += same.gain / kNights;
    }
    EXPECT_NEAR(gain, 1, 0.2);
}

// Example failure: once a lamp of the show has changed, a camera that was too dark before counts as
// usual.
TEST(Surroundings, keep_what_was_amiss_before_the_lamps_changed) {
    const auto pictureOf = [](float factor, float lamp) {
        GreyImage picture(320, 160);
        for (int y = 0; y < picture.height(); ++y)
            for (int x = 0; x < picture.width(); ++x)
                picture.at(x, y) = factor * (0.01f + 0.02f * static_cast<float>(x) / 320 + lamp * static_cast<float>(y) / 160);
        return picture;
    };
    Surroundings surroundings(GreyImage(320, 160, 1));
    while (surroundings.isLearning()) surroundings.measure(pictureOf(1, 0));
    EXPECT_NEAR(surroundings.measure(pictureOf(0.5f, 0))->gain, 0.5, 0.01);
    surroundings.lampsChange(LampState{1});
    while (surroundings.isLearning()) EXPECT_FALSE(surroundings.measure(pictureOf(0.5f, 0.02f)));
    EXPECT_NEAR(surroundings.measure(pictureOf(0.5f, 0.02f))->gain, 0.5, 0.02);
    EXPECT_NEAR(surroundings.measure(pictureOf(1, 0.02f))->gain, 1, 0.02);
}

// Example failure: what is usual around the pictures drifts away, cue by cue.
TEST(Surroundings, are_known_again_after_many_cues) {
    Rng rng(8);
    const auto picture = [&](float lamp) {
        const float passing = static_cast<float>(1 + 0.03 * rng.normal());  // clouds, and cars
        GreyImage picture(320, 160);
        for (int y = 0; y < picture.height(); ++y)
            for (int x = 0; x < picture.width(); ++x)
                picture.at(x, y) = passing * (0.01f + 0.02f * static_cast<float>(x) / 320 + lamp * static_cast<float>(y) / 160);
        return picture;
    };
    Surroundings surroundings(GreyImage(320, 160, 1));
    surroundings.lampsChange(LampState{0});
    while (surroundings.isLearning()) surroundings.measure(picture(0));
    for (std::uint8_t cue = 1; cue < 100; ++cue) {
        surroundings.lampsChange(LampState{static_cast<std::uint8_t>(cue % 3)});
        for (int i = 0; i < 4; ++i) surroundings.measure(picture(0.01f * (cue % 3)));
    }
    surroundings.lampsChange(LampState{0});
    EXPECT_FALSE(surroundings.isLearning());
    double level = 0;
    for (int i = 0; i < 100; ++i) level += surroundings.measure(picture(0))->level / 100;
    EXPECT_NEAR(level, 1, 0.08);
}

}  // namespace
}  // namespace fantascope::vision
