#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/operators/lowering.hpp>

// Deployed networks: see deployment/deploy.hpp, and deployment/stream.hpp for sequences of frames.
