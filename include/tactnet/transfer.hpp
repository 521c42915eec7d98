#pragma once

#include <tactnet/transfer/feature_extractor.hpp>
#include <tactnet/transfer/feature_pooling.hpp>
#include <tactnet/transfer/photograph.hpp>

// Transfer learning: networks trained on photographs, for pressure images.
