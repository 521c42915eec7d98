#pragma once

#include <string>

namespace support {

/// What a call throws, as text. Exceptions of other types go through.
template <class Error, class Action>
std::string error_of(Action&& action) {
    try {
        action();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

} // namespace support
