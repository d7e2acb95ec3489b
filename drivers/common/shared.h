#pragma once

#include <map>
#include <memory>
#include <mutex>

namespace fantascope::drivers {

// What several devices use together, such as the two ends of one widget, the modules on one bus,
// the socket that a protocol has but one of: everybody who asks by the same key is given the same
// thing, for as long as anybody holds it. Thread: thread-safe; a thing is made while others wait.
template <class Key, class Thing>
class Shared {
public:
    template <class Make>
    std::shared_ptr<Thing> get(const Key& key, Make make) {
        const std::lock_guard lock(mutex_);
        std::weak_ptr<Thing>& known = things_[key];
        std::shared_ptr<Thing> thing = known.lock();
        if (!thing) known = thing = make();
        return thing;
    }

private:
    std::mutex mutex_;
    std::map<Key, std::weak_ptr<Thing>> things_;
};

}  // namespace fantascope::drivers
