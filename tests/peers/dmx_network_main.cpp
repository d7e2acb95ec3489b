#include "peers/own_network.h"
#include "test_run.h"

int main(int count, char** arguments) {
    fantascope::peers::enterOwnNetwork();  // before anything starts a thread
    return fantascope::runTests(count, arguments);
}
