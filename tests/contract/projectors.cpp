#include "contract/projectors.h"

#include "drivers/display/x_connecting.h"

#include "core/check.h"

#include <fmt/format.h>
#include <xcb/randr.h>
#include <xcb/xcb.h>
#include <xcb/xfixes.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <utility>
#include <vector>

namespace fantascope {
namespace {

// The dummy driver requires pixel clocks of 11 MHz and more, so small pictures get wide borders.
constexpr const char* kConfiguration = R"(
Section "ServerFlags"
  Option "AutoAddDevices" "false"
  Option "AutoAddGPU" "false"
  Option "DontVTSwitch" "true"
EndSection
Section "Device"
  Identifier "card"
  Driver "dummy"
  VideoRam 65536
EndSection
Section "Monitor"
  Identifier "projector"
  HorizSync 5.0 - 1000.0
  VertRefresh 5.0 - 200.0
  Modeline "60" 12.0 320 400 500 800 180 200 210 250
  Modeline "59.94" 11.988 320 400 500 800 180 200 210 250
  Modeline "75" 15.0 320 400 500 800 180 200 210 250
  Modeline "large" 24.0 640 680 720 800 360 380 400 500
EndSection
Section "Screen"
  Identifier "screen"
  Device "card"
  Monitor "projector"
  DefaultDepth 24
  SubSection "Display"
    Depth 24
    Modes "60" "59.94" "75" "large"
  EndSubSection
EndSection
)";

struct Free {
    void operator()(void* reply) const { std::free(reply); }
};
template <class Reply>
using Owned = std::unique_ptr<Reply, Free>;

template <class Reply, class Cookie>
Owned<Reply> answer(xcb_connection_t* connection, Reply* (*take)(xcb_connection_t*, Cookie, xcb_generic_error_t**),
                    Cookie cookie) {
    xcb_generic_error_t* error = nullptr;
    Owned<Reply> reply(take(connection, cookie, &error));
    FANTASCOPE_CHECK(reply != nullptr, fmt::format("the X server refuses: error {}", error == nullptr ? 0 : error->error_code));
    return reply;
}

double hertzOf(const xcb_randr_mode_info_t& mode) { return double(mode.dot_clock) / mode.htotal / mode.vtotal; }

using Resources = Owned<xcb_randr_get_screen_resources_reply_t>;

Resources resourcesOf(xcb_connection_t* connection, std::uint32_t root) {
    return answer(connection, xcb_randr_get_screen_resources_reply, xcb_randr_get_screen_resources(connection, root));
}

std::span<const xcb_randr_mode_info_t> modesOf(const Resources& resources) {
    return {xcb_randr_get_screen_resources_modes(resources.get()), resources->num_modes};
}

Owned<xcb_randr_get_output_info_reply_t> outputInfo(xcb_connection_t* connection, std::uint32_t output) {
    return answer(connection, xcb_randr_get_output_info_reply, xcb_randr_get_output_info(connection, output, XCB_CURRENT_TIME));
}

}  // namespace

Result<std::unique_ptr<Projectors>> Projectors::start() {
    std::unique_ptr<Projectors> projectors(new Projectors);
    const auto configuration = projectors->folder_.file("xorg.conf", kConfiguration);
    const std::string log = projectors->folder_ / "xorg.log";
    auto server = XServer::start(
        {"Xorg", "-config", configuration, "-logfile", log, "-nolisten", "tcp", "vt7", "-sharevts", "-novtswitch"});
    if (!server) {
        std::ifstream lines(log);
        std::string line, why = "it is not installed";
        while (std::getline(lines, line))
            if (line.find("(EE)") != std::string::npos) why = line;
        return Error(
            fmt::format("Xorg does not start ({}); it needs root and Debian's packages: apt-get install xserver-xorg-core "
                        "xserver-xorg-video-dummy",
                        why));
    }
    projectors->server_ = std::move(server).value();
    projectors->connect();
    return projectors;
}

void Projectors::connect() {
    auto connecting = drivers::connectingToX();
    connection_ = xcb_connect(nullptr, nullptr);
    connecting.unlock();
    FANTASCOPE_CHECK(xcb_connection_has_error(connection_) == 0, "the X server is gone");
    root_ = xcb_setup_roots_iterator(xcb_get_setup(connection_)).data->root;
    (void)answer(connection_, xcb_randr_query_version_reply, xcb_randr_query_version(connection_, 1, 5));
    (void)answer(connection_, xcb_xfixes_query_version_reply, xcb_xfixes_query_version(connection_, 5, 0));
}

void Projectors::crash() {
    xcb_disconnect(std::exchange(connection_, nullptr));
    server_->crash();
}

void Projectors::startAgain() {
    server_->startAgain();
    connect();
}

Projectors::~Projectors() {
    if (connection_ != nullptr) xcb_disconnect(connection_);
}

