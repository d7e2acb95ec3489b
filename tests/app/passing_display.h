#pragma once

#include "device/display_sink.h"

#include <memory>
#include <utility>

namespace fantascope::app {

// A display that hands every call on to another. A test overrides what its display does otherwise.
class PassingDisplay : public DisplaySink {
public:
    explicit PassingDisplay(std::unique_ptr<DisplaySink> display) : display_(std::move(display)) {}

    DeviceStatus status() const override { return display_->status(); }
    glm::ivec2 size() const override { return display_->size(); }
    double refreshRate() const override { return display_->refreshRate(); }
    std::int64_t nextRefresh() const override { return display_->nextRefresh(); }
    Time refreshTime(std::int64_t number) const override { return display_->refreshTime(number); }
    bool poll() override { return display_->poll(); }
    int context() const override { return display_->context(); }
    Result<void> makeCurrent() override { return display_->makeCurrent(); }
    void release() override { display_->release(); }
    unsigned framebuffer() const override { return display_->framebuffer(); }
    Result<void> finish() override { return display_->finish(); }
    Result<Shown> present() override { return display_->present(); }
    Result<Shown> presentWith(Time leading) override { return display_->presentWith(leading); }

protected:
    std::unique_ptr<DisplaySink> display_;
};

}  // namespace fantascope::app
