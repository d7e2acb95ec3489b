#include "app/watch/lamp_watch.h"

#include "show/site/light_channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace fantascope::app {
namespace {

constexpr float kSteady = 0.05f;  // of a level
constexpr Time kForgotten = std::chrono::minutes(3);
constexpr double kMostContrast = 0.1;  // beside the usual: more is fog, or the camera's exposure
constexpr double kLeastExplained = 0.85;
constexpr double kMostSaturatedLight = 0.05;  // of the bright places
constexpr float kWorthTelling = 0.2f;         // of the share

// Whether an output's light on the wall says how much other light there is.
bool tells(const vision::OutputLight& light) {
    return std::abs(light.contrast - 1) <= kMostContrast && light.explained >= kLeastExplained &&
           light.saturated <= kMostSaturatedLight;
}

}  // namespace

std::vector<LampWatch::Lamp> LampWatch::lampsOf(const show::Site& site) {
    const show::Corrections::Lamps& settings = site.corrections.lamps;
    std::vector<Lamp> lamps;
    for (std::size_t i = 0; i < site.fixtures.size(); ++i) {
        const show::Fixture& fixture = site.fixtures[i];
        Lamp lamp;
        lamp.isDimmed = std::ranges::find(settings.fixtures, i) != settings.fixtures.end();
        std::vector<std::size_t> colours;
        for (std::size_t channel = 0; channel < fixture.channels.size(); ++channel) {
            if (show::isColour(fixture.channels[channel]))
                colours.push_back(site.firstLevel(i) + channel);
            else if (show::scalesLight(fixture, channel))
                lamp.intensity = site.firstLevel(i) + channel;
        }
        if (colours.empty() && lamp.intensity) lamps.push_back(lamp);
        for (const std::size_t colour : colours) lamps.push_back(lamp), lamps.back().colour = colour;
    }
    for (std::size_t i = 0; i < site.relays.size(); ++i) {
        Lamp lamp;
        lamp.relay = i;
        const auto found = std::ranges::find(settings.relays, i);
        if (found != settings.relays.end()) lamp.offFrom = static_cast<int>(found - settings.relays.begin());
        lamps.push_back(lamp);
    }
    return lamps;
}

LampWatch::LampWatch(const show::Site& site, show::InputLog& inputs, show::EventLog& events)
    : site_(site),
      settings_(site.corrections.lamps),
      inputs_(inputs),
      events_(events),
      reader_(events.reader()),
      lamps_(lampsOf(site)),
      total_(site.outputs.size(), 0),
      loop_({settings_.least, settings_.speed}) {
    for (std::size_t i = 0; i < site.outputs.size(); ++i) light_.emplace_back(lamps_.size());
}

void LampWatch::note(const show::ShowState& shown) {
    if (shown.levels.size() != site_.channelCount() || shown.relays.size() != site_.relays.size()) return;  // nothing yet
    Moment moment{{}, shown.lamps};
    std::vector<float> others = shown.levels;  // without those of lamps
    for (const Lamp& lamp : lamps_) {
        if (lamp.relay) {
            moment.asked.push_back(shown.relays[*lamp.relay] != 0 ? 1.0f : 0.0f);
            continue;
        }
        moment.asked.push_back((lamp.intensity ? shown.levels[*lamp.intensity] : 1) *
                               (lamp.colour ? shown.levels[*lamp.colour] : 1));
        for (const auto& level : {lamp.intensity, lamp.colour})
            if (level) others[*level] = 0;
    }
    if (others != std::exchange(otherLevels_, others))
        for (vision::AmbientLight& light : light_) light.forgetBase();
    std::vector<std::uint8_t> relays;
    for (std::size_t i = 0; i < settings_.relays.size(); ++i)
        relays.push_back(static_cast<int>(i) < shown.lamps.relaysOff ? 0 : shown.relays[settings_.relays[i]]);
    if (relays != std::exchange(relays_, relays) || !switched_) switched_ = shown.time;
    corrects_ = shown.corrects;
    isDark_ = shown.blackout || shown.panic;
    if (!corrects_) goal_ = told_ = {};
    goal_.relaysOff = shown.lamps.relaysOff;  // a blackout gives them back
    moments_.note(shown.time, std::move(moment));
}

