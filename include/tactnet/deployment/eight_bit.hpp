#pragma once

#include <tactnet/deployment/eight_bit/deploy.hpp>
#include <tactnet/deployment/eight_bit/spellings.hpp>

// Networks deployed in 8 bits: deploy<eight_bit>(model, training images).
