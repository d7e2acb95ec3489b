// A show that is saved while it plays: what is on the wall, and what the operator is told.

#include "app/reload/show_reload.h"

#include "app/live/frame_loop.h"
#include "app/live/programme.h"
#include "app/running_show.h"

#include "pattern/shape/elemental_shape.h"
#include "pattern/shape/shape_pattern.h"
#include "show/replaced.h"

#include "scratch_folder.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fantascope::app {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kShow = R"(fantascope: show
version: 2
title: Workshop
blackout_fade: 1
sources: {paint: {solid: [1, 0, 0]}, poster: {image: poster.png}}
looks: {colour: {outputs: {wall: [{source: paint}]}}, picture: {outputs: {wall: [{source: poster}]}}}
cues:
  - {name: Colour, look: colour, fade: 0}
  - {name: Picture, look: picture, fade: 0}
)";

constexpr const char* kSite = R"(fantascope: site
version: 1
outputs: [{name: wall, display: {driver: headless}, size: [32, 18], refresh_rate: 20}]
)";

RgbaImage filled(Rgba8 colour) { return RgbaImage(16, 9, colour); }

class SavedShow : public testing::Test {
protected:
    SavedShow() {
        folder_.file("show.yaml", kShow);
        folder_.file("site.yaml", kSite);
        EXPECT_TRUE(writePng(folder_ / "poster.png", filled({0, 0, 255})));
        auto site = valueOf(show::readSite(folder_ / "site.yaml"));
        revision_ = valueOf(show::Revision::of(valueOf(show::Show::load(folder_ / "show.yaml", names_)), site));
        played_.emplace(revision_);
        inputs_.emplace(show::Revision::cuesOf(revision_));
        render::PictureSources sources;
        for (const show::Source& source : revision_->show.sources) sources.add(source.id, valueOf(read(source)));
        devices_.emplace(valueOf(openDevices(revision_->site, Backends::SimulatedHeadless, {clock_, &world_})));
        loop_.emplace(revision_->site, *inputs_, sources, sourceFolder() + "/assets", *devices_, clock_);
        shown_ = &loop_->tap(0).addQueue();
        EXPECT_TRUE(loop_->prepare());
        const show::ShowClock showClock(clock_.now());
        loop_->begin(showClock);
        const auto adopt = [this](std::vector<Projection> projections) { adopted_ = std::move(projections); };
        const auto readSite = [](const std::filesystem::path& file) { return show::readSite(file); };
        reload_.emplace(*played_, names_, ShowReload::Files{read, readSite, adopt}, loop_->sources(), *inputs_, events_,
                        showClock);
    }
    static Result<render::PictureSource> read(const show::Source& source) {
        return readPictureSource(source, render::VideoStream::Pace::Exact, nullptr);
    }
    void go() { inputs_->submit({.at = clock_.now()}); }
    void save(std::string_view what, std::string_view by) {
        text_ = replaced(text_, what, by);
        // Nobody saves twice within a tick of the file system's clock, but a test may.
        const auto file = folder_.file("show.yaml", text_);
        std::filesystem::last_write_time(file, std::filesystem::last_write_time(file) + std::chrono::seconds(++saves_));
    }
    // Frames, and the part's ticks between them.
    void pass(Time time) {
        for (const Time end = clock_.now() + time; clock_.now() < end; ++frames_) {
            loop_->step();
            if (frames_ % 5 == 0) reload_->tick(clock_.now());
            while (const render::ShownFrame* const frame = shown_->next(Time::max())) picture_ = frame->image;
            wall_ = picture_.at(16, 9);
        }
    }
    std::vector<std::string> told() {
        std::vector<std::string> lines;
        while (const show::Event* const event = told_.next()) lines.push_back(folder_.relative(show::sentenceOf(*event)));
        return lines;
    }

    const ScratchFolder folder_;
    std::string text_ = kShow;
    show::SourceNames names_;
    std::shared_ptr<const show::Revision> revision_;
    std::optional<show::PlayedShow> played_;
    std::optional<show::InputLog> inputs_;
    show::EventLog events_;
    show::EventLog::Reader told_ = events_.reader();
    ManualClock clock_;
    site::World world_{clock_};
    std::optional<Devices> devices_;
    std::optional<FrameLoop> loop_;
    render::FrameReader* shown_ = nullptr;
    std::optional<ShowReload> reload_;
    std::vector<Projection> adopted_;
    // The mean red of the wall's right half.
    double rightHalf() const {
        double sum = 0;
        for (int y = 0; y < picture_.height(); ++y)
            for (int x = picture_.width() / 2; x < picture_.width(); ++x) sum += picture_.at(x, y).r;
        return 2 * sum / (picture_.width() * picture_.height());
    }

    RgbaImage picture_;
    Rgba8 wall_;  // in its middle
    int frames_ = 0, saves_ = 0;
};

