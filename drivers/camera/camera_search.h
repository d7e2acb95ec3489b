#pragma once

#include "drivers/camera/video_node.h"
#include "drivers/common/file_handle.h"
#include "drivers/common/found_device.h"

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace fantascope::drivers {

// Identifies a camera; empty fields match any. If all are empty, the machine must have exactly one
// camera.
struct CameraIdentity {
    std::string device;       // its file: "/dev/video0", or a link to it
    std::string serial, usb;  // UsbIdentity's `serial` and `path`
    std::string card;         // its driver's name for it: "HD Webcam C525"
};

struct OpenCamera {
    std::filesystem::path file;
    VideoNode node;
};

// Opens the only matching camera. Else why not: none matches, several do, or it cannot be opened.
std::variant<OpenCamera, Outage> openCameraThatIs(const CameraIdentity& wanted);

// The name for Opening::claim: the camera's file, in use or not; the description if no camera, or
// more than one, matches. Like findCameras() it disturbs no camera.
std::string claimOf(const CameraIdentity& wanted);

// Why a camera's file fails, from errno: as whyNotOpened(), with the meaning of errors for a
// camera. `what` failed.
Outage whyNotUsed(const std::filesystem::path& file, const std::string& what, int error);

// Names of formats for a message: some drivers offer eighty, so the first few are named and the
// rest counted.
std::string listedFormats(const std::vector<std::string>& names);

// All cameras of this machine. Takes some milliseconds per camera and disturbs none that is in use.
// Thread: any.
std::vector<FoundDevice> findCameras();

}  // namespace fantascope::drivers
