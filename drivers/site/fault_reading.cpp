#include "drivers/site/fault.h"
#include "drivers/site/limits.h"

#include <fmt/format.h>

#include <array>
#include <numbers>

namespace fantascope::site {
namespace {

// In the order of Fault::Kind.
const std::vector<std::string> kFaultKinds = {"unplug",  "freeze", "graphics",    "bump",    "fog",         "dim",
                                              "defocus", "input",  "ambient",     "flicker", "camera_bump", "cover",
                                              "dirt",    "blind",  "upside_down", "exposure"};

void declareDevice(ConfigFields& fields, std::string_view key, const std::vector<std::string>& names, Fault& fault) {
    fields.read(key, fault.device,
                [&](const ConfigNode& value) -> Result<std::string> { return names[TRY(value.choice(names))]; });
}

void declareRise(ConfigFields& fields, Fault& fault) { fields.optional().time("rise", fault.rise, 0, kMaxTime); }

void declareMovement(ConfigFields& fields, Fault& fault) {
    fields.optional().vector3("move", fault.move, -100, 100, "m");
    fields.optional().read("turn", fault.turn, [](const ConfigNode& value) -> Result<glm::dvec3> {
        return TRY(value.vector3(-180, 180, "degrees")) * (std::numbers::pi / 180);
    });
}

void declareOfDevice(ConfigFields& fields, const std::vector<std::string>& outputs, const NominalSite& nominal, Fault& fault) {
    std::vector<std::string> freezing = outputs;
    if (nominal.camera) freezing.emplace_back("camera");
    switch (fault.kind) {
        case Fault::Kind::Unplug:
            return declareDevice(fields, "device", nominal.devices, fault);
        case Fault::Kind::Freeze:
            return declareDevice(fields, "device", freezing, fault);
        case Fault::Kind::Graphics:
            return declareDevice(fields, "device", outputs, fault);
        case Fault::Kind::Bump:
            declareDevice(fields, "output", outputs, fault);
            return declareMovement(fields, fault);
        case Fault::Kind::Dim:
            declareDevice(fields, "output", outputs, fault);
            fields.number("level", fault.level, 0, 1);
            return declareRise(fields, fault);
        case Fault::Kind::Defocus:
            declareDevice(fields, "output", outputs, fault);
            fields.number("blur", fault.blur, 0, 50, "pixels");
            return declareRise(fields, fault);
        case Fault::Kind::Input:
            declareDevice(fields, "output", outputs, fault);
            return fields.read("picture", fault.picture,
                               [&](const ConfigNode& value) -> Result<std::shared_ptr<const RgbaImage>> {
                                   const std::filesystem::path path = TRY(value.path());
                                   fault.pictureName = path.filename();
                                   return std::make_shared<const RgbaImage>(TRY(readRgba(path).in(value.place())));
                               });
        default:
            return;
    }
}

void declareOfLight(ConfigFields& fields, const NominalSite& nominal, Fault& fault) {
    std::vector<std::string> relays;
    for (const NominalSite::Relay& relay : nominal.relays) relays.push_back(relay.name);
    switch (fault.kind) {
        case Fault::Kind::Fog:
            fields.number("density", fault.density, 0, 10, "1/m");
            return declareRise(fields, fault);
        case Fault::Kind::Ambient:
            fields.number("level", fault.level, 0, 1e6);
            return declareRise(fields, fault);
        case Fault::Kind::Flicker:
            fields.optional();
            declareDevice(fields, "relay", relays, fault);
            fields.number("depth", fault.depth, 0, 1);
            return fields.number("frequency", fault.frequency, 0.01, 1000, "Hz");
        default:
            return;
    }
}

// [left, top, right, bottom] as shares of the picture.
Result<std::array<double, 4>> readShares(const ConfigNode& node) {
    std::array<double, 4> shares{};
    const std::vector<ConfigNode> items = TRY(node.items(4, 4));
    for (std::size_t i = 0; i < 4; ++i) shares[i] = TRY(items[i].number(0, 1));
    if (shares[0] >= shares[2] || shares[1] >= shares[3])
        return node.error("[left, top, right, bottom] is needed, left before right and top above bottom");
    return shares;
}

void declareOfCamera(ConfigFields& fields, Fault& fault) {
    std::array<double, 4> shares{};
    switch (fault.kind) {
        case Fault::Kind::CameraBump:
            return declareMovement(fields, fault);
        case Fault::Kind::Cover:
            fields.read("rectangle", shares, readShares);
            fault.low = {shares[0], shares[1]};
            fault.high = {shares[2], shares[3]};
            fields.optional().vector3("reflectance", fault.reflectance, 0, 1);
            return fields.optional().vector3("luminance", fault.luminance, 0, kMaxLight, "cd/m2");
        case Fault::Kind::Dirt:
            fields.optional().number("blur", fault.blur, 0, 50, "pixels");
            fields.optional().number("veil", fault.veil, 0, 1);
            return declareRise(fields, fault);
        case Fault::Kind::Blind:
            return fields.number("level", fault.level, 0, 1);
        case Fault::Kind::Exposure:
            fields.number("gain", fault.level, 0, 1e6);
            return declareRise(fields, fault);
        default:
            return;
    }
}

}  // namespace

Result<Fault> readFault(const ConfigNode& node, const NominalSite& nominal) {
    Fault fault;
    // A fault's keys depend on its kind, so the kind is read first, wherever it stands.
    TRY(node.entries());  // it is a map
    const auto found = node.find("kind");
    if (found) fault.kind = static_cast<Fault::Kind>(TRY(found->choice(kFaultKinds)));
    if (!found) return node.error(fmt::format("'kind' is missing; one of {} is needed", fmt::join(kFaultKinds, ", ")));

    const Span span{fault.at, fault.until};
    ConfigFields fields(node);
    std::string kind;
    fields.text("kind", kind);
    span.declare(fields);
    std::vector<std::string> outputs;
    for (const NominalSite::Output& output : nominal.outputs) outputs.push_back(output.name);
    declareOfDevice(fields, outputs, nominal, fault);
    declareOfLight(fields, nominal, fault);
    declareOfCamera(fields, fault);
    TRY(fields.finish());
    TRY(span.check(node));
    if (fault.kind >= Fault::Kind::CameraBump && !nominal.camera) return node.error("this site has no camera");
    return fault;
}

}  // namespace fantascope::site
