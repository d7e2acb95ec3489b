#include "drivers/camera/camera_search.h"

#include "drivers/common/claim.h"
#include "drivers/common/usb_identity.h"

#include "core/config/config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <optional>
#include <system_error>
#include <tuple>
#include <utility>

namespace fantascope::drivers {
namespace {

namespace fs = std::filesystem;

// A video node as listed by the kernel, not open yet.
struct Listed {
    fs::path file;
    std::string name;  // usually its card
    UsbIdentity usb;
    int interface = 0;
};

// All video nodes of this machine, sorted by USB path.
std::vector<Listed> listedNodes() {
    constexpr const char* kClass = "video4linux";
    std::vector<Listed> all;
    std::error_code none;
    for (const fs::directory_entry& entry : fs::directory_iterator(fs::path("/sys/class") / kClass, none)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with("video")) continue;  // radios and others
        Listed node{fs::path("/dev") / name, {}, {}, 0};
        std::ifstream file(entry.path() / "name");
        std::getline(file, node.name);
        if (auto plugged = usbFileOf(kClass, name)) {
            node.usb = std::move(plugged->usb);
            node.interface = plugged->interface;
        }
        all.push_back(std::move(node));
    }
    const auto place = [](const Listed& node) {
        const std::string file = node.file.string();
        return std::tuple(node.usb.path, node.interface, file.size(), file);  // video2 before video10
    };
    std::ranges::sort(all, {}, place);
    return all;
}

bool mayBe(const Listed& node, const CameraIdentity& wanted) {
    return (wanted.serial.empty() || node.usb.serial == wanted.serial) && (wanted.usb.empty() || node.usb.path == wanted.usb);
}

// The matching cameras.
struct Fitting {
    struct Refused {
        fs::path file;
        int error;  // errno
    };
    std::vector<OpenCamera> open;
    std::vector<Refused> refused;  // in use, or without permission
};
Fitting camerasThatFit(const CameraIdentity& wanted) {
    Fitting fitting;
    for (const Listed& one : listedNodes()) {
        if (!mayBe(one, wanted)) continue;
        int error = 0;
        auto node = VideoNode::open(one.file, error);
        if (error == ENOTSUP || error == ENOENT || error == ENODEV || error == ENXIO) continue;
        if (!wanted.card.empty() && (node ? node->card() : one.name) != wanted.card) continue;
        if (node)
            fitting.open.push_back({one.file, std::move(*node)});
        else
            fitting.refused.push_back({one.file, error});
    }
    return fitting;
}

std::string described(const CameraIdentity& wanted) {
    std::string words = "camera";
    if (!wanted.card.empty()) words += fmt::format(" '{}'", wanted.card);
    if (!wanted.serial.empty()) words += " with the serial number " + wanted.serial;
    if (!wanted.usb.empty()) words += " at the USB port " + wanted.usb;
    return words;
}

// The shortest description that identifies the first camera among all.
std::string optionsFor(const CameraIdentity& one, const std::vector<CameraIdentity>& all) {
    const auto alone = [&](std::string CameraIdentity::*key) {
        return !(one.*key).empty() &&
               std::ranges::count_if(all, [&](const CameraIdentity& other) { return other.*key == one.*key; }) == 1;
    };
    for (const auto& [name, key] : {std::pair("serial", &CameraIdentity::serial), std::pair("usb", &CameraIdentity::usb),
                                    std::pair("card", &CameraIdentity::card)})
        if (alone(key)) return fmt::format("{{driver: v4l2, {}: {}}}", name, fantascope::quoted(one.*key));
    return fmt::format("{{driver: v4l2, device: {}}}", fantascope::quoted(one.device));
}

}  // namespace

