#include "console/waiting.hpp"

#include "console/standard_streams.hpp"

#include <chrono>
#include <interrupt.hpp>
#include <thread>
#include <utility>

bool wait_until(const std::function<bool()>& ready, const std::string& sentence) {
    for (bool told = false; !ready(); std::this_thread::sleep_for(std::chrono::milliseconds(200))) {
        if (interrupted())
            return false;
        if (!std::exchange(told, true))
            tell("{}\n", sentence);
    }
    return true;
}
