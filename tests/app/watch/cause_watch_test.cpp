// What the watch says of the camera's picture itself.

#include "app/watch/cause_watch.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <functional>

namespace fantascope::app {
namespace {

using testing::HasSubstr;

constexpr glm::ivec2 kSize(64, 36);

RgbaImage noisy(std::uint8_t seed, glm::ivec2 size = kSize) {
    RgbaImage picture(size.x, size.y);
    for (std::size_t i = 0; i < picture.pixels().size(); ++i) {
        const auto value = static_cast<std::uint8_t>((i * 37 + seed * 11) % 97);
        picture.pixels()[i] = {value, value, value, 255};
    }
    return picture;
}
RgbaImage flat(std::uint8_t value) { return {kSize.x, kSize.y, Rgba8{value, value, value, 255}}; }

// A watch of a site whose outputs the camera does not see.
struct Rig {
    show::Site site;
    vision::WallWatch wall{{std::nullopt}, kSize};
    CauseLog causes;
    show::EventLog events;
    show::EventLog::Reader reader = events.reader();
    std::optional<CauseWatch> watch;
    Time now{};

    Rig() {
        site.outputs.resize(1);
        site.outputs[0].name = "left";
        site.nominalCamera.emplace();
        site.nominalCamera->size = kSize;
        watch.emplace(site, wall, causes, events);
    }
    bool see(const RgbaImage& picture, bool isLit = true) {
        now += std::chrono::milliseconds(200);
        return watch->isUsable(picture, isLit, now);
    }
    std::string told() {
        std::string told;
        while (const show::Event* event = reader.next()) told += sentenceOf(*event) + "\n";
        return told;
    }
};

struct Trouble {
    std::string cause, advice;
    std::function<RgbaImage(int)> picture;
};
const std::vector<Trouble> kTroubles{
    {"camera blind", "cap", [](int) { return flat(0); }},
    {"camera blind", "exposure", [](int) { return flat(255); }},
    {"camera frozen", "plug", [](int) { return noisy(1); }},
    {"camera of another size", "32 x 18",
     [](int i) {
         return noisy(static_cast<std::uint8_t>(i), {32, 18});
     }},
    {"camera saturated", "shorter exposure",
     [](int i) {
         RgbaImage picture = noisy(static_cast<std::uint8_t>(i));
         std::fill_n(picture.pixels().begin(), picture.pixels().size() * 2 / 3, Rgba8{255, 255, 255, 255});
         return picture;
     }},
};

TEST(CauseWatch, tells_each_trouble_of_the_camera_apart) {
    for (const Trouble& trouble : kTroubles) {
        Rig rig;
        for (int i = 0; i < 10; ++i) EXPECT_TRUE(rig.see(noisy(static_cast<std::uint8_t>(100 + i))));
        for (int i = 0; i < 12; ++i) rig.see(trouble.picture(i));
        EXPECT_FALSE(rig.see(trouble.picture(12))) << trouble.cause;
        ASSERT_EQ(rig.causes.all().size(), 1u) << trouble.cause;
        EXPECT_EQ(rig.causes.all()[0].cause, trouble.cause);
        EXPECT_FALSE(rig.causes.all()[0].to);
        EXPECT_THAT(rig.told(), HasSubstr(trouble.advice)) << trouble.cause;
        for (int i = 0; i < 20; ++i) EXPECT_TRUE(rig.see(noisy(static_cast<std::uint8_t>(150 + i)))) << trouble.cause;
        EXPECT_TRUE(rig.causes.all()[0].to) << trouble.cause;
        EXPECT_THAT(rig.told(), HasSubstr("over"));
    }
}

// Example failure: in a blackout on a dark night the camera counts as blind.
TEST(CauseWatch, expects_nothing_of_a_dark_wall) {
    Rig rig;
    for (int i = 0; i < 20; ++i) EXPECT_FALSE(rig.see(flat(0), false));
    for (int i = 0; i < 20; ++i) rig.see(noisy(7), false);
    EXPECT_EQ(rig.told(), "");
    for (int i = 0; i < 20; ++i) rig.see(flat(255), false);
    EXPECT_THAT(rig.told(), HasSubstr("camera blind")) << "it is not dark at all";
}

// A camera that sends a picture twice, or a flash, is no fault.
TEST(CauseWatch, does_not_name_what_does_not_last) {
    Rig rig;
    for (int i = 0; i < 40; ++i) {
        rig.see(noisy(static_cast<std::uint8_t>(i)));
        if (i % 10 == 0) {
            EXPECT_FALSE(rig.see(noisy(static_cast<std::uint8_t>(i)))) << "the same again";
        }
        if (i % 17 == 0) {
            EXPECT_FALSE(rig.see(flat(255)));
        }
    }
    EXPECT_TRUE(rig.causes.all().empty());
    EXPECT_EQ(rig.told(), "");
}

TEST(CauseWatch, says_that_the_camera_is_gone_until_it_is_back) {
    Rig rig;
    rig.see(noisy(1));
    const Time last = rig.now;
    rig.watch->wait(last, std::chrono::milliseconds(100), last + std::chrono::seconds(2));
    rig.watch->wait(last, std::chrono::seconds(5), last + std::chrono::seconds(14));
    EXPECT_TRUE(rig.causes.all().empty()) << "one of the cameras is slow";
    for (int i = 0; i < 50; ++i)
        rig.watch->wait(last, Time{}, rig.now = last + std::chrono::seconds(4) + i * std::chrono::milliseconds(20));
    ASSERT_EQ(rig.causes.all().size(), 1u);
    EXPECT_EQ(rig.causes.all()[0].cause, "camera gone");
    for (int i = 0; i < 20; ++i) rig.see(noisy(static_cast<std::uint8_t>(i)));
    EXPECT_TRUE(rig.causes.all()[0].to);
    EXPECT_THAT(rig.told(), HasSubstr("look at its plug"));
}

}  // namespace
}  // namespace fantascope::app
