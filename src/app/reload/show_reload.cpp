#include "app/reload/show_reload.h"

#include "app/reload/redrawn_pattern.h"
#include "app/reload/site_changes.h"

#include "core/config/config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace fantascope::app {

namespace {

namespace fs = std::filesystem;

// "show.yaml, rain.mp4"
std::string namesOf(const std::set<fs::path>& files) {
    std::vector<std::string> names;
    for (const fs::path& file : files) names.push_back(file.filename().string());
    return fmt::format("{}", fmt::join(names, ", "));
}

const show::Source* sourceNamed(const std::string& name, const show::Show& show) {
    const auto found = std::ranges::find(show.sources, name, &show::Source::name);
    return found == show.sources.end() ? nullptr : &*found;
}

}  // namespace

ShowReload::ShowReload(show::PlayedShow& show, const show::SourceNames& names, Files files, SourceStock& stock,
                       show::InputLog& inputs, show::EventLog& events, const show::ShowClock& showClock)
    : show_(show),
      run_(std::move(files)),
      stock_(stock),
      inputs_(inputs),
      events_(events),
      showClock_(showClock),
      names_(names),
      sources_(stock.all()) {
    readPatterns();
    watchFiles();
}

void ShowReload::watchFiles() {
    const show::Revision& now = show_.newest();
    Paths files{now.show.file, now.site.file};
    for (const show::Source& source : now.show.sources)
        for (const fs::path& file : show::filesOf(source)) files.insert(file);
    for (const auto& [name, pattern] : patterns_) files.insert(pattern->guide);
    files_.watch(files);
}

// Notes the patterns that are shown, for their drawings.
void ShowReload::readPatterns() {
    for (const show::Source& source : show_.newest().show.sources)
        if (const auto* const drawn = std::get_if<render::PatternSource>(&sources_->find(source.id)->picture))
            patterns_[source.name] = drawn->pattern;
}

void ShowReload::tick(Time moment) {
    const Time showTime = showClock_.showTime(moment);
    stock_.release();
    if (waits_) {
        const auto outcome = stock_.outcome();
        if (!outcome) return;
        Reading reading = std::move(*waits_);
        waits_.reset();
        if (outcome->empty()) return takeOver(std::move(reading), showTime);
        stock_.ask(sources_);
        return refuse(reading.saved, *outcome, showTime);
    }
    Paths saved = files_.saved();
    if (saved.erase(show_.newest().site.file) > 0) readSite(showTime);
    if (refused_ && (!saved.empty() || showTime >= refused_->again)) saved.insert(refused_->saved.begin(), refused_->saved.end());
    if (saved.empty()) return;
    auto reading = read(saved);
    if (!reading) {
        const std::string why = reading.error().message();
        if (!refused_ || refused_->why != why) refuse(saved, why, showTime);
        refused_ = Refused{saved, why, showTime + kRetry};
        return;
    }
    refused_.reset();
    stock_.ask(reading->sources);
    waits_ = std::move(*reading);
}

// Reads the show. Sources that stand for another picture than in the revision that plays get other
// ids.
Result<show::Show> ShowReload::readShow(const Paths& saved, show::SourceNames& names) const {
    const show::Show& old = show_.newest().show;
    const show::Show read = TRY(show::Show::load(old.file, names));
    for (const show::Source& source : read.sources) {
        const show::Source* const before = sourceNamed(source.name, old);
        const auto isSaved = [&](const fs::path& file) { return saved.contains(file); };
        const bool isSame = before != nullptr && before->picture == source.picture && before->fit == source.fit &&
                            std::ranges::none_of(show::filesOf(source), isSaved) && !isRedrawn(source, saved);
        if (!isSame) names.renew(source.name);
    }
    return show::Show::load(old.file, names);
}

