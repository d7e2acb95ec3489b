// Patterns that are fitted to the wall on which they are shown.

#include "app/watch/pattern_correction.h"

#include "pattern/search_helpers.h"
#include "vision/watched_wall.h"

#include <gmock/gmock.h>

#include <variant>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::IsEmpty;
using testing::SizeIs;
using Mode = show::Corrections::Mode;

constexpr show::SourceId kDrawing{0};

vision::ProjectedWall plainWall() {
    vision::ProjectedWall wall = vision::slantedWall();
    wall.camera = *vision::CameraModel::fromFieldOfView(*Pose::lookingAt({0.8, 1.7, 7}, {0, 1.5, 0}), {320, 180}, 0.9, 0, 0);
    wall.blur = 1;
    return wall;
}
vision::ProjectedWall stainedWall() {
    vision::ProjectedWall wall = plainWall();
    wall.reflectance = [](double x, double y) { return std::hypot(x - 0.1, y - 1.5) < 0.7 ? 0.25 : 0.6; };
    return wall;
}

GreyImage disc() {
    GreyImage guide(320, 180);
    for (int y = 0; y < 180; ++y)
        for (int x = 0; x < 320; ++x)
            guide.at(x, y) = static_cast<float>(std::clamp(1.2 - std::hypot((x - 160) / 120.0, (y - 90) / 70.0), 0.0, 0.6));
    return guide;
}

// The disc's pattern on the whole picture of a projector, whose wall a calibration found to be
// even.
PatternOnWall discOnWall(glm::ivec2 projector) {
    pattern::PatternSearch::Options options;
    options.instances = 400;
    options.iterations = 100;
    auto found = pattern::withShapes({"leaf"});
    found.compare = pattern::CompareSpace::Light;
    found = pattern::PatternSearch::run(disc(), found, options, 1, pattern::never).pattern;
    vision::CanvasSurface::Part part{0, GreyImage(160, 90, 0.5f), Image<glm::vec2>(160, 90)};
    for (int y = 0; y < 90; ++y)
        for (int x = 0; x < 160; ++x) part.pixel.at(x, y) = (glm::vec2(x, y) + 0.5f) * glm::vec2(projector) / glm::vec2(160, 90);
    return {kDrawing, "drawing", std::make_shared<const pattern::ShapePattern>(std::move(found)), disc(), {{std::move(part)}}};
}

show::CueList oneCue() {
    show::CueList list;
    show::CueList::Cue cue;
    cue.look.outputs = {show::OutputState{{show::LayerState{kDrawing, 1.0f}}}};
    list.cues = {cue};
    list.dark.outputs = {show::OutputState{}};
    list.exchangeFade = 5s;
    return list;
}

// A show of leaves on a wall that is not as the calibration saw it.
struct Night {
    explicit Night(Mode mode, const vision::ProjectedWall& now = stainedWall())
        : wall(now), watch({vision::watchedOn(plainWall())}, wall.camera.size) {
        show::Corrections::Pattern bounds;
        bounds.mode = mode;
        std::vector<PatternOnWall> patterns;
        patterns.push_back(discOnWall(wall.projector.size));
        patternOfShow = patterns[0].pattern;
        correction.emplace(
            bounds, std::move(patterns), true,
            [this](show::SourceId source, int number, const render::PatternSource& pattern) {
                EXPECT_EQ(source, kDrawing);
                EXPECT_NE(pattern.rests, nullptr);
                ready.emplace_back(number, exchanges().size());
            },
            inputs, events);
    }
    // One picture a second.
    void see(int count, bool isTrusted = true) {
        for (int i = 0; i < count; ++i, ++pictures) {
            const RgbaImage shown = vision::leaves(wall.projector.size, 220, 300 + pictures % 5);
            const GreyImage light = watch.lightOf(0, shown);
            watch.look(vision::storedOf(wall.seen(shown, rng)), {&light});
            state.corrects = corrects;
            correction->see(watch, {isTrusted}, state, std::chrono::seconds(pictures));
        }
    }
    std::vector<show::LoggedInput> exchanges() const {
        std::vector<show::LoggedInput> logged;
        auto reader = inputs.reader();
        while (const show::LoggedInput* input = reader.next())
            if (input->input.kind == show::Input::Kind::Exchange) logged.push_back(*input);
        return logged;
    }
    std::vector<show::event::PatternFitted> news() const {
        std::vector<show::event::PatternFitted> news;
        auto reader = events.reader();
        while (const show::Event* event = reader.next())
            if (const auto* fitted = std::get_if<show::event::PatternFitted>(&event->what)) news.push_back(*fitted);
        return news;
    }
    void toggle() {
        inputs.submit({.at = std::chrono::seconds(pictures), .kind = show::Input::Kind::Corrections});
        corrects = !corrects;
    }

