#include "units.hpp"

#include <every_header.hpp>

std::string_view arch_of_scalar() {
    return TACTNET_TEXT(TACTNET_ARCH);
}
