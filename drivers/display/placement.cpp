#include "drivers/display/placement.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

namespace fantascope::drivers {
namespace {

// Hz; rates that differ by less are the same.
constexpr double kSameHertz = 0.005;

bool sameRate(const Monitor::Mode& a, const Monitor::Mode& b) {
    return a.interlaced == b.interlaced && std::abs(a.hertz - b.hertz) <= kSameHertz;
}

// Of the modes of the requested size the one nearest to the requested rate; of equal ones the one
// that the monitor lists first. An interlaced mode, which combs moving edges, only if there is no
// other. Null: none.
const Monitor::Mode* bestMode(const Monitor& monitor, const MonitorClaim& claim) {
    const auto cost = [&](const Monitor::Mode& mode) {
        return std::pair(mode.interlaced, std::abs(mode.hertz - claim.refreshRate));
    };
    const Monitor::Mode* best = nullptr;
    for (const Monitor::Mode& mode : monitor.modes)
        if (mode.size == claim.size && (best == nullptr || (cost(mode) < cost(*best) && !sameRate(mode, *best)))) best = &mode;
    return best;
}

std::string sizesOf(const Monitor& monitor) {
    std::vector<std::string> sizes;
    for (const Monitor::Mode& mode : monitor.modes) {
        std::string size = fmt::format("[{}, {}]", mode.size.x, mode.size.y);
        if (std::find(sizes.begin(), sizes.end(), size) == sizes.end()) sizes.push_back(std::move(size));
    }
    return sizes.empty() ? "none" : listed(sizes);
}

std::string textsOf(const std::vector<const Monitor*>& monitors) {
    std::vector<std::string> texts;
    texts.reserve(monitors.size());
    for (const Monitor* monitor : monitors) texts.push_back(monitor->text());
    return texts.empty() ? "none" : listed(texts);
}

}  // namespace

// What one look() has assigned so far.
struct Placement::Round {
    const std::vector<Monitor>& monitors;
    glm::ivec2 largest;
    std::vector<std::pair<const Holder*, Area>> taken{};  // by outputs
    std::vector<Area> foreign{};                          // by monitors that no output claims
    Plan plan{};

