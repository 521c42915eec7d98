#pragma once

#include <tactnet/deployment/deploy.hpp>

// Deployed networks: see deployment/deploy.hpp and deployment/deployed_model.hpp.

#include <tactnet/deployment/deployed_model.hpp>
#include <tactnet/deployment/reflection_average.hpp>
