#pragma once

#include <tactnet/transfer/as_photograph.hpp>
#include <tactnet/transfer/networks.hpp>

// Transfer learning: pressure images with networks that were trained on photographs.
