#include "drivers/site/world.h"

#include "core/check.h"

#include <fmt/format.h>

#include <algorithm>

namespace fantascope::site {
namespace {

const std::string kRelayBank = "relay bank", kCueController = "cue controller", kCamera = "camera";
std::string universeName(int universe) { return fmt::format("universe {}", universe); }
std::string deskName(int universe) { return fmt::format("desk {}", universe); }

}  // namespace

void World::setPlugged(const std::string& device, bool plugged) {
    const std::lock_guard lock(mutex_);
    Plug& plug = plugs_[device];
    if (plug.in == plugged) return;
    plug.in = plugged;
    if (plugged) return;
    ++plug.pulls;
    // What the far end does by itself when its line goes dead.
    if (device == kRelayBank) relays_ = safeStates_;
    if (device == kCueController) presses_.clear();
    if (device == kCamera) camera_.clear();
    frames_.erase(device);
    std::erase_if(desk_, [&](const auto& entry) { return deskName(entry.first) == device; });
}

bool World::plugged(const std::string& device) const {
    const std::lock_guard lock(mutex_);
    return isIn(device);
}

int World::unpluggings(const std::string& device) const {
    const std::lock_guard lock(mutex_);
    const auto found = plugs_.find(device);
    return found == plugs_.end() ? 0 : found->second.pulls;
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

void World::installRelays(const std::vector<bool>& safeStates) {
    const std::lock_guard lock(mutex_);
    relays_ = safeStates_ = safeStates;
}

bool World::setRelays(const std::vector<bool>& states) {
    const std::lock_guard lock(mutex_);
    FANTASCOPE_CHECK(states.size() == safeStates_.size(), "one state for each installed relay");
    if (!isIn(kRelayBank)) return false;
    relays_ = states;
    return true;
}

std::vector<bool> World::relays() const {
    const std::lock_guard lock(mutex_);
    return relays_;
}

void World::setContact(std::size_t contact, bool closed) {
    const std::lock_guard lock(mutex_);
    if (closed)
        closed_.insert(contact);
    else
        closed_.erase(contact);
}

bool World::contact(std::size_t contact) const {
    const std::lock_guard lock(mutex_);
    return closed_.contains(contact);
}

void World::sendFromDesk(int universe, DmxInput frame) {
    const std::lock_guard lock(mutex_);
    if (!isIn(deskName(universe))) return;
    std::deque<DmxInput>& waiting = desk_[universe];
    frame.arrived = clock_.now();
    waiting.push_back(std::move(frame));
    if (waiting.size() <= kDeskDepth) return;
    // The oldest frame that its own sender has already replaced; every sender's newest stays.
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