std::vector<float> LampWatch::given(const Moment& moment) const {
    std::vector<float> levels = moment.asked;
    for (std::size_t i = 0; i < lamps_.size(); ++i) {
        if (lamps_[i].isDimmed) levels[i] *= moment.trim.share;
        if (lamps_[i].offFrom && *lamps_[i].offFrom < moment.trim.relaysOff) levels[i] = 0;
    }
    return levels;
}

// Whether no lamp changed quickly about the time when a picture was exposed, as far as is known.
bool LampWatch::isSteady(Time exposed) const {
    return moments_.isSteady(exposed, [&](const Moment& one, const Moment& other) {
        return std::ranges::equal(given(one), given(other),
                                  [](float level, float then) { return std::abs(level - then) <= kSteady; });
    });
}

// Which universes a desk sends, too.
void LampWatch::listen() {
    while (const show::Event* const event = reader_.next()) {
        const auto* const change = std::get_if<show::event::SendersChanged>(&event->what);
        if (change == nullptr) continue;
        const bool isOurs = change->senders.size() == 1 && change->senders.front().empty();
        if (std::ranges::find(site_.fixtures, change->universe, &show::Fixture::universe) == site_.fixtures.end()) continue;
        if (!isOurs)
            foreign_.insert(change->universe);
        else if (foreign_.erase(change->universe) > 0)
            for (vision::AmbientLight& light : light_) light.forgetBase();
    }
}

void LampWatch::explain(vision::WallLight& light, Time exposed) const {
    if (moments_.empty()) return;
    for (std::size_t i = 0; i < light_.size(); ++i)
        if (light.outputs[i] && light_[i].isKnown())
            light.outputs[i]->otherLight = light_[i].excessOf(light.outputs[i]->allOtherLight, moments_.at(exposed).asked);
}

void LampWatch::see(const vision::WallLight& light, bool isClear, Time exposed, Time now) {
    listen();
    if (!isClear || !foreign_.empty() || isDark_ || moments_.empty() || !isSteady(exposed)) return;
    const Moment& then = moments_.at(exposed);
    const std::vector<float> levels = given(then);
    bool isTold = false;
    for (std::size_t i = 0; i < light_.size(); ++i) {
        if (!light.outputs[i] || !tells(*light.outputs[i])) continue;
        total_[i] = light.outputs[i]->allOtherLight;
        if (light_[i].see(total_[i], levels, then.asked, exposed) && light_[i].isKnown()) isTold = true;
    }
    if (!isTold) return;
    measured_ = now;
    const TrimSight sight = sightAt(then, exposed, now);
    series_.push_back({exposed, sight.excess, sight.ambient.mean, then.trim});
    if (settings_.mode != show::Corrections::Mode::Automatic) return advise(sight, now);
    if (!corrects_) return;
    const show::LampTrim next = loop_.step(sight, goal_);
    if (next == goal_) return;
    const bool isLess = next.share < goal_.share || next.relaysOff > goal_.relaysOff;
    want(next,
         isLess ? fmt::format("ambient light on the pictures has risen by {:.1f} % of full light", 100 * ambient().mean)
                : "ambient light on the pictures is less again",
         now);
}

// The rise of ambient light, as the mean over the outputs.
vision::AmbientLight::Light LampWatch::ambient() const {
    return meanOf([](const vision::AmbientLight& light) { return light.rise(); });
}

// The light of all lamps at these levels, as the mean over the outputs.
vision::AmbientLight::Light LampWatch::lightOf(const std::vector<float>& levels) const {
    return meanOf([&](const vision::AmbientLight& light) { return light.of(levels); });
}

