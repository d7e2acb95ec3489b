#include "app/check/oddities.h"

#include "pattern/shape/shape_pattern.h"
#include "show/names.h"

#include "core/config/config.h"
#include "core/fit.h"
#include "core/wall_clock.h"

#include <fmt/format.h>
#include <glm/vec2.hpp>

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

namespace fantascope::app {
namespace {

// "1.78 : 1"
std::string shape(double aspect) { return fmt::format("{:.2f} : 1", aspect); }

// What happens to a source's picture on a canvas of another shape.
std::string fitAdvice(const show::Source& source, double aspect, const show::Output& output) {
    constexpr std::string_view kWhat[] = {"all of it is seen, with dark beside it (fit: contain)",
                                          "what hangs over the canvas is cut off (fit: cover)",
                                          "it is stretched, circles become ellipses (fit: stretch)"};
    return source.at
        .error(fmt::format("its picture is {}, and the canvas '{}' is {}: {}", shape(aspect), output.canvas,
                           shape(output.projection.canvasAspect), kWhat[static_cast<std::size_t>(source.fit)]))
        .message();
}

// What happens to pictures on a canvas whose shape on the wall is unknown.
std::string unknownShape(const show::Site& site, const show::Output& output) {
    return fmt::format(
        "{}: the corners of '{}' do not tell the shape of the canvas '{}' on the wall: every picture fills it. Measure it and "
        "write 'canvas_size: [WIDTH, HEIGHT]' in metres, so that circles stay round",
        site.file.string(), output.name, output.canvas);
}

// A source whose pixels are more than twice those that the canvas has: it costs time and memory,
// and shows no more. Empty: it is not so.
std::string sizeAdvice(const ShapedSource& shown, const show::Output& output) {
    constexpr double kTooMany = 2;
    const double rows = output.projection.warp.canvasRows(output.projection.canvasAspect);
    if (shown.rows <= kTooMany * rows) return "";
    return shown.source->at
        .error(fmt::format("its picture has {:.0f} rows, and the canvas '{}' {:.0f}: a smaller one looks the same and costs less",
                           shown.rows, output.canvas, rows))
        .message();
}

// Cues of a list that GO never reaches, or that are followed before they begin.
void noteUnreached(const std::vector<show::Cue>& cues, std::optional<std::size_t> start, bool loops, const std::string& file,
                   std::vector<std::string>& oddities) {
    for (std::size_t cue = 0; cue < cues.size(); ++cue) {
        const show::Cue& each = cues[cue];
        if (start && cue < *start && !loops)
            oddities.push_back(fmt::format("{}: the show starts with '{}', so GO never reaches the cue '{}' before it", file,
                                           cues[*start].name, each.name));
        Time begins = each.wait;
        for (const show::CuePart& part : each.parts) begins = std::min(begins, part.wait.value_or(each.wait));
        if (const auto follow = each.soonestFollow(); follow && *follow <= begins && begins > Time{})
            oddities.push_back(
                fmt::format("{}: the cue '{}' waits {:g} s, and the next one follows after {:g} s: nothing of it is seen", file,
                            each.name, seconds(begins), seconds(*follow)));
    }
}

}  // namespace

void noteShapes(const show::CueList& cues, const show::BySource<ShapedSource>& shaped, const show::Site& site,
                std::vector<std::string>& oddities) {
    std::set<std::pair<show::SourceId, std::string>> told;
    std::set<std::string> unknown;
    std::vector<show::CueList::Cue> all = cues.cues;
    for (const auto& side : cues.sides) all.insert(all.end(), side->cues.begin(), side->cues.end());
    for (const auto& cue : all)
        for (std::size_t i = 0; i < site.outputs.size(); ++i)
            for (const show::LayerState& layer : cue.look.outputs[i].layers) {
                const show::Output& output = site.outputs[i];
                const ShapedSource* const shown = shaped.find(layer.source);
                const double canvas = output.projection.canvasAspect;
                if (shown == nullptr) continue;
                if (canvas == 0) {
                    if (unknown.insert(output.canvas).second) oddities.push_back(unknownShape(site, output));
                    continue;
                }
                if (!told.insert({layer.source, output.canvas}).second) continue;
                if (!isSameShape(shown->aspect, canvas)) oddities.push_back(fitAdvice(*shown->source, shown->aspect, output));
                if (std::string advice = sizeAdvice(*shown, output); !advice.empty()) oddities.push_back(std::move(advice));
            }
}

void noteNegatives(const show::Source& source, std::vector<std::string>& oddities) {
    const auto* foliage = std::get_if<show::FoliageSource>(&source.picture);
    if (foliage == nullptr) return;
    for (const show::FoliageSource::Layer& layer : foliage->layers) {
        const auto pattern = pattern::readPattern(layer.pattern);
        if (!pattern) continue;  // its own line says why
        const bool madeForShadows = pattern->guide.filename().string().ends_with(".shadows.png");
        if (madeForShadows != layer.holes) continue;
        const std::string file = layer.pattern.filename().string();
        oddities.push_back(
            source.at
                .error(layer.holes
                           ? fmt::format("the holes of {} stand where the drawing is dark, so that its negative is seen; make "
                                         "them without --shadows: 'fantascope pattern GUIDE -o {}'",
                                         file, file)
                           : fmt::format("the leaves of {} stand where the drawing is white, so that its negative is seen; make "
                                         "them with 'fantascope pattern GUIDE -o {} --shadows'",
                                         file, file))
                .message());
    }
}

namespace {

// What a look asks of how a source plays, and the source does not do.
void noteStills(const show::Show& show, std::vector<std::string>& oddities) {
    for (const show::NamedLook& look : show.looks)
        for (const show::NamedLook::Play& play : look.plays) {
            const show::Source& source = *std::ranges::find(show.sources, play.source, &show::Source::id);
            const auto& kind = source.picture;
            const bool isStill = std::holds_alternative<show::SolidSource>(kind) ||
                                 std::holds_alternative<show::ImageSource>(kind) ||
                                 std::holds_alternative<show::CameraSource>(kind);
            const bool begins =
                std::holds_alternative<show::VideoSource>(kind) || std::holds_alternative<show::ShadowSource>(kind);
            const std::string where = fmt::format("{}: the look '{}'", show.file.string(), look.name);
            if (play.speed && isStill)
                oddities.push_back(fmt::format("{} gives '{}' a speed, but it does not move", where, source.name));
            if (play.restarts && !begins)
                oddities.push_back(fmt::format("{} lets '{}' begin again, but only videos and shadows do", where, source.name));
        }
}

}  // namespace

void noteUnseen(const show::Show& show, std::vector<std::string>& oddities) {
    const std::string file = show.file.string();
    noteStills(show, oddities);
    const auto has = [](const std::vector<show::Cue>& cues, std::size_t look) {
        return std::ranges::find(cues, look, &show::Cue::look) != cues.end();
    };
    for (std::size_t look = 0; look < show.looks.size(); ++look)
        if (!has(show.cues, look) &&
            std::ranges::none_of(show.sides, [&](const show::SideList& side) { return has(side.cues, look); }))
            oddities.push_back(fmt::format("{}: no cue has the look '{}'", file, show.looks[look].name));
    const auto isIn = [&](const show::Source& source, const show::NamedLook& look) {
        return std::ranges::any_of(look.outputs, [&](const auto& output) {
            return std::ranges::find(output.wish.layers.layers, source.id, &show::LayerState::source) !=
                   output.wish.layers.layers.end();
        });
    };
    for (const show::Source& source : show.sources)
        if (std::ranges::none_of(show.looks, [&](const show::NamedLook& look) { return isIn(source, look); }))
            oddities.push_back(source.at.error("no look shows this source").message());
    noteUnreached(show.cues, show.start, show.loops, file, oddities);
    for (const show::SideList& side : show.sides) noteUnreached(side.cues, side.start, side.loops, file, oddities);
}

void noteUnnamed(const show::Show& show, const show::Site& site, std::vector<std::string>& oddities) {
    std::vector<std::string> unnamed;
    const auto isNamed = [&](const auto& list, std::string_view name) {
        return std::ranges::any_of(show.looks, [&](const show::NamedLook& look) {
            return std::ranges::any_of(look.*list, [&](const auto& named) { return named.name == name; });
        });
    };
    for (const show::Output& output : site.outputs)
        if (!isNamed(&show::NamedLook::outputs, output.name) && !isNamed(&show::NamedLook::outputs, output.canvas))
            unnamed.push_back(fmt::format("output '{}'", output.name));
    for (const show::Fixture& fixture : site.fixtures)
        if (!isNamed(&show::NamedLook::fixtures, fixture.name)) unnamed.push_back(fmt::format("fixture '{}'", fixture.name));
    for (const show::Relay& relay : site.relays)
        if (!isNamed(&show::NamedLook::relays, relay.name)) unnamed.push_back(fmt::format("relay '{}'", relay.name));
    if (!unnamed.empty())
        oddities.push_back(fmt::format("{}: no look names these things of {}: {}; they stay dark, and relays safe",
                                       show.file.string(), site.file.string(), listed(unnamed)));
}

void noteLists(const show::Show& show, const show::Site& site, std::vector<std::string>& oddities) {
    const std::vector<std::string> sides = show::namesOf(show.sides);
    const auto note = [&](const std::string& thing, const std::string& list) {
        if (show::listNamed(list, sides) < 0)
            oddities.push_back(fmt::format("{}: {} is for the list '{}', which {} does not have: it does nothing",
                                           site.file.string(), thing, list, show.file.string()));
    };
    for (const show::SiteButton& button : site.buttons)
        note(fmt::format("button {} ({})", button.number, show::nameOf(button.button)), button.list);
    for (const show::Contact& contact : site.contacts) note(fmt::format("contact '{}'", contact.name), contact.list);
}

void noteGaps(const show::Site& site, std::vector<std::string>& oddities) {
    std::set<std::string> seen;
    for (const show::Output& output : site.outputs) {
        if (!seen.insert(output.canvas).second) continue;
        std::vector<CanvasPart> parts;
        std::set<double> across{0, 1}, down{0, 1};
        for (const std::size_t other : site.outputsOn(output.canvas)) {
            parts.push_back(site.outputs[other].projection.warp.shown());
            across.insert({parts.back().low.x, parts.back().high.x});
            down.insert({parts.back().low.y, parts.back().high.y});
        }
        // Between two neighbouring edges a place is in the same parts as all others there.
        for (auto x = across.begin(); std::next(x) != across.end(); ++x)
            for (auto y = down.begin(); std::next(y) != down.end(); ++y) {
                const glm::dvec2 low(*x, *y), high(*std::next(x), *std::next(y)), middle = 0.5 * (low + high);
                const bool isShown = std::ranges::any_of(parts, [&](const CanvasPart& part) {
                    return middle.x > part.low.x && middle.x < part.high.x && middle.y > part.low.y && middle.y < part.high.y;
                });
                if (!isShown)
                    oddities.push_back(
                        fmt::format("{}: no output shows the place [{:g}, {:g}, {:g}, {:g}] of the canvas '{}'; its "
                                    "parts leave a gap",
                                    site.file.string(), low.x, low.y, high.x, high.y, output.canvas));
            }
    }
}

void noteNights(const show::Show& show, const show::Nights& nights, std::vector<std::string>& oddities) {
    if (nights.nextFrom(nights.nightAt(SystemWallClock().now().utc))) return;
    oddities.push_back(show.schedule->at.error("nothing plays within a year; 'fantascope schedule' says why").message());
}

void noteSimulated(const show::Site& site, std::vector<std::string>& oddities) {
    std::vector<const show::DeviceConfig*> devices;
    for (const show::Universe& universe : site.universes) {
        devices.push_back(&universe.port);
        if (universe.desk) devices.push_back(&universe.desk->device);
    }
    for (const auto* banks : {&site.relayBanks, &site.contactBanks})
        for (const show::Bank& bank : *banks) devices.push_back(&bank.device);
    for (const auto* device : {&site.cueController, &site.camera})
        if (*device) devices.push_back(&**device);
    const auto isReal = [](const show::DeviceConfig* device) { return device->driver != "simulated"; };
    if (std::none_of(devices.begin(), devices.end(), isReal)) return;
    for (const show::DeviceConfig* device : devices)
        if (!isReal(device))
            oddities.push_back(
                device->options.error("is simulated beside real devices: it can be rehearsed, and 'run' refuses it").message());
}

}  // namespace fantascope::app
