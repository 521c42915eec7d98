#pragma once

// Transfer learning: networks trained on photographs, for pressure images.

#include <tactnet/transfer/feature_extractor.hpp>
#include <tactnet/transfer/map_features.hpp>
#include <tactnet/transfer/photograph.hpp>
