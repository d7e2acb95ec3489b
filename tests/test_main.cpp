// The main() of every test program that has none of its own.

#include "test_run.h"

int main(int count, char** arguments) { return fantascope::runTests(count, arguments); }
