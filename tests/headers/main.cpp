// That this program links is the test: a function defined in a header without inline would be there twice.

#include <cstdio>
#include <every_header.hpp>
#include <string_view>

// See unit.cpp.in.
std::string_view arch_of_first();
std::string_view arch_of_second();
std::string_view arch_of_scalar();

int main() {
    std::printf("%s, %s, %s\n", arch_of_first().data(), arch_of_second().data(), arch_of_scalar().data());
    const bool right = arch_of_first() == arch_of_second() && arch_of_scalar().starts_with("for_scalar");
    return right ? 0 : 1;
}
