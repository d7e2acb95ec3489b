#pragma once
// Models of how single values move, for the model of the cue engine. They share none of its code:
// each goes through everything that was ever wanted.

#include "show/cue_list.h"
#include "show/pattern_exchange.h"

#include "core/clock.h"
#include "core/wind.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <vector>

namespace fantascope::show {

using namespace std::chrono_literals;

// Light that moves to what is wanted at a constant rate.
class ModelLight {
public:
    void want(float level, Time at, Time fade) { wishes_.push_back({at, level, fade}); }
    float wantedAt(Time time) const {
        float level = 1;
        for (const Wish& wish : wishes_)
            if (wish.at <= time) level = wish.level;
        return level;
    }
    float at(Time time) const {
        double light = 1;
        for (std::size_t i = 0; i < wishes_.size() && wishes_[i].at <= time; ++i) {
            const Time until = i + 1 < wishes_.size() ? std::min(time, wishes_[i + 1].at) : time;
            const double most = wishes_[i].fade > Time{} ? seconds(until - wishes_[i].at) / seconds(wishes_[i].fade) : 1;
            light += std::clamp(wishes_[i].level - light, -most, most);
        }
        return static_cast<float>(light);
    }

private:
    struct Wish {
        Time at;
        float level;
        Time fade;
    };
    std::vector<Wish> wishes_;
};

// What has been played of a source at a constant rate of change of its speed: Simpson's rule is
// exact for the curves.
class ModelPlay {
public:
    float speedAt(Time time) const {
        const Change& now = changeAt(time);
        const double share = time - now.at >= now.length ? 1 : seconds(time - now.at) / seconds(now.length);
        const double bent[] = {share, share * share * (3 - 2 * share), share * share, 1 - (1 - share) * (1 - share)};
        return static_cast<float>(now.from + (now.to - now.from) * (time < now.at ? 1 : bent[static_cast<int>(now.curve)]));
    }
    void change(float speed, Time at, const Fade& fade) {
        const float from = speedAt(at);
        changes_.push_back({at, from, speed, speed > from ? fade.in : fade.out, fade.curve});
    }
    // Own time, seconds. Before the newest change it is as if its speed had always been.
    double own(Time time) const {
        double played = 0;
        for (std::size_t i = 0; i < changes_.size(); ++i) {
            const bool isLast = i + 1 == changes_.size();
            const Time from = changes_[i].at, until = isLast ? time : changes_[i + 1].at;
            const Time settled = from + changes_[i].length, bend = std::clamp(settled, from, std::max(from, until));
            if (i > 0) played += integral(i, from, bend);
            played += static_cast<double>(changes_[i].to) * seconds(until - (i > 0 ? bend : from));
        }
        return played;
    }
    // Nothing: never.
    std::optional<Time> whenIs(double own, Time from) const {
        Time before = from, after = from + 1000s;
        if (this->own(from) >= own) return from;
        if (this->own(after) < own) return std::nullopt;
        while (after - before > 1ns) {
            const Time middle = before + (after - before) / 2;
            (this->own(middle) < own ? before : after) = middle;
        }
        return after;
    }

private:
    struct Change {
        Time at;
        float from, to;
        Time length;
        Curve curve;
    };
    const Change& changeAt(Time time) const {
        const Change* now = &changes_.back();
        for (const Change& change : changes_)
            if (change.at <= time) now = &change;
        return *now;
    }
    double integral(std::size_t change, Time from, Time until) const {
        if (until <= from) return 0;
        const auto speed = [&](double share) {
            const double s = seconds(until - from) * share / seconds(changes_[change].length);
            const double bent[] = {s, s * s * (3 - 2 * s), s * s, 1 - (1 - s) * (1 - s)};
            return changes_[change].from +
                   (changes_[change].to - changes_[change].from) * bent[static_cast<int>(changes_[change].curve)];
        };
        return seconds(until - from) * (speed(0) + 4 * speed(0.5) + speed(1)) / 6;
    }
    std::vector<Change> changes_{{Time{}, 1, 1, Time{}, Curve::Linear}};
};

// The wind of an output. What is wanted moves along straight lines; what blows is the mean of what
// was wanted, weighed by two lags of half a second: by s e^(-s/lag) / lag^2, s ago.
class ModelWind {
public:
    // `start`: no earlier than that of the call before.
    void want(const WindWish& wish, Time start, Time fade) {
        const Values from = wanted(start);
        wishes_.push_back({start, seconds(fade), from, valuesOf(wish)});
    }
    // `lull`: how far the gusts have dropped.
    Wind at(Time time, double lull) const {
        constexpr double kPoints[] = {-0.9061798459, -0.5384693101, 0, 0.5384693101, 0.9061798459};
        constexpr double kWeights[] = {0.2369268851, 0.4786286705, 0.5688888889, 0.4786286705, 0.2369268851};
        constexpr double kLag = 0.5, kLongest = 12, kStep = 0.25;
        std::vector<double> bends{0};
        for (double ago = kStep; ago <= kLongest; ago += kStep) bends.push_back(ago);
        for (const Wish& wish : wishes_)
            for (const double bend : {seconds(time - wish.start), seconds(time - wish.start) - wish.fade})
                if (bend > 0 && bend < kLongest) bends.push_back(bend);
        std::ranges::sort(bends);
        Values blows{};
        for (std::size_t i = 0; i + 1 < bends.size(); ++i) {
            const double half = (bends[i + 1] - bends[i]) / 2, middle = (bends[i + 1] + bends[i]) / 2;
            for (std::size_t point = 0; point < std::size(kPoints) && half > 0; ++point) {
                const double ago = middle + half * kPoints[point];
                const double weight = half * kWeights[point] * ago * std::exp(-ago / kLag) / (kLag * kLag);
                const Values then = wanted(time - fromSeconds(ago));
                for (std::size_t value = 0; value < then.size(); ++value) blows[value] += weight * then[value];
            }
        }
        return {blows[0] * (1 - blows[1] * lull), blows[2], {blows[3], blows[4]}};
    }

private:
    using Values = std::array<double, 5>;  // strength, gusts, own direction, x, y
    struct Wish {
        Time start;
        double fade;
        Values from, to;
    };
    static Values valuesOf(const WindWish& wish) {
        const double angle = wish.direction.value_or(0);
        const bool has = wish.direction.has_value();
        return {wish.strength, wish.gusts, has ? 0. : 1., has ? std::cos(angle) : 0, has ? std::sin(angle) : 0};
    }
    Values wanted(Time time) const {
        Values values = valuesOf(WindWish());
        for (const Wish& wish : wishes_) {
            if (wish.start > time) break;
            const double share = wish.fade > 0 ? std::min(1., seconds(time - wish.start) / wish.fade) : 1;
            for (std::size_t i = 0; i < values.size(); ++i) values[i] = wish.from[i] + (wish.to[i] - wish.from[i]) * share;
        }
        return values;
    }
    std::vector<Wish> wishes_;
};

// Some numbers that move to where they are wanted at a constant speed, all in the same time.
template <std::size_t kCount>
class ModelGlide {
public:
    using Values = std::array<double, kCount>;
    explicit ModelGlide(const Values& first) { glides_.push_back({Time::min(), 0, first, first}); }
    // `way`: how long the way is from one place to another.
    void want(const Values& values, Time at, double speed, double (*way)(const Values&, const Values&)) {
        const Values from = this->at(at);
        glides_.push_back({at, way(from, values) / speed, from, values});
    }
    Values at(Time time) const {
        Values values = glides_.front().from;
        for (const Glide& glide : glides_) {
            if (glide.at > time) break;
            const double share = glide.length > 0 ? std::min(1., seconds(time - glide.at) / glide.length) : 1;
            for (std::size_t i = 0; i < kCount; ++i) values[i] = glide.from[i] + (glide.to[i] - glide.from[i]) * share;
        }
        return values;
    }

private:
    struct Glide {
        Time at;
        double length;
        Values from, to;
    };
    std::vector<Glide> glides_;
};

// The patterns of a source: each exchange leads from one to another, after the exchange before.
class ModelPatterns {
public:
    bool exchange(int number, Time at, Time fade) {
        const bool isAgain = !steps_.empty() && steps_.back().to == 0 && number == newest_;
        if (!isAgain && number != newest_ + 1) return false;
        newest_ = number;
        step(number, at, fade);
        return true;
    }
    void takeBack(Time at, Time fade) {
        if (!steps_.empty() && steps_.back().to != 0) step(0, at, fade);
    }
    // The share of each pattern that is seen, and the newest exchange that has begun.
    std::pair<std::map<int, double>, int> at(Time time) const {
        std::map<int, double> shares{{0, 1}};
        int begun = 0;
        for (const auto& [at, fade, from, to] : steps_) {
            if (at > time) break;
            const double s = time - at >= fade ? 1 : seconds(time - at) / seconds(fade), share = s * s * (3 - 2 * s);
            shares = {{from, 1 - share}};
            shares[to] += share;
            begun = std::max(begun, to);
        }
        return {shares, begun};
    }

private:
    struct Step {
        Time at, fade;
        int from, to;  // 0: the source's own pattern
    };
    void step(int to, Time at, Time fade) {
        const Time begin = steps_.empty() ? at : std::max(at, steps_.back().at + steps_.back().fade);
        steps_.push_back({begin, fade, steps_.empty() ? 0 : steps_.back().to, to});
    }
    std::vector<Step> steps_;
    int newest_ = 0;
};

}  // namespace fantascope::show