// Whether the drawing of a pattern was saved, and the pattern is the one that is shown.
bool ShowReload::isRedrawn(const show::Source& source, const Paths& saved) const {
    const auto shown = patterns_.find(source.name);
    const show::Source* const before = sourceNamed(source.name, show_.newest().show);
    const auto* const asked = std::get_if<show::PatternSource>(&source.picture);
    return shown != patterns_.end() && asked != nullptr && before != nullptr && before->picture == source.picture &&
           saved.contains(shown->second->guide) && !saved.contains(asked->file);
}

Result<render::PictureSource> ShowReload::readSource(const show::Source& source, const Paths& saved, Reading& reading) const {
    if (!isRedrawn(source, saved)) return run_.source(source);
    RedrawnPattern redrawn = TRY(RedrawnPattern::of(*patterns_.at(source.name)));
    reading.news += fmt::format("; {} is drawn again: {} shapes come, {} go, {} change", source.name, redrawn.made,
                                redrawn.removed, redrawn.changed);
    return render::PictureSource(std::move(redrawn.source), source.fit);
}

Result<ShowReload::Reading> ShowReload::read(const Paths& saved) {
    Reading reading{.revision = {}, .sources = {}, .names = names_, .saved = saved, .news = {}};
    const show::Revision& now = show_.newest();
    show::Show show = TRY(readShow(saved, reading.names));
    if (!std::ranges::equal(show.sides, now.show.sides, {}, &show::SideList::name, &show::SideList::name))
        return Error("it has other cue lists; end the show and begin it anew");
    render::PictureSources sources;
    ConfigFaults faults;
    for (const show::Source& source : show.sources)
        if (const render::PictureSource* const known = sources_->find(source.id))
            sources.add(source.id, *known);
        else
            faults.take(readSource(source, saved, reading),
                        [&](render::PictureSource picture) { sources.add(source.id, std::move(picture)); });
    TRY(faults.result());
    const show::PlayLengths lengths = render::playLengthsOf(sources);
    reading.revision = TRY(show::Revision::of(std::move(show), now.site, &lengths));
    reading.sources = std::make_shared<const render::PictureSources>(std::move(sources));
    return reading;
}

void ShowReload::takeOver(Reading reading, Time showTime) {
    const int number = inputs_.add(show::Revision::cuesOf(reading.revision));
    show::Outcome outcome{};
    const bool isTaken = show_.revise(reading.revision, [&] {
        outcome =
            inputs_
                .submit(
                    {.at = showTime, .kind = show::Input::Kind::Revise, .source = show::Input::Source::File, .revision = number})
                .outcome;
        return outcome == show::Outcome::Taken;
    });
    if (!isTaken) {
        stock_.ask(sources_);
        return refuse(reading.saved, std::string(show::nameOf(outcome)), showTime);
    }
    sources_ = std::move(reading.sources);
    names_ = std::move(reading.names);
    patterns_.clear();
    readPatterns();
    watchFiles();
    events_.append({showTime, show::event::ShowRevised{namesOf(reading.saved), std::move(reading.news)}});
}

void ShowReload::refuse(const Paths& files, const std::string& why, Time showTime) {
    events_.append({showTime, show::event::RevisionRefused{namesOf(files), why}});
}

void ShowReload::readSite(Time showTime) {
    bool isOurs = false;  // the program has written it
    while (const show::Event* const event = siteNews_.next())
        isOurs = isOurs || std::holds_alternative<show::event::SiteSaved>(event->what);
    const show::Site& began = show_.newest().site;
    if (isOurs) return;
    const auto saved = run_.site(began.file);
    if (!saved) return refuse({began.file}, saved.error().message(), showTime);
    const auto changes = changesOf(began, *saved);
    if (!changes) return refuse({began.file}, changes.error().message(), showTime);
    if (!changes->later.empty())
        events_.append({showTime, show::event::SiteChanged{began.file, fmt::format("{}", fmt::join(changes->later, ", "))}});
    if (!changes->hasSameOutputs) return;
    std::vector<Projection> projections;
    for (const show::Output& output : saved->outputs) projections.push_back(output.projection);
    run_.adopt(std::move(projections));
}

}  // namespace fantascope::app
