#pragma once
// What the parts of outputs_bench share.

#include "render/output_renderer.h"
#include "show/show_state.h"

#include "device/display_sink.h"

#include "core/clock.h"
#include "core/result.h"
#include "crystals.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace fantascope::render {

struct Settings {
    std::string driver = "headless";
    int outputs = 3, width = 640, height = 360, crystals = 333, people = 0, samples = 4, frames = 150, failing = 0;
    double rate = 30, seconds = 30;  // Hz; s per run
};

// An additional feature of a frame.
struct Variant {
    std::string name;
    std::function<void(OutputRenderer::Options&)> set;
};
std::vector<Variant> variants();

// Of one layer, the only source.
inline const show::OutputState kLook{{{0, 1.0f}}};

// Ends the benchmark on an error.
void must(const Result<void>& result);
double processorSeconds();
// A display of the settings' driver whose context is current.
std::unique_ptr<DisplaySink> opened(const Settings& settings, int number, Clock& clock);
std::unique_ptr<OutputRenderer> rendererOf(const Settings& settings, const PatternSource& source, const Variant& variant);

void compareCost(const Settings& settings);
void compareThreads(const Settings& settings);

}  // namespace fantascope::render
