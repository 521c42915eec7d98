#pragma once

// Deployed networks: see deployment/deploy.hpp and deployment/deployed_model.hpp.

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/deployed_model.hpp>