// Example failures: the new colour is there at once; the cue begins again; the source of before
// stays for ever.
TEST_F(SavedShow, fades_to_what_is_new) {
    go();
    pass(1s);
    EXPECT_EQ(wall_, (Rgba8{255, 0, 0}));
    save("[1, 0, 0]", "[0, 1, 0]");
    bool wasBetween = false;
    for (int i = 0; i < 40; ++i) {
        pass(50ms);
        wasBetween = wasBetween || (wall_.r > 60 && wall_.r < 250 && wall_.g > 60 && wall_.g < 250);
    }
    EXPECT_TRUE(wasBetween);
    EXPECT_EQ(wall_, (Rgba8{0, 255, 0}));
    EXPECT_EQ(loop_->framesLate(), 0);
    EXPECT_THAT(told(), ElementsAre("show.yaml was saved: the show goes on with it"));
    EXPECT_EQ(loop_->sources().all()->size(), 2u) << "nothing needs the old colour";
    pass(7s);
    go();
    pass(1s);
    EXPECT_EQ(wall_, (Rgba8{0, 0, 255}));
}

TEST_F(SavedShow, takes_a_picture_that_was_painted_over) {
    go();
    go();
    pass(1s);
    inputs_->submit({.at = clock_.now(), .kind = show::Input::Kind::Jump, .cue = 1});
    pass(1s);
    EXPECT_EQ(wall_, (Rgba8{0, 0, 255}));
    ASSERT_TRUE(writePng(folder_ / "poster.png", filled({255, 255, 0})));
    pass(3s);
    EXPECT_EQ(wall_, (Rgba8{255, 255, 0}));
    EXPECT_THAT(told(), ElementsAre("poster.png was saved: the show goes on with it"));
}

TEST_F(SavedShow, is_refused_with_its_place_and_taken_once_it_is_mended) {
    go();
    pass(1s);
    save("solid: [1, 0, 0]", "solid: [0, 9, 0]");
    pass(2s);
    EXPECT_EQ(wall_, (Rgba8{255, 0, 0}));
    const auto refused = told();
    ASSERT_EQ(refused.size(), 1u);
    EXPECT_THAT(refused[0], HasSubstr("show.yaml was saved, but the show goes on as it was: show.yaml:5:"));
    save("[0, 9, 0]", "[0, 1, 0]");
    pass(3s);
    EXPECT_EQ(wall_, (Rgba8{0, 255, 0}));
    // A picture that is none, and names that the site lacks.
    folder_.file("poster.png", "no picture");
    pass(1s);
    EXPECT_THAT(told().back(), HasSubstr("poster.png was saved, but the show goes on as it was: "));
    EXPECT_TRUE(writePng(folder_ / "poster.png", filled({0, 0, 255})));
    pass(1s);
    save("{wall: [{source: paint}]}", "{wal: [{source: paint}]}");
    pass(1s);
    EXPECT_THAT(told().back(), HasSubstr("did you mean 'wall'?"));
    EXPECT_EQ(loop_->framesLate(), 0);
}

// A show is copied over the running one, and its pictures come last.
TEST_F(SavedShow, is_read_again_until_what_it_names_is_there) {
    go();
    pass(1s);
    save("{solid: [1, 0, 0]}", "{image: new.png}");
    pass(5s);
    const auto refused = told();
    ASSERT_EQ(refused.size(), 1u) << "it is told once";
    EXPECT_THAT(refused[0], HasSubstr("there is no file new.png"));
    ASSERT_TRUE(writePng(folder_ / "new.png", filled({0, 255, 0})));
    pass(5s);
    EXPECT_EQ(wall_, (Rgba8{0, 255, 0}));
}

// An artist draws on while the pattern is on the wall.
TEST_F(SavedShow, draws_a_pattern_again_whose_drawing_was_saved) {
    pattern::ShapePattern triangles;
    triangles.guide = folder_ / "drawing.png";
    triangles.compare = pattern::CompareSpace::Light;
    triangles.width = 64;
    triangles.height = 36;
    triangles.shapes = {valueOf(pattern::builtInShape("triangle"))};
    for (std::uint32_t i = 0; i < 12; ++i)
        triangles.instances.push_back({.id = i, .centre = {0.1 + 0.03 * i, 0.3 + 0.4 * (i % 2)}, .size = 0.1});
    RgbaImage drawing(64, 36, {0, 0, 0});
    const auto paint = [&](int from, int to) {
        for (int y = 0; y < 36; ++y) std::fill(drawing.row(y).begin() + from, drawing.row(y).begin() + to, Rgba8{200, 200, 200});
        EXPECT_TRUE(writePng(folder_ / "drawing.png", drawing));
    };
    paint(0, 24);
    EXPECT_TRUE(pattern::writePattern(folder_ / "drawing.pattern.yaml", triangles));
    save("{solid: [1, 0, 0]}", "{pattern: drawing.pattern.yaml}");
    pass(1s);
    go();
    pass(1s);
    EXPECT_LT(rightHalf(), 1);
    told();
    paint(0, 64);
    pass(3s);
    const auto lines = told();
    ASSERT_EQ(lines.size(), 1u);
    EXPECT_THAT(lines[0], HasSubstr("drawing.png was saved: the show goes on with it; paint is drawn again: "));
    EXPECT_GT(rightHalf(), 10) << "shapes have come there: " << lines[0];
    paint(0, 24);
    pass(3s);
    EXPECT_THAT(told().at(0), HasSubstr("paint is drawn again")) << "and again from there";
}

