#pragma once

#include <tactnet/transfer/as_photograph_deployed.hpp>
#include <tactnet/transfer/feature_extractor.hpp>
#include <tactnet/transfer/feature_head.hpp>
#include <tactnet/transfer/feature_pooling.hpp>
#include <tactnet/transfer/networks.hpp>
#include <tactnet/transfer/photograph.hpp>
#include <tactnet/transfer/pretrained_trunk.hpp>
#include <tactnet/transfer/running_photograph.hpp>
#include <tactnet/transfer/stored_photograph_form.hpp>

// Transfer learning: networks trained on photographs, for pressure images.