    vision::ProjectedWall wall;
    vision::WallWatch watch;
    show::InputLog inputs{oneCue()};
    show::EventLog events;
    show::ShowState state;
    bool corrects = true;
    Rng rng{5};
    std::uint64_t pictures = 0;
    std::shared_ptr<const pattern::ShapePattern> patternOfShow;
    std::vector<std::pair<int, std::size_t>> ready;  // what was made ready, and how many exchanges had come before
    std::optional<PatternCorrection> correction;
};

// Example failures: the exchange comes before the renderer is ready, or twice; on a wall that did
// not change since, the search goes on and on.
TEST(PatternCorrection, exchanges_the_pattern_once_for_a_wall_that_has_changed) {
    constexpr int kDecided = PatternCorrection::kEnough + PatternCorrection::kSearch;
    Night night(Mode::Automatic);
    night.see(kDecided - 1);
    EXPECT_THAT(night.ready, IsEmpty());
    night.see(1);
    ASSERT_THAT(night.ready, SizeIs(1));
    EXPECT_THAT(night.exchanges(), IsEmpty()) << "the renderer has a second to get ready";
    night.see(1);
    ASSERT_THAT(night.exchanges(), SizeIs(1));
    const show::LoggedInput exchange = night.exchanges()[0];
    EXPECT_EQ(exchange.outcome, show::Outcome::Taken);
    EXPECT_EQ(exchange.input.revision, 1);
    EXPECT_EQ(exchange.input.which, 0);
    EXPECT_EQ(exchange.input.source, show::Input::Source::Camera);
    EXPECT_EQ(exchange.input.at, std::chrono::seconds(kDecided));
    ASSERT_THAT(night.news(), SizeIs(1));
    EXPECT_TRUE(night.news()[0].applied);
    EXPECT_LT(night.news()[0].toneAfter, 0.7 * night.news()[0].toneBefore);

    night.see(50);
    EXPECT_THAT(night.exchanges(), SizeIs(1));
    night.toggle();
    night.see(2);
    EXPECT_THAT(night.exchanges(), SizeIs(1));
    night.toggle();
    night.see(1);
    ASSERT_THAT(night.exchanges(), SizeIs(2)) << "what was taken back comes again";
    EXPECT_EQ(night.exchanges()[1].input.revision, 1);
    EXPECT_EQ(night.exchanges()[1].outcome, show::Outcome::Taken);
}

TEST(PatternCorrection, only_says_what_would_be_won_if_it_is_asked_for_advice) {
    Night night(Mode::Advise);
    night.see(45);
    EXPECT_THAT(night.exchanges(), IsEmpty());
    EXPECT_THAT(night.ready, IsEmpty());
    ASSERT_THAT(night.news(), SizeIs(1));
    EXPECT_FALSE(night.news()[0].applied);
}

// Example failure: what the search had left undone counts as the wall's fault.
TEST(PatternCorrection, leaves_the_pattern_alone_on_a_wall_that_is_as_it_was) {
    Night night(Mode::Automatic, plainWall());
    night.see(45);
    EXPECT_THAT(night.ready, IsEmpty());
    EXPECT_THAT(night.news(), IsEmpty());
}

TEST(PatternCorrection, does_nothing_while_the_wall_is_not_trusted_nor_after_setting_up) {
    Night night(Mode::Automatic);
    night.see(42, false);
    EXPECT_THAT(night.ready, IsEmpty());
    night.see(35);  // a search runs
    night.correction->end();
    night.see(12);
    EXPECT_THAT(night.ready, IsEmpty());
    EXPECT_THAT(night.exchanges(), IsEmpty());
}

}  // namespace
}  // namespace fantascope::app
