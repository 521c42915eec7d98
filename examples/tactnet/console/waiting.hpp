#pragma once

#include <functional>
#include <string>

/// Asks until it is `ready`, and says once what is waited for. False if interrupted.
bool wait_until(const std::function<bool()>& ready, const std::string& sentence);
