#pragma once

#include <tactnet/deployment/eight_bit.hpp>
#include <tactnet/quantisation/calibration.hpp>

// Quantises trained networks to 8 bits: deploy<eight_bit>(model, training_images).