// The mean over the outputs of which it is known what is usual.
template <class Light>
vision::AmbientLight::Light LampWatch::meanOf(const Light& lightOf) const {
    vision::AmbientLight::Light mean;
    int count = 0;
    for (const vision::AmbientLight& light : light_) {
        if (!light.isKnown()) continue;
        const vision::AmbientLight::Light of = lightOf(light);
        mean.mean += of.mean;
        mean.sigma += of.sigma;
        ++count;
    }
    return {mean.mean / std::max(1, count), mean.sigma / std::max(1, count)};
}

TrimSight LampWatch::sightAt(const Moment& then, Time exposed, Time now) const {
    std::vector<float> less = given(then), dimmed(lamps_.size(), 0), full(lamps_.size(), 0);
    for (std::size_t i = 0; i < less.size(); ++i) {
        less[i] -= then.asked[i];
        if (lamps_[i].isDimmed) dimmed[i] = then.asked[i], full[i] = 1;
    }
    TrimSight sight{.at = exposed, .ambient = ambient(), .share = then.trim.share};
    sight.excess = sight.ambient.mean + lightOf(less).mean;
    int known = 0;
    for (std::size_t i = 0; i < light_.size(); ++i)
        if (light_[i].isKnown()) sight.total += total_[i], ++known;
    sight.total /= std::max(1, known);
    sight.fixtures = lightOf(dimmed);
    sight.full = lightOf(full);
    const auto relay = [&](int number) -> std::optional<TrimSight::Light> {
        const auto isIt = [&](const Lamp& lamp) { return lamp.offFrom == number; };
        const auto found = std::ranges::find_if(lamps_, isIt);
        if (found == lamps_.end()) return std::nullopt;
        const auto index = static_cast<std::size_t>(found - lamps_.begin());
        std::vector<float> alone(lamps_.size(), 0);
        alone[index] = then.asked[index];
        return lightOf(alone);
    };
    sight.next = relay(goal_.relaysOff);
    sight.last = relay(goal_.relaysOff - 1);
    sight.maySwitch = switched_ && now - *switched_ >= settings_.hold;
    return sight;
}

void LampWatch::advise(const TrimSight& sight, Time now) {
    const double band = TrimLoop::deadBandOf(sight);
    const bool isWorthIt = TrimLoop::isWorthIt(sight) || !settings_.relays.empty();
    if (sight.excess < band / 2) isAdvised_ = false;
    if (sight.excess <= band || !isWorthIt || std::exchange(isAdvised_, true)) return;
    events_.append(
        {now, show::event::LampsTrimmed{
                  fmt::format("ambient light on the pictures has risen by {:.1f} % of full light", 100 * ambient().mean),
                  1,
                  {},
                  false}});
}

void LampWatch::want(const show::LampTrim& trim, const std::string& why, Time now) {
    const show::Input input{.at = now, .kind = show::Input::Kind::Trim, .source = show::Input::Source::Camera, .trim = trim};
    if (inputs_.submit(input).outcome != show::Outcome::Taken) return;
    goal_ = trim;
    const bool isNews = std::abs(trim.share - told_.share) >= kWorthTelling || (trim.share == 1) != (told_.share == 1) ||
                        trim.relaysOff != told_.relaysOff;
    if (isNews) tell(trim, why, now);
}

void LampWatch::tell(const show::LampTrim& trim, const std::string& why, Time now) {
    told_ = trim;
    std::vector<std::string> off;
    for (int i = 0; i < trim.relaysOff; ++i) off.push_back(site_.relays[settings_.relays[static_cast<std::size_t>(i)]].name);
    events_.append({now, show::event::LampsTrimmed{why, trim.share, std::move(off), true}});
}

void LampWatch::tick(Time now) {
    if (!measured_ || now - *measured_ < kForgotten || goal_ == show::LampTrim{} || !corrects_) return;
    measured_ = now;  // tried again as long afterwards if a relay must stay for now
    want({}, "the camera has not told for three minutes how much light there is", now);
}

}  // namespace fantascope::app
