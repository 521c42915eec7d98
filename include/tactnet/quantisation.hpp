#pragma once

#include <tactnet/deployment/eight_bit.hpp>
#include <tactnet/quantisation/calibration.hpp>
#include <tactnet/quantisation/stream_calibration.hpp>

// Quantises trained networks to 8 bits: deploy<eight_bit>(model, training_images), and networks of sequences:
// deploy_stream<eight_bit>(network, training_sequences).
