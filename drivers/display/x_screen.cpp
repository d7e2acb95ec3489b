#include "drivers/display/x_screen.h"

#include "drivers/display/x_connecting.h"

#include <fmt/format.h>
#include <xcb/dpms.h>
#include <xcb/randr.h>
#include <xcb/xcb.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

namespace fantascope::drivers {
namespace {

struct Free {
    void operator()(void* reply) const { std::free(reply); }
};
template <class Reply>
using Owned = std::unique_ptr<Reply, Free>;

// The reply to a request; nothing: an error, or no connection any more.
template <class Reply, class Cookie>
Owned<Reply> answer(xcb_connection_t* connection, Reply* (*take)(xcb_connection_t*, Cookie, xcb_generic_error_t**),
                    Cookie cookie) {
    xcb_generic_error_t* error = nullptr;
    Owned<Reply> reply(take(connection, cookie, &error));
    std::free(error);
    return reply;
}

Error gone() { return Error("the X server has ended or closed the connection; the picture is back once the X server is"); }

Monitor::Mode modeOf(const xcb_randr_mode_info_t& info) {
    const bool interlaced = info.mode_flags & XCB_RANDR_MODE_FLAG_INTERLACE;
    double lines = info.vtotal;
    if (info.mode_flags & XCB_RANDR_MODE_FLAG_DOUBLE_SCAN) lines *= 2;
    if (interlaced) lines /= 2;
    const double pixels = lines * info.htotal;
    return {info.id, {info.width, info.height}, pixels > 0 ? info.dot_clock / pixels : 0, interlaced};
}

std::string textOf(const std::uint8_t* name, int length) {
    return {reinterpret_cast<const char*>(name), static_cast<std::size_t>(length)};
}

using Modes = std::map<std::uint32_t, Monitor::Mode>;        // by the X server's number
using Pictures = std::map<std::uint32_t, Monitor::Picture>;  // by CRTC; those that are on

// `edid` may be null.
Monitor monitorOf(std::uint32_t outputId, const xcb_randr_get_output_info_reply_t& output,
                  const xcb_randr_get_output_property_reply_t* edid, const Modes& modes, const Pictures& pictures) {
    Monitor monitor;
    monitor.connector = textOf(xcb_randr_get_output_info_name(&output), output.name_len);
    monitor.outputId = outputId;
    // Some connectors cannot detect a monitor. They report "unknown", which counts as connected.
    monitor.connected = output.connection != XCB_RANDR_CONNECTION_DISCONNECTED;
    if (edid != nullptr && edid->format == 8)
        monitor.identity = identityFromEdid({xcb_randr_get_output_property_data(edid), edid->num_items});
    for (const std::uint32_t id : std::span(xcb_randr_get_output_info_modes(&output), output.num_modes)) {
        const auto mode = modes.find(id);
        monitor.modes.push_back(mode == modes.end() ? Monitor::Mode{} : mode->second);
    }
    const std::span possible(xcb_randr_get_output_info_crtcs(&output), output.num_crtcs);
    monitor.possibleCrtcs.assign(possible.begin(), possible.end());
    if (const auto on = pictures.find(output.crtc); on != pictures.end()) monitor.on = on->second;
    return monitor;
}

}  // namespace

struct XScreen::Wakefulness {
    Owned<xcb_get_screen_saver_reply_t> saver;
    bool dpms = false;  // the monitors' power saving was on
};

Result<std::unique_ptr<XScreen>> XScreen::open() {
    int number = 0;
    auto connecting = connectingToX();
    xcb_connection_t* const connection = xcb_connect(nullptr, &number);
    connecting.unlock();
    const auto refuse = [&](const std::string& why) {
        xcb_disconnect(connection);
        return Error(why);
    };
    if (xcb_connection_has_error(connection) != 0) return refuse("no X server answers; set DISPLAY, or start one");
    auto roots = xcb_setup_roots_iterator(xcb_get_setup(connection));
    for (int screen = 0; screen < number && roots.rem > 1; ++screen) xcb_screen_next(&roots);
    const xcb_query_extension_reply_t* const randr = xcb_get_extension_data(connection, &xcb_randr_id);
    if (randr == nullptr || !randr->present)
        return refuse("the X server has no RandR extension; use one that has, as Debian's Xorg");
    const auto version = answer(connection, xcb_randr_query_version_reply, xcb_randr_query_version(connection, 1, 5));
    if (!version || std::pair(version->major_version, version->minor_version) < std::pair(1u, 3u))
        return refuse("the X server's RandR is older than 1.3; update it");

    std::unique_ptr<XScreen> screen(new XScreen(connection, roots.data->root));
    screen->firstRandrEvent_ = randr->first_event;
    screen->size_ = {roots.data->width_in_pixels, roots.data->height_in_pixels};
    constexpr std::string_view kEdid = "EDID";
    if (const auto atom = answer(connection, xcb_intern_atom_reply, xcb_intern_atom(connection, 0, kEdid.size(), kEdid.data())))
        screen->edid_ = atom->atom;
    xcb_randr_select_input(connection, roots.data->root,
                           XCB_RANDR_NOTIFY_MASK_SCREEN_CHANGE | XCB_RANDR_NOTIFY_MASK_CRTC_CHANGE |
                               XCB_RANDR_NOTIFY_MASK_OUTPUT_CHANGE | XCB_RANDR_NOTIFY_MASK_OUTPUT_PROPERTY);
    screen->probeConnectors();  // harmless before the show
    return screen;
}

std::string XScreen::serverName() {
    char* named = nullptr;
    int display = 0;
    if (xcb_parse_display(nullptr, &named, &display, nullptr) == 0) return "";
    const Owned<char> host(named);
    return fmt::format("{}:{}", host.get(), display);
}

XScreen::XScreen(xcb_connection_t* connection, std::uint32_t root) : connection_(connection), root_(root) {}

XScreen::~XScreen() {
    if (before_ && before_->saver)
        xcb_set_screen_saver(connection_, static_cast<std::int16_t>(before_->saver->timeout),
                             static_cast<std::int16_t>(before_->saver->interval), before_->saver->prefer_blanking,
                             before_->saver->allow_exposures);
    if (before_ && before_->dpms) xcb_dpms_enable(connection_);
    (void)answer(connection_, xcb_get_input_focus_reply,
                 xcb_get_input_focus(connection_));  // waits until the X server has handled the above
    xcb_disconnect(connection_);
}

int XScreen::fileDescriptor() const { return xcb_get_file_descriptor(connection_); }

Result<bool> XScreen::changed() {
    bool any = false;
    while (const Owned<xcb_generic_event_t> event{xcb_poll_for_event(connection_)}) {
        const int type = event->response_type & 0x7F;  // the highest bit means: sent by a client
        if (type < firstRandrEvent_ || type > firstRandrEvent_ + XCB_RANDR_NOTIFY) continue;
        any = true;
        if (type != firstRandrEvent_ + XCB_RANDR_NOTIFY) continue;
        const auto& notice = reinterpret_cast<const xcb_randr_notify_event_t&>(*event);
        if (notice.subCode == XCB_RANDR_NOTIFY_OUTPUT_CHANGE && notice.u.oc.connection == XCB_RANDR_CONNECTION_DISCONNECTED)
            unplugged_.insert(notice.u.oc.output);
    }
    if (xcb_connection_has_error(connection_) != 0) return gone();
    return any;
}

void XScreen::probeConnectors() {
    (void)answer(connection_, xcb_randr_get_screen_resources_reply, xcb_randr_get_screen_resources(connection_, root_));
}

Result<std::vector<Monitor>> XScreen::monitors() {
    const auto range =
        answer(connection_, xcb_randr_get_screen_size_range_reply, xcb_randr_get_screen_size_range(connection_, root_));
    const auto screen = answer(connection_, xcb_get_geometry_reply, xcb_get_geometry(connection_, root_));
    const auto resources = answer(connection_, xcb_randr_get_screen_resources_current_reply,
                                  xcb_randr_get_screen_resources_current(connection_, root_));
    if (!range || !screen || !resources) return gone();
    largest_ = {range->max_width, range->max_height};
    size_ = {screen->width, screen->height};
    configured_ = resources->config_timestamp;

    Modes modes;
    for (const xcb_randr_mode_info_t& info :
         std::span(xcb_randr_get_screen_resources_current_modes(resources.get()), resources->num_modes))
        modes[info.id] = modeOf(info);
    const std::span crtcs(xcb_randr_get_screen_resources_current_crtcs(resources.get()), resources->num_crtcs);
    const std::span outputs(xcb_randr_get_screen_resources_current_outputs(resources.get()), resources->num_outputs);

    // All requests go out before the first reply is read, so that the X server is waited for once.
    std::vector<xcb_randr_get_crtc_info_cookie_t> crtcsAsked;
    std::vector<xcb_randr_get_output_info_cookie_t> outputsAsked;
    std::vector<xcb_randr_get_output_property_cookie_t> edidsAsked;
    for (const std::uint32_t crtc : crtcs) crtcsAsked.push_back(xcb_randr_get_crtc_info(connection_, crtc, configured_));
    for (const std::uint32_t output : outputs) {
        outputsAsked.push_back(xcb_randr_get_output_info(connection_, output, configured_));
        constexpr std::uint32_t kBaseBlock = 128 / 4;
        edidsAsked.push_back(
            xcb_randr_get_output_property(connection_, output, edid_, XCB_GET_PROPERTY_TYPE_ANY, 0, kBaseBlock, 0, 0));
    }

    Pictures pictures;
    bool whole = true;
    for (std::size_t i = 0; i < crtcs.size(); ++i) {
        const auto crtc = answer(connection_, xcb_randr_get_crtc_info_reply, crtcsAsked[i]);
        whole = whole && crtc && crtc->status == XCB_RANDR_SET_CONFIG_SUCCESS;
        if (crtc && crtc->mode != 0)
            pictures[crtcs[i]] = {crtcs[i], {{crtc->x, crtc->y}, {crtc->width, crtc->height}}, modes[crtc->mode]};
    }
    std::vector<Monitor> monitors;
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        const auto output = answer(connection_, xcb_randr_get_output_info_reply, outputsAsked[i]);
        const auto edid = answer(connection_, xcb_randr_get_output_property_reply, edidsAsked[i]);
        whole = whole && output && output->status == XCB_RANDR_SET_CONFIG_SUCCESS;
        if (!output) continue;
        monitors.push_back(monitorOf(outputs[i], *output, edid.get(), modes, pictures));
        monitors.back().unplugged = unplugged_.contains(outputs[i]);
    }
    if (xcb_connection_has_error(connection_) != 0) return gone();
    if (!whole) return Error("the monitors are changing; trying again");
    unplugged_.clear();

