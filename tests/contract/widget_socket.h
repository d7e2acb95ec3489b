#pragma once

#include "contract/pseudo_terminal.h"
#include "contract/widget.h"
#include "scratch_folder.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace fantascope::contract {

// A place for a device with a serial line: its device file comes and goes with it.
template <class FarEnd>
class Socket {
public:
    // `make`: makes the far end on its end of the line.
    explicit Socket(std::function<std::unique_ptr<FarEnd>(int line)> make, std::string name = "ttyUSB0")
        : make_(std::move(make)), name_(std::move(name)) {
        plugIn();
    }

    void plugIn() {
        line_.emplace();
        farEnd_ = make_(line_->far());
        std::filesystem::create_symlink(line_->name(), file());
    }
    void unplug() {
        std::filesystem::remove(file());
        farEnd_.reset();
        line_.reset();
    }
    bool in() const { return line_.has_value(); }
    bool hasTakenAll() const { return line_->isTaken(); }
    FarEnd& farEnd() { return *farEnd_; }
    PseudoTerminal& line() { return *line_; }
    std::filesystem::path file() const { return folder_ / name_; }
    // The key by which a site file names it.
    std::string key() const { return "port: " + file().string(); }

private:
    const std::function<std::unique_ptr<FarEnd>(int)> make_;
    const std::string name_;
    ScratchFolder folder_;
    std::optional<PseudoTerminal> line_;
    std::unique_ptr<FarEnd> farEnd_;
};

class WidgetSocket : public Socket<Widget> {
public:
    explicit WidgetSocket(const std::string& number = "01234567")
        : Socket([number](int line) { return std::make_unique<Widget>(line, number); }) {}
    Widget& widget() { return farEnd(); }
};

}  // namespace fantascope::contract
