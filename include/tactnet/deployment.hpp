#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/reflection_average.hpp>

// Deployed networks: see deployment/deploy.hpp.