Outage whyNotUsed(const fs::path& file, const std::string& what, int error) {
    switch (error) {
        case EBUSY:
            return {DeviceState::Faulted, fmt::format("{}: another program uses it; close that one", file.string())};
        case ENOTSUP:
            return {DeviceState::Faulted, fmt::format("{}: not a streaming camera; name its other file", file.string())};
        case ENOSPC:
            return {DeviceState::Faulted,
                    fmt::format(
                        "{}: the USB has no room left for its stream; take the format MJPG or a smaller size or rate, or plug it "
                        "into another controller's port",
                        file.string())};
        case ENODEV:
        case ENXIO:
            return {DeviceState::Absent, fmt::format("{} was unplugged", file.string())};
        case ENOENT:
        case EACCES:
        case EPERM:
            return whyNotOpened(file, error);
        default:
            return {DeviceState::Faulted, fmt::format("{}: {}: {}", file.string(), what, systemMessage(error))};
    }
}

std::variant<OpenCamera, Outage> openCameraThatIs(const CameraIdentity& wanted) {
    if (!wanted.device.empty()) {
        int error = 0;
        if (auto node = VideoNode::open(wanted.device, error)) return OpenCamera{wanted.device, std::move(*node)};
        return whyNotUsed(wanted.device, "opening it", error);
    }
    auto [open, refused] = camerasThatFit(wanted);
    if (open.size() == 1) return std::move(open.front());
    if (open.size() > 1) {
        std::vector<std::string> names;
        names.reserve(open.size());
        for (const OpenCamera& one : open) names.push_back(fmt::format("{} '{}'", one.file.string(), one.node.card()));
        return Outage{DeviceState::Faulted,
                      fmt::format("more than one {} is there ({}): choose one by serial, usb, card or device", described(wanted),
                                  fmt::join(names, ", "))};
    }
    if (!refused.empty()) return whyNotUsed(refused.back().file, "opening it", refused.back().error);
    return Outage{DeviceState::Absent, fmt::format("no {} is plugged in", described(wanted))};
}

std::string claimOf(const CameraIdentity& wanted) {
    constexpr const char* kKind = "camera";
    if (!wanted.device.empty()) return claimOfFile(kKind, wanted.device);
    const auto [open, refused] = camerasThatFit(wanted);
    if (open.size() == 1) return claimOfFile(kKind, open.front().file);
    if (open.empty() && refused.size() == 1) return claimOfFile(kKind, refused.front().file);
    return described(wanted);
}

std::string listedFormats(const std::vector<std::string>& names) {
    constexpr std::size_t kNamed = 8;
    if (names.size() <= kNamed) return listed(names);
    return fmt::format("{} and {} more", listed({names.begin(), names.begin() + kNamed}), names.size() - kNamed);
}

std::vector<FoundDevice> findCameras() {
    std::vector<FoundDevice> found;
    std::vector<CameraIdentity> identities;
    for (const Listed& node : listedNodes()) {
        int error = 0;
        const auto open = VideoNode::open(node.file, error);
        if (error == ENOTSUP || error == ENOENT || error == ENODEV || error == ENXIO) continue;
        FoundDevice camera{.family = "camera",
                           .what = open ? open->card() : node.name,
                           .identity = "",
                           .where = node.file.string(),
                           .why = "",
                           .options = ""};
        identities.push_back({node.file.string(), node.usb.serial, node.usb.path, camera.what});
        if (!node.usb.serial.empty()) camera.identity = "serial " + node.usb.serial + ", ";
        camera.identity += node.usb.path.empty() ? "no USB device" : "USB port " + node.usb.path;
        if (open) {
            const VideoNode::Offer offer = open->offer();
            std::vector<std::string> names;
            for (const FrameCoding coding : offer.codings) names.emplace_back(nameOf(coding));
            if (open->isInUse()) camera.why = whyNotUsed(node.file, "", EBUSY).why;
            if (names.empty())
                camera.why = fmt::format("it offers only {}, which cannot be decoded here", listedFormats(offer.others));
            names.insert(names.end(), offer.others.begin(), offer.others.end());
            if (!names.empty()) camera.what += fmt::format(" ({})", listedFormats(names));
        } else {
            camera.why = whyNotUsed(node.file, "opening it", error).why;
        }
        found.push_back(std::move(camera));
    }
    for (std::size_t i = 0; i < found.size(); ++i) found[i].options = optionsFor(identities[i], identities);
    return found;
}

}  // namespace fantascope::drivers
