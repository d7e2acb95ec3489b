#include "drivers/onlooker.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>

namespace fantascope {

struct Onlooker::Impl {
    Display* display = XOpenDisplay(nullptr);

    Window window(const std::string& title) const {
        Window root = 0, parent = 0, *children = nullptr, found = 0;
        unsigned count = 0;
        XQueryTree(display, DefaultRootWindow(display), &root, &parent, &children, &count);
        for (unsigned i = 0; i < count; ++i) {
            char* name = nullptr;
            if (XFetchName(display, children[i], &name) != 0 && title == name) found = children[i];
            XFree(name);
        }
        XFree(children);
        return found;
    }
    XWindowAttributes attributes(const std::string& title) const {
        XWindowAttributes attributes{};
        XGetWindowAttributes(display, window(title), &attributes);
        return attributes;
    }
};

Onlooker::Onlooker() : impl_(new Impl) {}

Onlooker::~Onlooker() {
    XCloseDisplay(impl_->display);
    delete impl_;
}

void Onlooker::close(const std::string& title) {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = impl_->window(title);
    event.xclient.message_type = XInternAtom(impl_->display, "WM_PROTOCOLS", False);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(XInternAtom(impl_->display, "WM_DELETE_WINDOW", False));
    XSendEvent(impl_->display, event.xclient.window, False, NoEventMask, &event);
    XSync(impl_->display, False);
}

bool Onlooker::isVisible(const std::string& title) { return impl_->attributes(title).map_state == IsViewable; }

glm::ivec2 Onlooker::sizeOf(const std::string& title) {
    const XWindowAttributes attributes = impl_->attributes(title);
    return {attributes.width, attributes.height};
}

unsigned long Onlooker::colourAt(const std::string& title, int x, int y) {
    XImage* image = XGetImage(impl_->display, impl_->window(title), x, y, 1, 1, AllPlanes, ZPixmap);
    const unsigned long colour = XGetPixel(image, 0, 0) & 0xffffff;
    XDestroyImage(image);
    return colour;
}

}  // namespace fantascope
