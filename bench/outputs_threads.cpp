#include "app/parts/part.h"

#include "outputs.h"

#include <epoxy/egl.h>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <barrier>
#include <map>
#include <thread>

namespace fantascope::render {
namespace {

// What happened at each refresh, by the clock that all outputs share.
struct Pace {
    std::vector<std::vector<std::int64_t>> shown;  // shown refreshes, by output
    double processor = 0;                          // seconds
    std::vector<double> workMs;                    // per frame, from its beginning to its completion
};

void tell(const std::string& name, const Settings& settings, Pace pace) {
    std::map<std::int64_t, std::size_t> outputsAt;
    std::int64_t first = 0, last = INT64_MAX, frames = 0;
    for (const auto& refreshes : pace.shown) {
        first = std::max(first, refreshes.front());
        last = std::min(last, refreshes.back());
    }
    for (const auto& refreshes : pace.shown)
        for (const std::int64_t refresh : refreshes)
            if (refresh >= first && refresh <= last) ++outputsAt[refresh], ++frames;
    const std::int64_t refreshes = last - first + 1;
    std::int64_t torn = 0;
    for (const auto& [refresh, count] : outputsAt) torn += count != pace.shown.size();
    std::sort(pace.workMs.begin(), pace.workMs.end());
    const auto quantile = [&](double p) {
        return pace.workMs[static_cast<std::size_t>(p * static_cast<double>(pace.workMs.size() - 1))];
    };
    fmt::print("{:<20}{:>9}{:>9}{:>9}{:>10.1f}{:>10.1f}{:>12.1f}\n", name, refreshes, refreshes * settings.outputs - frames, torn,
               quantile(0.5), quantile(0.99), 1e3 * pace.processor / static_cast<double>(refreshes));
}

Pace oneThread(const Settings& settings, const PatternSource& source) {
    SteadyClock clock;
    std::vector<std::unique_ptr<DisplaySink>> sinks;
    std::vector<std::unique_ptr<OutputRenderer>> renderers;
    Pace pace;
    for (int i = 0; i < settings.outputs; ++i) {
        sinks.push_back(opened(settings, i, clock));
        renderers.push_back(rendererOf(settings, source, variants()[0]));
        must(renderers.back()->warmUp(sinks.back()->framebuffer()));
        pace.shown.emplace_back();
    }
    const double processor = processorSeconds();
    for (const Time end = clock.now() + fromSeconds(settings.seconds); clock.now() < end;) {
        const Time began = clock.now(), due = sinks[0]->refreshTime(sinks[0]->nextRefresh());
        for (std::size_t i = 0; i < sinks.size(); ++i) {
            must(sinks[i]->makeCurrent());
            renderers[i]->draw(kLook, {}, due, sinks[i]->framebuffer());
        }
        for (const auto& sink : sinks) must(sink->finish());
        pace.workMs.push_back(1e3 * seconds(clock.now() - began));
        const Shown leading = valueOf(sinks[0]->present());
        pace.shown[0].push_back(leading.refresh);
        for (std::size_t i = 1; i < sinks.size(); ++i)
            pace.shown[i].push_back(valueOf(sinks[i]->presentWith(leading.at)).refresh);
    }
    pace.processor = processorSeconds() - processor;
    for (std::size_t i = 0; i < sinks.size(); ++i) {
        must(sinks[i]->makeCurrent());
        renderers[i].reset();
    }
    return pace;
}

Pace threadPerOutput(const Settings& settings, const PatternSource& source) {
    SteadyClock clock;
    Pace pace;
    pace.shown.resize(static_cast<std::size_t>(settings.outputs));
    std::vector<std::vector<double>> work(pace.shown.size());
    std::atomic<int> ready = 0;
    std::atomic<bool> begin = false;
    double processor = 0;
    {
        std::vector<std::jthread> threads;
        for (std::size_t i = 0; i < pace.shown.size(); ++i)
            threads.emplace_back([&, i] {
                const auto sink = opened(settings, static_cast<int>(i), clock);
                auto renderer = rendererOf(settings, source, variants()[0]);
                must(renderer->warmUp(sink->framebuffer()));
                ++ready;
                begin.wait(false);
                for (const Time end = clock.now() + fromSeconds(settings.seconds); clock.now() < end;) {
                    const Time began = clock.now();
                    must(sink->makeCurrent());
                    renderer->draw(kLook, {}, sink->refreshTime(sink->nextRefresh()), sink->framebuffer());
                    must(sink->finish());
                    work[i].push_back(1e3 * seconds(clock.now() - began));
                    pace.shown[i].push_back(valueOf(sink->present()).refresh);
                }
                renderer.reset();
            });
        while (ready < settings.outputs) std::this_thread::yield();
        processor = processorSeconds();
        begin = true;
        begin.notify_all();
    }
    pace.processor = processorSeconds() - processor;
    for (const auto& one : work) pace.workMs.insert(pace.workMs.end(), one.begin(), one.end());
    return pace;
}

// One thread per output draws, and one thread presents: it waits until all pictures are complete.
Pace drawnOnThreads(const Settings& settings, const PatternSource& source) {
    SteadyClock clock;
    Pace pace;
    std::vector<std::unique_ptr<DisplaySink>> sinks;
    std::vector<std::unique_ptr<OutputRenderer>> renderers;
    const auto letGo = [] { eglMakeCurrent(eglGetCurrentDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); };
    for (int i = 0; i < settings.outputs; ++i) {
        sinks.push_back(opened(settings, i, clock));
        renderers.push_back(rendererOf(settings, source, variants()[0]));
        must(renderers.back()->warmUp(sinks.back()->framebuffer()));
        letGo();
        pace.shown.emplace_back();
    }
    std::barrier frame(settings.outputs);
    bool ended = false;
    Time due{};
    const auto draw = [&](std::size_t i) {
        must(sinks[i]->makeCurrent());
        renderers[i]->draw(kLook, {}, due, sinks[i]->framebuffer());
        must(sinks[i]->finish());
        letGo();
    };
    const double processor = processorSeconds();
    {
        std::vector<std::jthread> threads;
        for (std::size_t i = 1; i < sinks.size(); ++i)
            threads.emplace_back([&, i] {
                for (frame.arrive_and_wait(); !ended; frame.arrive_and_wait()) {
                    draw(i);
                    frame.arrive_and_wait();
                }
            });
        for (const Time end = clock.now() + fromSeconds(settings.seconds); clock.now() < end;) {
            const Time began = clock.now();
            due = sinks[0]->refreshTime(sinks[0]->nextRefresh());
            frame.arrive_and_wait();
            draw(0);
            frame.arrive_and_wait();
            pace.workMs.push_back(1e3 * seconds(clock.now() - began));
            const Shown leading = valueOf(sinks[0]->present());
            pace.shown[0].push_back(leading.refresh);
            for (std::size_t i = 1; i < sinks.size(); ++i)
                pace.shown[i].push_back(valueOf(sinks[i]->presentWith(leading.at)).refresh);
            letGo();
        }
        ended = true;
        frame.arrive_and_wait();
    }
    pace.processor = processorSeconds() - processor;
    for (std::size_t i = 0; i < sinks.size(); ++i) {
        must(sinks[i]->makeCurrent());
        renderers[i].reset();
    }
    return pace;
}

}  // namespace

void compareThreads(const Settings& settings) {
    app::setThreadRank(app::Rank::Render);  // as the program does
    const PatternSource source = swayingCrystals({settings.crystals});
    fmt::print(
        "{} outputs of {} x {} at {} Hz, {} triangles each, {} s of each kind; torn: refreshes that some outputs met and others "
        "did not;\n"
        "work: from a frame's beginning to its completion, of all outputs or of one\n",
        settings.outputs, settings.width, settings.height, settings.rate, settings.crystals * 60, settings.seconds);
    fmt::print("{:<20}{:>9}{:>9}{:>9}{:>10}{:>10}{:>12}\n", "", "refreshes", "late", "torn", "work p50", "p99 ms", "CPU ms/ref.");
    for (int run = 0; run < 2; ++run) {
        tell("one thread", settings, oneThread(settings, source));
        tell("thread per output", settings, threadPerOutput(settings, source));
        tell("drawn on threads", settings, drawnOnThreads(settings, source));
    }
}

}  // namespace fantascope::render
