#define DOCTEST_CONFIG_IMPLEMENT
#include "files/data_folder.hpp"

#include <doctest/doctest.h>

#include <cstdlib>

int main(int argc, char** argv) {
    doctest::Context context(argc, argv);
    const int result = context.run();
    constexpr int skipped = 77; // SKIP_RETURN_CODE of tactnet_test
    return result == EXIT_SUCCESS && support::data_missing ? skipped : result;
}
