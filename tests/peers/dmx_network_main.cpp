#include "peers/own_network.h"

#include <gmock/gmock.h>

int main(int count, char** arguments) {
    fantascope::peers::enterOwnNetwork();  // before anything starts a thread
    testing::InitGoogleMock(&count, arguments);
    return RUN_ALL_TESTS();
}
