#include "drivers/site/simulated_site.h"

#include "drivers/site/camera_view.h"
#include "drivers/site/fault.h"
#include "drivers/site/optics.h"
#include "drivers/site/projected_light.h"
#include "drivers/site/scene.h"
#include "drivers/site/sensor.h"
#include "drivers/site/simulation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace fantascope::site {
namespace {

const std::string kCamera = "camera";

// A lamp's light for its slots' values: linear, 1 is full power.
glm::vec3 levelOf(const NominalSite::Fixture& fixture, const std::array<std::uint8_t, kDmxSlots>& slots) {
    constexpr std::array<std::string_view, 3> kColours{"red", "green", "blue"};
    std::optional<float> intensity;
    std::optional<glm::vec3> colour;
    for (std::size_t i = 0; i < fixture.channels.size(); ++i) {
        const float value = static_cast<float>(slots[static_cast<std::size_t>(fixture.address) - 1 + i]) / 255;
        if (fixture.channels[i] == "intensity") intensity = value;
        for (int c = 0; c < 3; ++c)
            if (fixture.channels[i] == kColours[static_cast<std::size_t>(c)]) {
                if (!colour) colour = glm::vec3(0);
                (*colour)[c] = value;
            }
    }
    if (!intensity && !colour) return glm::vec3(0);
    return intensity.value_or(1) * colour.value_or(glm::vec3(1));
}

// The rows of a rolling exposure are exposed in this many bands, one after the other.
constexpr int kBands = 8;

// A picture that the camera is exposing.
struct Exposure {
    std::int64_t frame = 0;
    int band = 0;          // the next
    bool repeats = false;  // the camera is frozen, and sends its last picture again
    bool lost = false;     // the camera was unplugged meanwhile
};

// The beginning or end of a fault.
struct Change {
    Time at{};
    const Fault* fault = nullptr;
    bool begins = false;
};

// The beginning or end of a closing.
struct Move {
    Time at{};
    std::size_t contact = 0;
    bool closes = false;
};

}  // namespace

struct SimulatedSite::Impl {
    Impl(Simulation read, NominalSite site, std::uint64_t seed, World& itsWorld)
        : world(itsWorld),
          nominal(std::move(site)),
          simulation(std::move(read)),
          scene(simulation.objects),
          sensor(simulation.camera.sensor, seed) {
        for (std::size_t i = 0; i < nominal.outputs.size(); ++i)
            light.emplace_back(nominal.outputs[i].projector.size, simulation.projectors[i].gamma,
                               simulation.projectors[i].blackLevel, simulation.projectors[i].white);
        if (nominal.camera) {
            look();
            luminance = Image<glm::vec3>(nominal.camera->size.x, nominal.camera->size.y);
        }
        for (const Fault& fault : simulation.faults) {
            changes.push_back({fault.at, &fault, true});
            if (fault.until) changes.push_back({*fault.until, &fault, false});
        }
        std::stable_sort(changes.begin(), changes.end(), [](const Change& a, const Change& b) { return a.at < b.at; });
        for (const Closing& closing : simulation.closings) {
            moves.push_back({closing.at, closing.contact, true});
            if (closing.until) moves.push_back({*closing.until, closing.contact, false});
        }
        std::stable_sort(moves.begin(), moves.end(), [](const Move& a, const Move& b) { return a.at < b.at; });
        fail(Time{});  // so that a device that is missing at first is missing when the show is prepared
    }

    // Applies everything up to a time since begin().
    void happen(Time until) {
        for (; nextMove < moves.size() && moves[nextMove].at <= until; ++nextMove) {
            const Move& move = moves[nextMove];
            int& closings = closed[move.contact];
            closings += move.closes ? 1 : -1;
            const NominalSite::Contact& contact = nominal.contacts[move.contact];
            world.setContact(contact.bank, contact.input, closings > 0);
        }
        fail(until);
    }

    // Begins and ends the faults up to a time since begin().
    void fail(Time until) {
        for (; nextChange < changes.size() && changes[nextChange].at <= until; ++nextChange) {
            const Change& change = changes[nextChange];
            if (change.begins)
                active.push_back(change.fault);
            else
                std::erase(active, change.fault);
            apply(*change.fault);
            const std::lock_guard lock(mutex);
            happenings.push_back({change.at, tell(*change.fault, change.begins)});
        }
    }