// What is needed later must not be taken away while nothing is seen.
// Example failure: the light comes back from a blackout in the middle of the fade, and the output
// has lost the source.
TEST_F(SavedShow, keeps_the_old_source_during_a_blackout_as_long_as_it_fades) {
    save("blackout_fade: 1", "blackout_fade: 10");
    pass(1s);
    go();
    pass(1s);
    save("[1, 0, 0]", "[0, 1, 0]");
    pass(1s);
    inputs_->submit({.at = clock_.now(), .kind = show::Input::Kind::Master, .level = 0});
    pass(9s);
    EXPECT_EQ(loop_->sources().all()->size(), 3u);
    inputs_->submit({.at = clock_.now(), .kind = show::Input::Kind::Master, .level = 1});
    pass(11s);
    EXPECT_EQ(wall_, (Rgba8{0, 255, 0}));
    EXPECT_EQ(loop_->sources().all()->size(), 2u);
    for (const DeviceStatus& status : loop_->withFaults(devices_->statuses())) EXPECT_EQ(status.detail, "");
}

TEST_F(SavedShow, cannot_have_other_lists) {
    save("cues:\n", "lists: {Bar: {cues: [{name: a, look: colour, fade: 0}]}}\ncues:\n");
    pass(1s);
    EXPECT_THAT(told(), ElementsAre("show.yaml was saved, but the show goes on as it was: it has other cue lists; end the show "
                                    "and begin it anew"));
}

// Example failures: a device that cannot be changed now is passed over in silence; corners that are
// the same as at the start are not taken, although they were others meanwhile.
TEST_F(SavedShow, takes_the_projections_of_a_site_and_tells_what_counts_later) {
    const std::string moved =
        replaced(kSite, "refresh_rate: 20", "refresh_rate: 20, corners: [[1, 0], [32, 0], [32, 18], [0, 18]]");
    folder_.file("site.yaml", replaced(moved, "version: 1", "version: 1 # a comment changes nothing"));
    pass(1s);
    EXPECT_THAT(told(), IsEmpty());
    ASSERT_EQ(adopted_.size(), 1u);
    EXPECT_EQ(adopted_[0].warp.shape().corners[0], glm::dvec2(1, 0));
    folder_.file("site.yaml", std::string(kSite) + "universes: [{number: 1, port: {driver: simulated}}]\n");
    pass(1s);
    EXPECT_THAT(told(), ElementsAre("site.yaml was saved: what it says of universes counts when the show begins anew"));
    EXPECT_EQ(adopted_[0].warp.shape().corners[0], glm::dvec2(0, 0));
    adopted_.clear();
    folder_.file("site.yaml", replaced(moved, "size: [32, 18]", "size: [64, 36]"));
    pass(1s);
    EXPECT_THAT(told(), ElementsAre("site.yaml was saved: what it says of outputs counts when the show begins anew"));
    EXPECT_THAT(adopted_, IsEmpty()) << "corners are pixels";
    folder_.file("site.yaml", replaced(kSite, "refresh_rate: 20", "refresh_rate: 25"));
    pass(1s);
    EXPECT_THAT(told(),
                ElementsAre("site.yaml was saved: what it says of outputs[0].refresh_rate counts when the show begins anew"));
    folder_.file("site.yaml", "fantascope: site\nversion: 1\noutput: 3\n");
    pass(1s);
    const auto refused = told();
    ASSERT_EQ(refused.size(), 1u);
    EXPECT_THAT(refused[0], HasSubstr("site.yaml:3:1: output: unknown key"));
    folder_.file("site.yaml", kSite);
    events_.append({0s, show::event::SiteSaved{folder_ / "site.yaml", folder_ / "site.yaml.previous"}});
    told();
    pass(1s);
    EXPECT_THAT(told(), IsEmpty()) << "the program has written it";
}

// Cues that come before others, or are taken out: names go with what is on.
TEST_F(SavedShow, tells_of_its_cues_by_their_new_names) {
    go();
    pass(1s);
    save("cues:\n", "cues:\n  - {name: Overture, look: picture, fade: 0}\n");
    pass(2s);
    show::PlaybackReplica replica(*inputs_);
    show::ShowState state;
    replica.stateAt(clock_.now(), state);
    EXPECT_EQ(state.revision, 1u);
    EXPECT_EQ(played_->at(state.revision).show.cues[static_cast<std::size_t>(state.cue)].name, "Colour");
    EXPECT_EQ(played_->at(0).show.cues.size(), 2u) << "what was played stays known";
}

}  // namespace
}  // namespace fantascope::app
