#pragma once

#include "drivers/camera/video_node.h"
#include "drivers/common/file_handle.h"
#include "drivers/common/found_device.h"

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace fantascope::drivers {

// By what a camera is known; what is empty says nothing. With nothing at all any camera fits that
// is the only one.
struct CameraIdentity {
    std::string device;       // its file: "/dev/video0", or a link to it
    std::string serial, usb;  // UsbIdentity's `serial` and `path`
    std::string card;         // as its driver names it: "HD Webcam C525"
};

struct OpenCamera {
    std::filesystem::path file;
    VideoNode node;
};

// The one camera that fits, open. Else why not: none fits, several do, or it cannot be opened.
std::variant<OpenCamera, Outage> openCameraThatIs(const CameraIdentity& wanted);

// What a program claims of the camera (Opening::claim): its file, in use or not; what is wanted
// where none is there, or several are. Like findCameras() it disturbs none.
std::string claimOf(const CameraIdentity& wanted);

// Why a camera's file does not do what it should, from errno: whyNotOpened() with what errors mean
// for a camera. `what` could not be done.
Outage whyNotUsed(const std::filesystem::path& file, const std::string& what, int error);

// The names of formats for a person: some drivers offer eighty, of which the first few are named
// and the others counted.
std::string listedFormats(const std::vector<std::string>& names);

// Every camera that this machine has. Thread: any; takes some milliseconds a camera, and disturbs
// none that is in use.
std::vector<FoundDevice> findCameras();

}  // namespace fantascope::drivers