    // Updates what one fault touches to all faults that are active now.
    void apply(const Fault& changed) {
        const std::string& device = changed.device;
        const auto isActive = [&](Fault::Kind kind) {
            return std::any_of(active.begin(), active.end(),
                               [&](const Fault* fault) { return fault->kind == kind && fault->device == device; });
        };
        switch (changed.kind) {
            case Fault::Kind::Unplug:
                world.setPlugged(device, !isActive(Fault::Kind::Unplug));
                break;
            case Fault::Kind::Freeze:
                if (!isActive(Fault::Kind::Freeze))
                    frozen.erase(device);
                else
                    frozen.emplace(device, world.frame(device));  // null for the camera, which repeats its own frame
                break;
            case Fault::Kind::Graphics:
                world.setGraphics(device, !isActive(Fault::Kind::Graphics));
                break;
            case Fault::Kind::Bump:
                bump(device);
                break;
            case Fault::Kind::CameraBump:
                if (view) look();
                break;
            default:
                break;  // a function of time, see lightingAt() and developed()
        }
    }

    // Where faults of a kind have brought a device.
    vision::CameraModel bumped(vision::CameraModel model, Fault::Kind kind, const std::string& device) const {
        Pose& pose = model.pose;
        for (const Fault* fault : active) {
            if (fault->kind != kind || fault->device != device) continue;
            pose.position += pose.worldFromLocal * fault->move;
            pose.worldFromLocal = pose.worldFromLocal * rotationXyz(fault->turn);
        }
        return model;
    }
    vision::CameraModel projector(std::size_t output) const {
        return bumped(nominal.outputs[output].projector, Fault::Kind::Bump, nominal.outputs[output].name);
    }

    // Computes all light on its way to the camera where it stands now.
    void look() {
        view.emplace(scene, bumped(*nominal.camera, Fault::Kind::CameraBump, ""), simulation.ambient, simulation.sky);
        for (const FedLamp& lamp : simulation.lamps) view->addLamp(lamp.lamp);
        for (const FedLamp& lamp : simulation.streetLamps) view->addLamp(lamp.lamp);
        for (std::size_t i = 0; i < nominal.outputs.size(); ++i)
            view->addProjector(projector(i), simulation.projectors[i].lumens);
        if (!simulation.walkers.empty()) view->expectBodies();
    }

    void bump(const std::string& output) {
        if (!view) return;
        for (std::size_t i = 0; i < nominal.outputs.size(); ++i)
            if (nominal.outputs[i].name == output) view->moveProjector(i, projector(i));
    }

    // What shines now, `time` after begin().
    Lighting lightingAt(Time time) {
        levels.clear();
        for (const FedLamp& lamp : simulation.lamps) {
            const NominalSite::Fixture& fixture = nominal.fixtures[lamp.feed];
            levels.push_back(levelOf(fixture, world.slots(fixture.universe)));
        }
        for (const FedLamp& lamp : simulation.streetLamps) {
            const NominalSite::Relay& relay = nominal.relays[lamp.feed];
            const std::vector<bool> bank = world.relays(relay.bank);
            const bool on = relay.coil < bank.size() && bank[relay.coil];
            levels.emplace_back(on ? flickerAt(simulation.faults, relay.name, time) : 0);
        }
        for (std::size_t i = 0; i < nominal.outputs.size(); ++i) {
            const std::string& output = nominal.outputs[i].name;
            const auto held = frozen.find(output);
            const ProjectorState state = projectorAt(simulation.faults, output, time);
            const auto shown = state.picture ? state.picture : held == frozen.end() ? world.frame(output) : held->second;
            light[i].show(world.plugged(output) ? shown : nullptr, state.blur, state.level);
        }
        bodies.clear();
        for (const Walker& walker : simulation.walkers)
            if (const auto body = walker.bodyAt(time)) bodies.push_back(*body);
        passing.clear();
        for (const Headlight& headlight : simulation.headlights)
            if (const auto lamp = headlight.lampAt(time)) passing.push_back(*lamp);
        const double fog = fogAt(simulation.faults, time), ambient = ambientAt(simulation.faults, time);
        return {levels, light, fog, static_cast<float>(ambient), bodies, passing};
    }

    int bands() const { return simulation.camera.rolling > Time{} ? kBands : 1; }
    // When a band is exposed, since begin(): the first band with the frame, the last one `rolling`
    // later.
    Time timeOf(const Exposure& picture) const {
        const Time rolled = bands() > 1 ? simulation.camera.rolling * picture.band / (bands() - 1) : Time{};
        return tickTime(picture.frame, simulation.camera.frameRate) + rolled;
    }

    // Exposes all bands that are due. A picture that was begun is finished; of those that are not
    // begun only the newest is.
    void exposeUntil(Time until) {
        while (true) {
            if (!exposure) {
                const std::int64_t frame = tickAt(until, simulation.camera.frameRate);
                if (frame <= lastFrame) return;
                exposure = Exposure{frame};
                lastFrame = frame;
            }
            for (; exposure->band < bands(); ++exposure->band) {
                const Time due = timeOf(*exposure);
                if (due > until) return;
                happen(due);
                exposeBand(*exposure, due);
            }
            send(*exposure);
            exposure.reset();
        }
    }

