// The whole program of a Cortex-M that decides without a network: the same outcome as on the machine that
// built it, which TEST_HEADER holds as `expected`.

#include "decisions.hpp"

#include "costs.hpp"

#include TEST_HEADER

namespace {

decisions::life all;

} // namespace

int main() {
    const bool agrees = all.play().agrees(expected);
#ifdef SEMIHOSTING
    if (!agrees)
        return 2;
    all.begin_touch();
    tell_costs([] { return all.repeat(); });
    return 0;
#else
    for (;;)
        if (!agrees || !all.repeat())
            return 1;
#endif
}