    const Holder* inTheWayOf(const Area& area) const {
        const auto found =
            std::find_if(taken.begin(), taken.end(), [&](const auto& other) { return area.overlaps(other.second); });
        return found == taken.end() ? nullptr : found->first;
    }
};

int Placement::add(MonitorClaim claim) {
    holders_.push_back({.number = next_++, .claim = std::move(claim)});
    return holders_.back().number;
}

void Placement::remove(int claim) {
    std::erase_if(holders_, [&](const Holder& holder) { return holder.number == claim; });
}

std::map<int, Placement::Seat> Placement::seats() const {
    std::map<int, Seat> seats;
    for (const Holder& holder : holders_) seats[holder.number] = holder.seat;
    return seats;
}

void Placement::refused(int claim, const std::string& why) {
    for (Holder& holder : holders_)
        if (holder.number == claim) holder.failure = holder.seat.absence = why;
}

void Placement::retry() {
    for (Holder& holder : holders_) holder.tried.reset();
}

void Placement::restart() {
    for (Holder& holder : holders_) {
        holder.life = Life::Away;
        holder.tried.reset();
    }
}

// Finds its monitor by identity, and the mode there.
void Placement::find(Holder& holder, const std::vector<Monitor>& monitors) {
    const MonitorClaim& claim = holder.claim;
    holder.monitor = nullptr;
    holder.mode = nullptr;
    std::vector<const Monitor*> there, fitting;
    for (const Monitor& monitor : monitors) {
        if (!monitor.connected) continue;
        there.push_back(&monitor);
        if (claim.monitor.fits(monitor)) fitting.push_back(&monitor);
    }
    std::string& absence = holder.seat.absence;
    if (fitting.empty()) {
        absence = fmt::format("there is no monitor {} (there is: {}); connect it and switch it on", claim.monitor.text(),
                              textsOf(there));
    } else if (fitting.size() > 1) {
        std::vector<std::string> connectors;
        connectors.reserve(fitting.size());
        for (const Monitor* monitor : fitting) connectors.push_back("connector: " + monitor->connector);
        absence = fmt::format("monitor {} may be any of {} here; choose one by its serial or {}", claim.monitor.text(),
                              textsOf(fitting), fmt::join(connectors, " or "));
    } else {
        const auto other = std::find_if(holders_.begin(), holders_.end(), [&](const Holder& earlier) {
            return earlier.number < holder.number && earlier.monitor == fitting[0];
        });
        if (other != holders_.end())
            absence = fmt::format("monitor {} already belongs to output '{}'; give each output its own", fitting[0]->text(),
                                  other->claim.name);
        else
            holder.monitor = fitting[0];
    }
    if (holder.monitor == nullptr) {
        holder.life = Life::Away;
        return;
    }

    const Monitor& monitor = *holder.monitor;
    if (holder.life == Life::Away || holder.connector != monitor.connector || monitor.unplugged) {
        holder.life = Life::Wanted;
        holder.tried.reset();
    }
    holder.connector = monitor.connector;
    if (!monitor.on && holder.life == Life::Shown) holder.life = Life::SwitchedOff;
    if (monitor.on && holder.life == Life::SwitchedOff) holder.life = Life::Wanted;
    if (holder.life == Life::SwitchedOff) {
        absence = fmt::format("monitor {} was switched off; xrandr --output {} --auto switches it on again", monitor.text(),
                              monitor.connector);
        return;
    }
    holder.mode = bestMode(monitor, claim);
    if (holder.mode == nullptr)
        absence = fmt::format("monitor {} has no mode of {} x {} pixels; give the output one of its sizes: {}", monitor.text(),
                              claim.size.x, claim.size.y, sizesOf(monitor));
}

// Whether the monitor already shows what it should.
bool Placement::keeps(Holder& holder, Round& round) {
    const auto& on = holder.monitor->on;
    if (!on || on->area.size != holder.claim.size || !sameRate(on->mode, *holder.mode)) return false;
    if (holder.claim.position && on->area.corner != *holder.claim.position) return false;
    if (round.inTheWayOf(on->area) != nullptr) return false;
    holder.life = Life::Shown;
    holder.tried.reset();
    holder.failure.clear();
    holder.reserved = on->area.corner;
    holder.seat = {"", on->area, on->mode.hertz};
    round.taken.emplace_back(&holder, on->area);
    return true;
}

// Reserves its place, for now and later. It gets none if the X screen would become too large.
void Placement::reserve(Holder& holder, Round& round) {
    // A monitor that nobody claims may be one whose identity is missing for the moment, so it takes
    // the place only when the place is used.
    const bool now = holder.mode != nullptr;
    const auto free = [&](const Area& area) {
        const auto covers = [&](const Area& other) { return now && area.overlaps(other); };
        return round.inTheWayOf(area) == nullptr && std::none_of(round.foreign.begin(), round.foreign.end(), covers);
    };
    Area area{holder.reserved.value_or(glm::ivec2(0)), holder.claim.size};
    if (holder.claim.position) {
        area.corner = *holder.claim.position;
    } else if (!holder.reserved || !free(area)) {
        // Places that later holders had before count, too.
        int right = 0;
        for (const auto& [other, theirs] : round.taken) right = std::max(right, theirs.end().x);
        for (const Area& theirs : round.foreign) right = std::max(right, theirs.end().x);
        for (const Holder& other : holders_)
            if (other.number != holder.number && other.reserved) right = std::max(right, other.reserved->x + other.claim.size.x);
        area.corner = {right, 0};
    }
    holder.reserved.reset();
    if (glm::any(glm::greaterThan(area.end(), round.largest)) || round.inTheWayOf(area) != nullptr) return;
    holder.reserved = area.corner;
    round.taken.emplace_back(&holder, area);
    round.plan.screen = glm::max(round.plan.screen, area.end());
}

// Decides how to switch its monitor.
void Placement::place(Holder& holder, Round& round) {
    const Monitor& monitor = *holder.monitor;
    std::string& absence = holder.seat.absence;
    holder.life = Life::Wanted;  // from now on, changes of the picture are ours
    reserve(holder, round);
    if (!holder.reserved) {
        absence =
            fmt::format("no room for {} x {} pixels on the X screen, which can have {} x {}; give the outputs other positions",
                        holder.claim.size.x, holder.claim.size.y, round.largest.x, round.largest.y);
        if (const auto& asked = holder.claim.position)
            if (const Holder* other = round.inTheWayOf({*asked, holder.claim.size}))
                absence = fmt::format("at its position it would cover output '{}'; give it another position", other->claim.name);
        return;
    }

    // A CRTC without a visible picture is free: preferably one that is off, else one whose monitor
    // is gone.
    std::set<std::uint32_t> used, idle;
    for (const Monitor& other : round.monitors)
        if (&other != &monitor && other.on) (other.connected ? used : idle).insert(other.on->crtcId);
    for (const Change& change : round.plan.changes) used.insert(change.crtcId);
    std::uint32_t best = 0;
    std::tuple<bool, bool> bestCost{true, true};
    for (const std::uint32_t crtc : monitor.possibleCrtcs) {
        const std::tuple cost(idle.contains(crtc), !(monitor.on && monitor.on->crtcId == crtc));
        if (used.contains(crtc) || (best != 0 && cost >= bestCost)) continue;
        best = crtc;
        bestCost = cost;
    }
    if (best == 0) {
        absence = fmt::format(
            "the graphics card cannot drive monitor {}, too; switch another one off: xrandr --output "
            "NAME --off",
            monitor.text());
        return;
    }

    const Change change{holder.number, monitor.outputId, best, holder.mode->modeId, *holder.reserved};
    if (holder.tried != change) {
        holder.tried = change;
        holder.failure = fmt::format("monitor {} refuses {} x {} pixels at {:.2f} Hz; try another size or refresh rate",
                                     monitor.text(), holder.claim.size.x, holder.claim.size.y, holder.mode->hertz);
        round.plan.changes.push_back(change);
    }
    absence = holder.failure;
}

Placement::Plan Placement::look(const std::vector<Monitor>& monitors, glm::ivec2 largest) {
    Round round{monitors, largest};
    for (Holder& holder : holders_) find(holder, monitors);
    for (const Monitor& monitor : monitors) {
        if (!monitor.on) continue;
        round.plan.screen = glm::max(round.plan.screen, monitor.on->area.end());
        const bool claimed =
            std::any_of(holders_.begin(), holders_.end(), [&](const Holder& holder) { return holder.monitor == &monitor; });
        if (monitor.connected && !claimed) round.foreign.push_back(monitor.on->area);
    }

    // Outputs with a fixed position come first, then those that can stay where they are, then the
    // rest.
    std::vector<Holder*> rest;
    const auto settle = [&](Holder& holder) {
        if (holder.mode != nullptr)
            place(holder, round);
        else
            reserve(holder, round);
    };
    for (Holder& holder : holders_)
        if (holder.claim.position && !(holder.mode != nullptr && keeps(holder, round))) settle(holder);
    for (Holder& holder : holders_)
        if (!holder.claim.position && !(holder.mode != nullptr && keeps(holder, round))) rest.push_back(&holder);
    for (Holder* holder : rest) settle(*holder);
    return round.plan;
}

}  // namespace fantascope::drivers