    if (!noteOn(monitors)) return monitors;
    probeConnectors();
    return this->monitors();
}

bool XScreen::noteOn(const std::vector<Monitor>& monitors) {
    // If a connector without a monitor was switched on, whoever did so knows better: the X server's
    // knowledge of the connector is old.
    bool stale = false;
    std::set<std::uint32_t> on;
    for (const Monitor& monitor : monitors) {
        if (!monitor.on) continue;
        on.insert(monitor.outputId);
        stale = stale || (!monitor.connected && !on_.contains(monitor.outputId));
    }
    on_ = std::move(on);
    return stale;
}

Result<void> XScreen::grow(glm::ivec2 size) {
    const glm::ivec2 larger(std::max(size.x, size_.x), std::max(size.y, size_.y));
    if (larger == size_) return {};
    const auto millimetres = [](int pixels) {
        return static_cast<std::uint32_t>(pixels * 254 / 960);
    };  // at the usual 96 dots per inch
    const Owned<xcb_generic_error_t> error(xcb_request_check(
        connection_,
        xcb_randr_set_screen_size_checked(connection_, root_, static_cast<std::uint16_t>(larger.x),
                                          static_cast<std::uint16_t>(larger.y), millimetres(larger.x), millimetres(larger.y))));
    if (error) return Error(fmt::format("the X screen cannot become {} x {} pixels", larger.x, larger.y));
    size_ = larger;
    return {};
}

