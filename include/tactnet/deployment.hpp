#pragma once

// Deployed networks: see deployment/deploy.hpp.

#include <tactnet/deployment/deploy.hpp>
