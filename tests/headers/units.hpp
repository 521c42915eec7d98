#pragma once

#include <string_view>

// What each unit of this program says the library's inline namespace is called.
std::string_view arch_of_first();
std::string_view arch_of_second();
std::string_view arch_of_scalar();

#define TACTNET_TEXT_OF(name) #name
#define TACTNET_TEXT(name) TACTNET_TEXT_OF(name)