    void exposeBand(Exposure& picture, Time time) {
        if (picture.band == 0) picture.repeats = frozen.contains(kCamera) && !lastSeen.empty();
        picture.lost = picture.lost || !world.plugged(kCamera);
        if (picture.repeats || picture.lost) return;
        const int height = luminance.height();
        view->render(lightingAt(time), {height * picture.band / bands(), height * (picture.band + 1) / bands()}, luminance);
    }

    void send(const Exposure& picture) {
        if (picture.lost) return;
        if (!picture.repeats) lastSeen = developed(picture.frame);
        const Time exposed = beginning + tickTime(picture.frame, simulation.camera.frameRate);
        const CameraFrame sent{lastSeen, exposed, static_cast<std::uint64_t>(picture.frame)};
        world.sendFromCamera(std::make_shared<const CameraFrame>(sent),
                             exposed + simulation.camera.rolling + simulation.camera.latency);
    }

    // The picture that lens and sensor make of the light.
    RgbaImage developed(std::int64_t frame) {
        const Time time = tickTime(frame, simulation.camera.frameRate);
        const CameraState state = cameraAt(simulation.faults, time);
        if (state.blind) {
            const auto stored = static_cast<std::uint8_t>(std::lround(255 * *state.blind));
            return {luminance.width(), luminance.height(), Rgba8{stored, stored, stored, 255}};
        }
        const glm::dvec3 ambient = simulation.ambient * (ambientAt(simulation.faults, time) / std::numbers::pi);
        for (const Fault* cover : state.covers)
            coverPart(luminance, cover->low, cover->high, cover->reflectance * ambient + cover->luminance);
        blurLight(luminance, std::hypot(simulation.camera.blur, state.blur));
        veil(luminance, state.veil);
        vignette(luminance, simulation.camera.vignetting);
        if (state.gain != 1)
            for (glm::vec3& pixel : luminance.pixels()) pixel *= static_cast<float>(state.gain);
        RgbaImage picture = sensor.expose(luminance, static_cast<std::uint64_t>(frame));
        if (state.upsideDown) std::reverse(picture.pixels().begin(), picture.pixels().end());
        return picture;
    }

    World& world;
    const NominalSite nominal;
    const Simulation simulation;
    const Scene scene;
    const Sensor sensor;
    Time beginning{};

    std::vector<Change> changes;  // sorted by time; point into simulation.faults
    std::size_t nextChange = 0;
    std::vector<const Fault*> active;
    std::vector<Move> moves;  // sorted by time
    std::size_t nextMove = 0;
    std::map<std::size_t, int> closed;                               // how many closings hold a contact closed now
    std::map<std::string, std::shared_ptr<const RgbaImage>> frozen;  // the frame that a frozen device keeps

    std::optional<CameraView> view;
    std::vector<ProjectedLight> light;  // per output
    std::vector<glm::vec3> levels;      // per lamp
    std::vector<Body> bodies;
    std::vector<Lamp> passing;
    Image<glm::vec3> luminance;
    RgbaImage lastSeen;
    std::int64_t lastFrame = -1;  // the last one that was begun
    std::optional<Exposure> exposure;

    mutable std::mutex mutex;
    std::vector<Happening> happenings;
};

Result<std::unique_ptr<SimulatedSite>> SimulatedSite::open(const ConfigNode& simulation, const NominalSite& nominal,
                                                           std::uint64_t seed, World& world) {
    auto impl = std::make_unique<Impl>(TRY(readSimulation(simulation, nominal)), nominal, seed, world);
    return std::unique_ptr<SimulatedSite>(new SimulatedSite(std::move(impl)));
}

SimulatedSite::SimulatedSite(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SimulatedSite::~SimulatedSite() = default;

void SimulatedSite::begin(Time at) { impl_->beginning = at; }

void SimulatedSite::advanceTo(Time now) {
    Impl& site = *impl_;
    const Time elapsed = now - site.beginning;
    if (elapsed < Time{}) return;
    if (site.view) site.exposeUntil(elapsed);
    site.happen(elapsed);
}

Time SimulatedSite::nextEvent() const {
    const Impl& site = *impl_;
    Time next = Time::max();
    if (site.nextChange < site.changes.size()) next = site.beginning + site.changes[site.nextChange].at;
    if (site.nextMove < site.moves.size()) next = std::min(next, site.beginning + site.moves[site.nextMove].at);
    if (site.view) next = std::min(next, site.beginning + site.timeOf(site.exposure.value_or(Exposure{site.lastFrame + 1})));
    return next;
}

std::vector<Happening> SimulatedSite::happenings() const {
    const std::lock_guard lock(impl_->mutex);
    return impl_->happenings;
}

}  // namespace fantascope::site
