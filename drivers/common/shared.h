#pragma once

#include <map>
#include <memory>
#include <mutex>

namespace fantascope::drivers {

// Things that several devices share: the two directions of a widget, the modules on a bus, the one
// socket of a protocol. Everybody who asks by the same key gets the same thing, as long as somebody
// holds it. Thread: thread-safe; one thread makes a thing while the others wait.
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
