// expect: anything
#include <tactnet/version.hpp>

int main() {
    return TACTNET_VERSION_MAJOR;
}
