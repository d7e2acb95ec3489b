#include "drivers/site/world.h"

#include "core/check.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::site {
namespace {

const std::string kCueController = "cue controller", kCamera = "camera";
std::string universeName(int universe) { return fmt::format("universe {}", universe); }
std::string deskName(int universe) { return fmt::format("desk {}", universe); }

}  // namespace

void World::setPlugged(const std::string& device, bool plugged) {
    const std::lock_guard lock(mutex_);
    Plug& plug = plugs_[device];
    if (plug.in == plugged) return;
    plug.in = plugged;
    if (plugged) return;
    ++plug.losses;
    // What the far end does when its line goes dead.
    if (const auto bank = relays_.find(device); bank != relays_.end())
        bank->second = {bank->second.safe, bank->second.safe, false};
    if (device == kCueController) presses_.clear();
    if (device == kCamera) camera_.clear();
    frames_.erase(device);
    std::erase_if(desk_, [&](const auto& entry) { return deskName(entry.first) == device; });
}

bool World::plugged(const std::string& device) const {
    const std::lock_guard lock(mutex_);
    return isIn(device);
}

int World::losses(const std::string& device) const {
    const std::lock_guard lock(mutex_);
    const auto found = plugs_.find(device);
    return found == plugs_.end() ? 0 : found->second.losses;
}

void World::setGraphics(const std::string& output, bool work) {
    const std::lock_guard lock(mutex_);
    if (work)
        withoutGraphics_.erase(output);
    else
        withoutGraphics_.insert(output);
}

bool World::graphicsWork(const std::string& output) const {
    const std::lock_guard lock(mutex_);
    return !withoutGraphics_.contains(output);
}

bool World::isIn(const std::string& device) const {
    const auto found = plugs_.find(device);
    return found == plugs_.end() || found->second.in;
}

bool World::setSlots(int universe, std::span<const std::uint8_t, kDmxSlots> slots) {
    const std::lock_guard lock(mutex_);
    if (!isIn(universeName(universe))) return false;
    std::copy(slots.begin(), slots.end(), slots_[universe].begin());
    return true;
}

std::array<std::uint8_t, kDmxSlots> World::slots(int universe) const {
    const std::lock_guard lock(mutex_);
    const auto found = slots_.find(universe);
    return found == slots_.end() ? std::array<std::uint8_t, kDmxSlots>{} : found->second;
}

void World::installRelays(const std::string& bank, const std::vector<bool>& safeStates) {
    const std::lock_guard lock(mutex_);
    relays_[bank] = {safeStates, safeStates, false};
}

bool World::setRelays(const std::string& bank, const std::vector<bool>& states) {
    const std::lock_guard lock(mutex_);
    Relays& relays = relays_[bank];
    FANTASCOPE_CHECK(states.size() == relays.safe.size(), "one state for each installed relay");
    if (!isIn(bank)) return false;
    relays.states = states;
    relays.asWritten = true;
    return true;
}

void World::switchRelaysByHand(const std::string& bank, const std::vector<bool>& states) {
    const std::lock_guard lock(mutex_);
    Relays& relays = relays_[bank];
    FANTASCOPE_CHECK(states.size() == relays.safe.size(), "one state for each installed relay");
    if (relays.asWritten && states != relays.states) {
        ++plugs_[bank].losses;
        relays.asWritten = false;
    }
    relays.states = states;
}

std::vector<bool> World::relays(const std::string& bank) const {
    const std::lock_guard lock(mutex_);
    const auto found = relays_.find(bank);
    return found == relays_.end() ? std::vector<bool>() : found->second.states;
}

void World::setContact(const std::string& bank, std::size_t contact, bool closed) {
    const std::lock_guard lock(mutex_);
    if (closed)
        closed_.insert({bank, contact});
    else
        closed_.erase({bank, contact});
}

bool World::contact(const std::string& bank, std::size_t contact) const {
    const std::lock_guard lock(mutex_);
    return closed_.contains({bank, contact});
}

void World::sendFromDesk(int universe, DmxInput frame) {
    const std::lock_guard lock(mutex_);
    if (!isIn(deskName(universe))) return;
    std::deque<DmxInput>& waiting = desk_[universe];
    frame.arrived = clock_.now();
    waiting.push_back(std::move(frame));
    if (waiting.size() <= kDeskDepth) return;
    // Drops the oldest frame that its own sender has already replaced. The newest of every sender
    // stays.
    for (auto old = waiting.begin(); old != waiting.end(); ++old) {
        if (std::none_of(old + 1, waiting.end(), [&](const DmxInput& later) { return later.source == old->source; })) continue;
        waiting.erase(old);
        return;
    }
}

std::optional<DmxInput> World::takeFromDesk(int universe) {
    const std::lock_guard lock(mutex_);
    std::deque<DmxInput>& waiting = desk_[universe];
    if (waiting.empty()) return std::nullopt;
    DmxInput oldest = std::move(waiting.front());
    waiting.pop_front();
    return oldest;
}

void World::press(int button, bool pressed) {
    const std::lock_guard lock(mutex_);
    if (isIn(kCueController)) presses_.push_back({button, pressed, clock_.now()});
}

std::optional<ButtonEvent> World::takePress() {
    const std::lock_guard lock(mutex_);
    if (presses_.empty()) return std::nullopt;
    const ButtonEvent oldest = presses_.front();
    presses_.pop_front();
    return oldest;
}

void World::setLight(int button, const ButtonLight& light) {
    const std::lock_guard lock(mutex_);
    if (button >= 1) lights_[button] = light;
}

ButtonLight World::light(int button) const {
    const std::lock_guard lock(mutex_);
    const auto found = lights_.find(button);
    return found == lights_.end() || !isIn(kCueController) ? ButtonLight{} : found->second;
}

void World::setFrame(const std::string& output, std::shared_ptr<const RgbaImage> frame) {
    const std::lock_guard lock(mutex_);
    if (isIn(output)) frames_[output] = std::move(frame);
}

std::shared_ptr<const RgbaImage> World::frame(const std::string& output) const {
    const std::lock_guard lock(mutex_);
    const auto found = frames_.find(output);
    return found == frames_.end() ? nullptr : found->second;
}

void World::sendFromCamera(std::shared_ptr<const CameraFrame> frame, Time due) {
    const std::lock_guard lock(mutex_);
    if (isIn(kCamera)) camera_.emplace_back(due, std::move(frame));
}

std::shared_ptr<const CameraFrame> World::takeFromCamera() {
    const std::lock_guard lock(mutex_);
    std::shared_ptr<const CameraFrame> newest;
    for (; !camera_.empty() && camera_.front().first <= clock_.now(); camera_.pop_front())
        newest = std::move(camera_.front().second);
    return newest;
}

}  // namespace fantascope::site
