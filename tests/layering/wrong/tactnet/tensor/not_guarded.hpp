#include <tactnet/detail/config.hpp>
