#include "drivers/common/back_off.h"

#include <algorithm>

namespace fantascope::drivers {

Time BackOff::failed(Time now) {
    const bool lived = began_ && now - *began_ >= latest_;
    began_.reset();
    pause_ = lived || pause_ == Time::zero() ? soonest_ : std::min(2 * pause_, latest_);
    return pause_;
}

}  // namespace fantascope::drivers
