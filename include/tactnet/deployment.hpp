#pragma once

#include <tactnet/deployment/deploy.hpp>

// Deployed networks: see deployment/deploy.hpp.