std::uint32_t Projectors::output(const std::string& connector) const {
    const auto resources = resourcesOf(connection_, root_);
    for (const std::uint32_t output :
         std::span(xcb_randr_get_screen_resources_outputs(resources.get()), resources->num_outputs)) {
        const auto info = outputInfo(connection_, output);
        if (std::string_view(reinterpret_cast<const char*>(xcb_randr_get_output_info_name(info.get())), info->name_len) ==
            connector)
            return output;
    }
    FANTASCOPE_CHECK(false, "no connector " + connector);
    return 0;
}

void Projectors::plug(const std::string& connector, std::span<const std::uint8_t> edid) {
    constexpr std::string_view kEdid = "EDID";
    const auto atom = answer(connection_, xcb_intern_atom_reply, xcb_intern_atom(connection_, 0, kEdid.size(), kEdid.data()));
    if (edid.empty())
        xcb_randr_delete_output_property(connection_, output(connector), atom->atom);
    else
        xcb_randr_change_output_property(connection_, output(connector), atom->atom, XCB_ATOM_INTEGER, 8, XCB_PROP_MODE_REPLACE,
                                         static_cast<std::uint32_t>(edid.size()), edid.data());
    (void)resourcesOf(connection_, root_);
}

void Projectors::switchOn(const std::string& connector, glm::ivec2 corner, glm::ivec2 size, double hertz, Looks looks) {
    const std::uint32_t which = output(connector);
    const auto resources = resourcesOf(connection_, root_);
    const auto modes = modesOf(resources);
    const auto mode = std::find_if(modes.begin(), modes.end(), [&](const xcb_randr_mode_info_t& one) {
        return glm::ivec2(one.width, one.height) == size && std::abs(hertzOf(one) - hertz) < 0.001;
    });
    FANTASCOPE_CHECK(mode != modes.end(), "no such mode");
    xcb_randr_add_output_mode(connection_, which, mode->id);  // the connector may have it already

    const auto info = outputInfo(connection_, which);
    const std::uint32_t crtc = info->crtc != 0 ? info->crtc : *xcb_randr_get_output_info_crtcs(info.get());
    const auto screen = answer(connection_, xcb_get_geometry_reply, xcb_get_geometry(connection_, root_));
    const glm::ivec2 grown(std::max<int>(screen->width, corner.x + size.x), std::max<int>(screen->height, corner.y + size.y));
    if (grown != glm::ivec2(screen->width, screen->height))
        xcb_randr_set_screen_size(connection_, root_, static_cast<std::uint16_t>(grown.x), static_cast<std::uint16_t>(grown.y),
                                  300, 200);
    const auto done = answer(
        connection_, xcb_randr_set_crtc_config_reply,
        xcb_randr_set_crtc_config(connection_, crtc, XCB_CURRENT_TIME, XCB_CURRENT_TIME, static_cast<std::int16_t>(corner.x),
                                  static_cast<std::int16_t>(corner.y), mode->id, XCB_RANDR_ROTATION_ROTATE_0, 1, &which));
    FANTASCOPE_CHECK(done->status == XCB_RANDR_SET_CONFIG_SUCCESS, fmt::format("the mode is refused: {}", done->status));
    if (looks == Looks::AndAfter) (void)resourcesOf(connection_, root_);
}

void Projectors::switchOff(const std::string& connector) {
    const auto info = outputInfo(connection_, output(connector));
    if (info->crtc == 0) return;
    (void)answer(connection_, xcb_randr_set_crtc_config_reply,
                 xcb_randr_set_crtc_config(connection_, info->crtc, XCB_CURRENT_TIME, XCB_CURRENT_TIME, 0, 0, 0,
                                           XCB_RANDR_ROTATION_ROTATE_0, 0, nullptr));
    (void)resourcesOf(connection_, root_);
}

std::optional<Projectors::Picture> Projectors::picture(const std::string& connector) const {
    const auto info = outputInfo(connection_, output(connector));
    if (info->crtc == 0) return std::nullopt;
    const auto crtc =
        answer(connection_, xcb_randr_get_crtc_info_reply, xcb_randr_get_crtc_info(connection_, info->crtc, XCB_CURRENT_TIME));
    const auto resources = resourcesOf(connection_, root_);
    for (const xcb_randr_mode_info_t& mode : modesOf(resources))
        if (mode.id == crtc->mode) return Picture{{crtc->x, crtc->y}, {crtc->width, crtc->height}, hertzOf(mode)};
    return std::nullopt;
}

int Projectors::blanksAfter() const {
    return answer(connection_, xcb_get_screen_saver_reply, xcb_get_screen_saver(connection_))->timeout;
}

bool Projectors::pointerSeenAt(glm::ivec2 pixel) const {
    xcb_warp_pointer(connection_, XCB_NONE, root_, 0, 0, 0, 0, static_cast<std::int16_t>(pixel.x),
                     static_cast<std::int16_t>(pixel.y));
    const auto image = answer(connection_, xcb_xfixes_get_cursor_image_reply, xcb_xfixes_get_cursor_image(connection_));
    const std::span pixels(xcb_xfixes_get_cursor_image_cursor_image(image.get()), std::size_t{image->width} * image->height);
    return std::any_of(pixels.begin(), pixels.end(), [](std::uint32_t argb) { return argb >> 24 != 0; });
}

}  // namespace fantascope