XScreen::Applied XScreen::apply(const Placement::Change& change) {
    const auto done =
        answer(connection_, xcb_randr_set_crtc_config_reply,
               xcb_randr_set_crtc_config(connection_, change.crtcId, XCB_CURRENT_TIME, configured_,
                                         static_cast<std::int16_t>(change.corner.x), static_cast<std::int16_t>(change.corner.y),
                                         change.modeId, XCB_RANDR_ROTATION_ROTATE_0, 1, &change.outputId));
    if (!done) return Applied::Refused;
    switch (done->status) {
        case XCB_RANDR_SET_CONFIG_SUCCESS:
            return Applied::Done;
        case XCB_RANDR_SET_CONFIG_FAILED:
            return Applied::Refused;
        default:
            return Applied::TooLate;
    }
}

void XScreen::keepAwake() {
    auto saver = answer(connection_, xcb_get_screen_saver_reply, xcb_get_screen_saver(connection_));
    const xcb_query_extension_reply_t* const extension = xcb_get_extension_data(connection_, &xcb_dpms_id);
    Owned<xcb_dpms_info_reply_t> dpms;
    if (extension != nullptr && extension->present) dpms = answer(connection_, xcb_dpms_info_reply, xcb_dpms_info(connection_));

    if (saver && saver->timeout != 0) xcb_set_screen_saver(connection_, 0, 0, XCB_BLANKING_NOT_PREFERRED, XCB_EXPOSURES_DEFAULT);
    xcb_force_screen_saver(connection_, XCB_SCREEN_SAVER_RESET);
    if (dpms && dpms->state) {
        if (dpms->power_level != XCB_DPMS_DPMS_MODE_ON) xcb_dpms_force_level(connection_, XCB_DPMS_DPMS_MODE_ON);
        xcb_dpms_disable(connection_);
    }
    if (!before_) before_ = std::make_unique<Wakefulness>(Wakefulness{std::move(saver), dpms && dpms->state});
    xcb_flush(connection_);
}

}  // namespace fantascope::drivers
