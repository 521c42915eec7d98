// The whole program of a Cortex-M that decides without a network: the same outcome as on the machine that
// built it, which TEST_HEADER holds as `expected`.

#include "decisions.hpp"

#include "board.hpp"

#include TEST_HEADER

namespace {

decisions::life all;

} // namespace

extern "C" void reset() {
    start_board();
    const bool agrees = all.play().agrees(expected);
#ifdef TEST_REPORT
    if (!agrees)
        leave(2);
    all.begin_touch();
    tell_costs([] { return all.repeat(); });
    leave(0);
#else
    for (;;)
        if (!agrees || !all.repeat())
            return;
#endif
}
