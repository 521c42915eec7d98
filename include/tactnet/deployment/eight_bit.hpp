#pragma once

// Networks deployed in 8 bits.

#include <tactnet/deployment/eight_bit/deploy.hpp>
#include <tactnet/deployment/eight_bit/spellings.hpp>
