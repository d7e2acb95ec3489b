#include "drivers/common/back_off.h"

#include <algorithm>

namespace fantascope::drivers {

Time BackOff::failed(Time now) {
    const bool lived = succeeded_ && now - *succeeded_ >= maxPause_;
    succeeded_.reset();
    pause_ = lived || pause_ == Time::zero() ? minPause_ : std::min(2 * pause_, maxPause_);
    return pause_;
}

}  // namespace fantascope::drivers
