#pragma once

#include <tactnet/networks/network.hpp>
#include <tactnet/networks/resolution.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>
